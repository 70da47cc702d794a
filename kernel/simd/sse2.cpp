#define PLUMB_ARCH xsimd::sse2
#include "body.hpp"

namespace plumb::simd {
constinit const Kernels<float> sse2_float = table<float>;
constinit const Kernels<double> sse2_double = table<double>;
}  // namespace plumb::simd
