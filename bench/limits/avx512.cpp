#include <xsimd/xsimd.hpp>

#define PLUMB_VECTOR(T) xsimd::batch<T, xsimd::avx512bw>
#include "body.hpp"

namespace plumb::bench {
constinit const LimitKernels limits_avx512 = limit_table;
}  // namespace plumb::bench
