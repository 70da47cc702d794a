#define PLUMB_ARCH xsimd::avx512bw
#include "body.hpp"

namespace plumb::simd {
constinit const Kernels<float> avx512_float = table<float>;
constinit const Kernels<double> avx512_double = table<double>;
}  // namespace plumb::simd
