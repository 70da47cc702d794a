#define PLUMB_ARCH xsimd::sse2
#include "double_vector.hpp"
#include "front_body.hpp"

namespace plumb::simd {

constinit const FrontKernels front_sse2{eliminate<Batch>, forward<Batch>, backward<Batch>};

}  // namespace plumb::simd
