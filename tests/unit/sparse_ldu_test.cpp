#include "linear/sparse_ldu.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "scenes/basics/seeded.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

/// A random matrix with a symmetric pattern, as entries and dense.
struct Matrix {
  SparsePattern pattern;
  std::vector<SparseEntry> entries;
  std::vector<double> values;
  std::vector<std::uint32_t> start;

  explicit Matrix(std::uint32_t variables, unsigned seed) {
    std::mt19937_64 random(seed);
    const auto below = [&](std::uint32_t n) {
      return static_cast<std::uint32_t>(scenes::unit_double(random) * n);
    };
    std::uint32_t size = 0;
    for (std::uint32_t i = 0; i < variables; ++i) {
      pattern.size.push_back(1 + below(3));
      pattern.order.push_back(i);
      start.push_back(size);
      size += pattern.size.back();
    }
    for (std::uint32_t i = variables; i-- > 1;) std::swap(pattern.order[i], pattern.order[below(i + 1)]);
    const auto add = [&](std::uint32_t a, std::uint32_t b, double diagonal) {
      for (std::uint32_t i = 0; i < pattern.size[a]; ++i)
        for (std::uint32_t j = 0; j < pattern.size[b]; ++j) {
          entries.push_back({a, i, b, j, static_cast<std::uint32_t>(values.size())});
          values.push_back(2 * scenes::unit_double(random) - 1 + (i == j ? diagonal : 0));
        }
    };
    for (std::uint32_t i = 0; i < variables; ++i) add(i, i, 20);
    for (std::uint32_t i = 0; i < 2 * variables; ++i) {
      const std::uint32_t a = below(variables), b = below(variables);
      if (a == b) continue;
      pattern.meet.emplace_back(a, b);
      add(a, b, 0);
      add(b, a, 0);
    }
  }
};

TEST(SparseLdu, SolvesRandomMatrices) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Matrix matrix(1 + 7 * seed, seed);
    const SparseAnalysis analysis(matrix.pattern, matrix.entries);
    SparseLdu ldu(analysis, best_isa());
    const std::vector<double> smallest(analysis.size(), 0);
    std::vector<double> wanted(analysis.size()), right(analysis.size(), 0);
    for (std::size_t i = 0; i < wanted.size(); ++i) wanted[i] = std::sin(1.0 + static_cast<double>(i));
    for (const SparseEntry& e : matrix.entries)
      right[analysis.position(e.row) + e.row_part] +=
          matrix.values[e.value] * wanted[analysis.position(e.column) + e.column_part];
    for (int again = 0; again < 2; ++again) {
      std::vector<double> x = right;
      EXPECT_EQ(ldu.factorize(matrix.values, smallest), 0u);
      ldu.solve(x);
      for (std::size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(x[i], wanted[i], 1e-12) << "seed " << seed;
    }
  }
}

// [1 1 0; 1 1 0; 0 0 2]: the second equation is the first again.
TEST(SparseLdu, LeavesOutEquationsThatFollowFromOthers) {
  const SparsePattern pattern{.size = {1, 1, 1}, .meet = {{0, 1}}, .order = {0, 1, 2}};
  const std::vector<SparseEntry> entries = {
      {0, 0, 0, 0, 0}, {0, 0, 1, 0, 0}, {1, 0, 0, 0, 0}, {1, 0, 1, 0, 0}, {2, 0, 2, 0, 1}};
  const SparseAnalysis analysis(pattern, entries);
  SparseLdu ldu(analysis, Isa::scalar);
  const std::vector<double> values = {1, 2}, smallest(3, 1e-12);
  EXPECT_EQ(ldu.factorize(values, smallest), 1u);
  std::vector<double> x(3);
  x[analysis.position(0)] = 3;
  x[analysis.position(1)] = 3;
  x[analysis.position(2)] = 4;
  ldu.solve(x);
  EXPECT_EQ(x[analysis.position(0)] + x[analysis.position(1)], 3);
  EXPECT_EQ(x[analysis.position(2)], 2);
}

TEST(SparseLdu, EstimatesWhatAnAnalysisWithoutMergedFrontsCosts) {
  const Matrix matrix(60, 5);
  const double merged = SparseAnalysis(matrix.pattern, matrix.entries).operations();
  EXPECT_LE(SparseAnalysis::estimate(matrix.pattern), merged);
  EXPECT_GE(2 * SparseAnalysis::estimate(matrix.pattern), merged);
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
