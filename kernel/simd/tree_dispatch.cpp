#include "tree_kernels.hpp"

namespace plumb::simd {

template <>
const TreeKernels<float>& tree_kernels<float>(Isa isa) {
  switch (isa) {
#define PLUMB_CASE(name, supported) \
  case Isa::name:                   \
    return tree_##name##_float;
    PLUMB_FOR_EACH_ISA(PLUMB_CASE)
#undef PLUMB_CASE
  }
  return tree_scalar_float;
}

template <>
const TreeKernels<double>& tree_kernels<double>(Isa isa) {
  switch (isa) {
#define PLUMB_CASE(name, supported) \
  case Isa::name:                   \
    return tree_##name##_double;
    PLUMB_FOR_EACH_ISA(PLUMB_CASE)
#undef PLUMB_CASE
  }
  return tree_scalar_double;
}

}  // namespace plumb::simd
