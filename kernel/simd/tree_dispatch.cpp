#include "tree_kernels.hpp"

namespace plumb::simd {

template <>
const TreeKernels<float>& tree_kernels<float>(Isa isa) {
  const TreeKernels<float>* const tables[] = {&tree_scalar_float, &tree_sse2_float, &tree_avx2_float,
                                              &tree_avx512_float};
  return *tables[static_cast<int>(isa)];
}

template <>
const TreeKernels<double>& tree_kernels<double>(Isa isa) {
  const TreeKernels<double>* const tables[] = {&tree_scalar_double, &tree_sse2_double, &tree_avx2_double,
                                               &tree_avx512_double};
  return *tables[static_cast<int>(isa)];
}

}  // namespace plumb::simd
