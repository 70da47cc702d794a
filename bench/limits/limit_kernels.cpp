#include "limit_kernels.hpp"

namespace plumb::bench {

const LimitKernels& limit_kernels(Isa isa) {
  const LimitKernels* const tables[] = {&limits_scalar, &limits_sse2, &limits_avx2, &limits_avx512};
  return *tables[static_cast<int>(isa)];
}

}  // namespace plumb::bench
