#define PLUMB_ARCH xsimd::sse2
#include "simd/relax/relax_lanes.hpp"

namespace plumb::simd {
constinit const Kernels<float> relax_sse2_float = table<float>;
constinit const Kernels<double> relax_sse2_double = table<double>;
}  // namespace plumb::simd
