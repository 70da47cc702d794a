#define PLUMB_ARCH xsimd::avx512bw
#include "simd/relax/relax_lanes.hpp"

namespace plumb::simd {
constinit const Kernels<float> relax_avx512_float = table<float>;
constinit const Kernels<double> relax_avx512_double = table<double>;
}  // namespace plumb::simd
