#define PLUMB_ARCH xsimd::avx512bw
#include "simd/double_vector.hpp"
#include "simd/front/front_lanes.hpp"

namespace plumb::simd {

constinit const FrontKernels front_avx512{eliminate<Batch>, forward<Batch>, backward<Batch>};

}  // namespace plumb::simd
