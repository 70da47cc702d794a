#include "simd/relax/relax_lanes.hpp"

namespace plumb::simd {
constinit const Kernels<float> relax_simd128_float = table<float>;
constinit const Kernels<double> relax_simd128_double = table<double>;
}  // namespace plumb::simd
