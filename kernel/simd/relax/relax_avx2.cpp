#define PLUMB_ARCH xsimd::fma3<xsimd::avx2>
#include "simd/relax/relax_lanes.hpp"

namespace plumb::simd {
constinit const Kernels<float> relax_avx2_float = table<float>;
constinit const Kernels<double> relax_avx2_double = table<double>;
}  // namespace plumb::simd
