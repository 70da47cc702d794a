#include "simd/relax/relax_lanes.hpp"

namespace plumb::simd {
constinit const Kernels<float> relax_neon_float = table<float>;
constinit const Kernels<double> relax_neon_double = table<double>;
}  // namespace plumb::simd
