// Trees side by side in the lanes of vectors, of every instruction set that this machine has: the bits of the
// scalar body.

#pragma GCC diagnostic ignored "-Wpsabi"  // vectors that no call passes

#include <gtest/gtest.h>

#define PLUMB_ARCH xsimd::sse2
#include "scenes/generators/generators.hpp"
#include "simd/tree/tree_vector.hpp"
#include "support/tree_numbers.hpp"

namespace plumb::simd::PLUMB_TEST_FILE {
namespace {

/// Displacements and multipliers after three steps of Newton's method, by the whole tree or by multipliers
/// alone.
template <class T>
std::vector<T> solved(const Scene& scene, const TreeKernels<T>& kernels, bool by_line) {
  test::TreeNumbers<T> n(scene, logical_width<T>);
  kernels.prepare(n.view());
  for (int i = 0; i < 3; ++i) {
    if (by_line)
      kernels.newton_line(n.view());
    else
      kernels.newton(n.view(), T(0.5));
  }
  kernels.find_stiffness(n.view());
  kernels.advance(n.view());
  std::vector<T> out(n.work.delta.data(), n.work.delta.data() + n.work.delta.size());
  out.insert(out.end(), n.state.mu.data(), n.state.mu.data() + n.state.mu.size());
  out.insert(out.end(), n.state.u.data(), n.state.u.data() + n.state.u.size());
  out.push_back(n.work.stiffness[logical_width<T> - 1]);
  return out;
}

template <class T>
void expect_scalar_bits() {
  const Scene scene = scenes::make_ensemble({.chains = logical_width<T>, .links = 5, .vary = 0.5});
  for (const bool by_line : {false, true}) {
    const std::vector<T> wanted = solved<T>(scene, tree_kernels<T>(Isa::scalar), by_line);
    for (const Isa isa : all_isas()) {
      if (!is_supported(isa)) continue;
      EXPECT_EQ(solved<T>(scene, tree_kernels<T>(isa), by_line), wanted) << to_string(isa) << ", " << by_line;
    }
    EXPECT_NE(wanted.front(), 0);
  }
}

TEST(TreeVector, HasTheBitsOfTheScalarBody) {
  expect_scalar_bits<float>();
  expect_scalar_bits<double>();
}

TEST(TreeVector, KeepsAWideSumOfNarrowNumbers) {
  using V = Batch<float>;
  alignas(64) double wide[V::size];
  for (std::size_t i = 0; i < V::size; ++i) wide[i] = 1e8 + static_cast<double>(i);
  add_wide(V(0.25f), wide);
  for (std::size_t i = 0; i < V::size; ++i) EXPECT_EQ(wide[i], 1e8 + static_cast<double>(i) + 0.25);
  alignas(64) float narrowed[V::size];
  store(narrow<V>(load_wide<V>(wide)), narrowed);
  EXPECT_EQ(narrowed[0], 1e8f);
}

}  // namespace
}  // namespace plumb::simd::PLUMB_TEST_FILE
