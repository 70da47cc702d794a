#include <xsimd/xsimd.hpp>

#define PLUMB_VECTOR(T) xsimd::batch<T, xsimd::sse2>
#include "body.hpp"

namespace plumb::bench {
constinit const LimitKernels limits_sse2 = limit_table;
}  // namespace plumb::bench
