// How the loops of relaxation reach the ends of rods, for vectors that every machine has: every way of access
// against the numbers in memory.

#pragma GCC diagnostic ignored "-Wpsabi"  // vectors that no call passes

#include <gtest/gtest.h>

#define PLUMB_ARCH xsimd::sse2
#include "plumb/layouts/aligned_buffer.hpp"
#include "simd/relax/access_lanes.hpp"
#include "simd/relax/records.hpp"
#include "support/graphs.hpp"

namespace plumb::simd::PLUMB_TEST_FILE {
namespace {

// A record k holds 10 k + 0, 1, 2 and 0: columns hold the same by component, and records come back from them.
template <class T, std::uint32_t n>
void expect_transposes() {
  Record<T> records[n], back[n];
  for (std::uint32_t k = 0; k < n; ++k) records[k] = Record<T>{T(10 * k), T(10 * k + 1), T(10 * k + 2), T(0)};
  Columns<T, n> columns;
  to_columns(records, columns);
  to_records(columns, back);
  for (std::uint32_t k = 0; k < n; ++k) {
    EXPECT_EQ(columns.x[k], T(10 * k));
    EXPECT_EQ(columns.y[k], T(10 * k + 1));
    EXPECT_EQ(columns.z[k], T(10 * k + 2));
    for (int c = 0; c < 4; ++c) EXPECT_EQ(back[k][c], records[k][c]);
  }
}

TEST(Records, TransposeThereAndBackAtEveryWidth) {
  expect_transposes<double, 2>();
  expect_transposes<double, 4>();
  expect_transposes<double, 8>();
  expect_transposes<float, 4>();
  expect_transposes<float, 8>();
  expect_transposes<float, 16>();
}

TEST(Positions, CountMachineVectorsWithinLogicalOnes) {
  for (std::size_t k = 0; k < 12; ++k) {
    const Position at = position<double>(3, k);
    EXPECT_EQ((at.v - 3) * logical_width<double> + at.first, k * width<double>);
    EXPECT_LT(at.first, logical_width<double>);
  }
}

// Both ends of a rod: b less a, and apply() adds to a and takes from b. All numbers are small and whole.
template <class Access>
void expect_access(std::uint32_t stride, std::uint32_t step) {
  constexpr std::uint32_t lanes = logical_width<double>;
  layouts::AlignedBuffer<double> data(512), before(512);
  for (std::size_t i = 0; i < data.size(); ++i) data[i] = before[i] = static_cast<double>(i * i % 97);
  std::uint32_t a[lanes], b[lanes];
  for (std::uint32_t lane = 0; lane < lanes; ++lane) {
    a[lane] = step * lane;
    b[lane] = 128 + step * lane;
  }
  BlockView<double> block{};
  block.p = block.out = data.data();
  block.component_stride = stride;
  block.address_a = a;
  block.address_b = b;
  for (std::uint32_t first = 0; first < lanes; first += width<double>) {
    const Position at{0, first};
    const Triple<double> e = Access::difference(block, data.data(), at);
    const Triple<double> by{Batch<double>(1.0), Batch<double>(2.0), Batch<double>(3.0)};
    for (std::uint32_t k = 0; k < width<double>; ++k) {
      const std::size_t of_a = step * (first + k), of_b = of_a + 128;
      EXPECT_EQ(e.x.get(k), before[of_b] - before[of_a]);
      EXPECT_EQ(e.z.get(k), before[of_b + 2 * stride] - before[of_a + 2 * stride]);
    }
    Access::apply(block, at, by, Batch<double>(10.0) * by);
    for (std::uint32_t k = 0; k < width<double>; ++k)
      for (std::uint32_t c = 0; c < 3; ++c) {
        const std::size_t of_a = step * (first + k) + c * stride, of_b = of_a + 128;
        EXPECT_EQ(data[of_a], before[of_a] + (c + 1));
        EXPECT_EQ(data[of_b], before[of_b] - 10 * (c + 1));
      }
  }
}

TEST(Access, ReachesBothEndsEveryWay) {
  expect_access<RowAccess>(32, 1);
  expect_access<GatherAccess>(32, 3);
  expect_access<RecordAccess>(1, 4);
}

}  // namespace
}  // namespace plumb::simd::PLUMB_TEST_FILE
