#include "front_kernels.hpp"

namespace plumb::simd {

const FrontKernels& front_kernels(Isa isa) {
  switch (isa) {
#define PLUMB_CASE(name, supported) \
  case Isa::name:                   \
    return front_##name;
    PLUMB_FOR_EACH_ISA(PLUMB_CASE)
#undef PLUMB_CASE
  }
  return front_scalar;
}

}  // namespace plumb::simd
