#include "kkt_kernels.hpp"

namespace plumb::simd {

const KktKernels& kkt_kernels(Isa isa) {
  switch (isa) {
#define PLUMB_CASE(name, supported) \
  case Isa::name:                   \
    return kkt_##name;
    PLUMB_FOR_EACH_ISA(PLUMB_CASE)
#undef PLUMB_CASE
  }
  return kkt_scalar;
}

}  // namespace plumb::simd
