#include <xsimd/xsimd.hpp>

#define PLUMB_VECTOR(T) xsimd::batch<T, xsimd::fma3<xsimd::avx2>>
#include "body.hpp"

namespace plumb::bench {
constinit const LimitKernels limits_avx2 = limit_table;
}  // namespace plumb::bench
