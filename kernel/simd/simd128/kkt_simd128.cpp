#include "simd/double_vector.hpp"
#include "simd/kkt/kkt_lanes.hpp"

namespace plumb::simd {

constinit const KktKernels kkt_simd128 = kkt_table<Batch>;

}  // namespace plumb::simd
