#define PLUMB_ARCH xsimd::fma3<xsimd::avx2>
#include "simd/double_vector.hpp"
#include "simd/front/front_lanes.hpp"

namespace plumb::simd {

constinit const FrontKernels front_avx2{eliminate<Batch>, forward<Batch>, backward<Batch>};

}  // namespace plumb::simd
