#define PLUMB_ARCH xsimd::fma3<xsimd::avx2>
#include "double_vector.hpp"
#include "front_body.hpp"

namespace plumb::simd {

constinit const FrontKernels front_avx2{eliminate<Batch>, forward<Batch>, backward<Batch>};

}  // namespace plumb::simd
