#define PLUMB_ARCH xsimd::avx512bw
#include "front_vector.hpp"

namespace plumb::simd {

constinit const FrontKernels front_avx512{eliminate<Batch>, forward<Batch>, backward<Batch>};

}  // namespace plumb::simd
