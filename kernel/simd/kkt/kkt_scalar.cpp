#include "simd/double_scalar.hpp"
#include "simd/kkt/kkt_lanes.hpp"

namespace plumb::simd {

constinit const KktKernels kkt_scalar = kkt_table<double>;

}  // namespace plumb::simd
