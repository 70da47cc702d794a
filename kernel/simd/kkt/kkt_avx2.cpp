#define PLUMB_ARCH xsimd::fma3<xsimd::avx2>
#include "simd/double_vector.hpp"
#include "simd/kkt/kkt_lanes.hpp"

namespace plumb::simd {

constinit const KktKernels kkt_avx2 = kkt_table<Batch>;

}  // namespace plumb::simd
