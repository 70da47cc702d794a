#define PLUMB_ARCH xsimd::sse2
#include "simd/double_vector.hpp"
#include "simd/kkt/kkt_lanes.hpp"

namespace plumb::simd {

constinit const KktKernels kkt_sse2 = kkt_table<Batch>;

}  // namespace plumb::simd
