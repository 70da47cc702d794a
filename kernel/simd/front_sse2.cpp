#define PLUMB_ARCH xsimd::sse2
#include "front_vector.hpp"

namespace plumb::simd {

constinit const FrontKernels front_sse2{eliminate<Batch>, forward<Batch>, backward<Batch>};

}  // namespace plumb::simd
