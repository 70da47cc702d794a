#include <xsimd/xsimd.hpp>

#define PLUMB_VECTOR(T) T
#include "body.hpp"

namespace plumb::bench {
constinit const LimitKernels limits_scalar = limit_table;
}  // namespace plumb::bench
