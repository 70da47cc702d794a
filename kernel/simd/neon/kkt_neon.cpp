#include "simd/double_vector.hpp"
#include "simd/kkt/kkt_lanes.hpp"

namespace plumb::simd {

constinit const KktKernels kkt_neon = kkt_table<Batch>;

}  // namespace plumb::simd
