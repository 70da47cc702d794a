#define PLUMB_ARCH xsimd::fma3<xsimd::avx2>
#include "body.hpp"

namespace plumb::simd {
constinit const Kernels<float> avx2_float = table<float>;
constinit const Kernels<double> avx2_double = table<double>;
}  // namespace plumb::simd
