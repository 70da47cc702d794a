// Small matrices in blocks of four: residuals of the scalar bodies in dense matrices, the vector bodies
// against the scalar ones.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "linear/sparse_kkt.hpp"
#include "plumb/settings.hpp"
#include "scenes/basics/seeded.hpp"

namespace plumb::detail {
namespace {

using Dense = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

/// [M Jᵀ; J -e] of particles some of which share mass, and of constraints on two to four of them; in no
/// order.
struct Problem {
  explicit Problem(unsigned seed) : random(seed) {
    particles = 2 + below(8);
    constraints = below(particles + 3);
    const Eigen::Index size = 3 * particles + constraints;
    dense = Dense::Zero(size, size);
    for (std::uint32_t i = 0; i < particles; ++i) {
      const double mass = std::exp(3 * signed_unit());
      for (std::uint32_t c = 0; c < 3; ++c) dense(3 * i + c, 3 * i + c) = mass;
    }
    for (std::uint32_t i = 1; i < particles; ++i) {
      if (below(2) == 0) continue;
      const std::uint32_t other = below(i);
      const double mass = std::exp(3 * signed_unit());
      for (std::uint32_t c = 0; c < 3; ++c) {
        dense(3 * i + c, 3 * i + c) += mass / 3;
        dense(3 * other + c, 3 * other + c) += mass / 3;
        couple(3 * i + c, 3 * other + c, mass / 6);
      }
    }
    for (std::uint32_t r = 0; r < constraints; ++r) {
      const std::uint32_t row = 3 * particles + r;
      dense(row, row) = -1e-11;
      for (std::uint32_t k = 2 + below(3), i = below(particles); k-- > 0; i = (i + 1) % particles)
        for (std::uint32_t c = 0; c < 3; ++c)
          if (dense(row, 3 * i + c) == 0) couple(row, 3 * i + c, signed_unit());
    }
  }

  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(n * scenes::unit_double(random)); }
  double signed_unit() { return 2 * scenes::unit_double(random) - 1; }
  void couple(std::uint32_t a, std::uint32_t b, double value) {
    couplings.emplace_back(a, b);
    dense(a, b) = dense(b, a) = value;
  }

  std::mt19937_64 random;
  std::uint32_t particles, constraints;
  Dense dense;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> couplings;
};

std::vector<simd::Block> matrix_of(const Problem& problem, const KktPlan& plan) {
  std::vector<simd::Block> blocks = plan.empty_matrix();
  const std::span<double> values = numbers(blocks);
  for (const auto& [a, b] : problem.couplings)
    values[plan.place(a, b)] = static_cast<double>(problem.dense(a, b));
  for (std::uint32_t i = 0; i < problem.dense.rows(); ++i)
    values[plan.place(i, i)] = static_cast<double>(problem.dense(i, i));
  return blocks;
}

/// As plan.position() has it.
std::vector<simd::Quad> right_of(const Problem& problem, const KktPlan& plan) {
  std::vector<simd::Quad> right(plan.columns(), simd::Quad{});
  for (std::uint32_t i = 0; i < problem.dense.rows(); ++i)
    numbers(right)[plan.position(i)] = 1 + 0.1 * (i % 7);
  return right;
}

// Residuals, relative to the sizes of what was added: 1e-9 leaves room for pivots of constraints that are
// nearly redundant, which draws like these have.
TEST(Kkt, SolvesWhatItsMatrixSays) {
  int solved = 0;
  for (unsigned seed = 0; seed < 300; ++seed) {
    const Problem problem(seed);
    const KktPlan plan(problem.particles, problem.constraints, problem.couplings, Isa::scalar);
    std::vector<simd::Block> blocks = matrix_of(problem, plan);
    if (!plan.factor(blocks)) continue;
    ++solved;
    std::vector<simd::Quad> x = right_of(problem, plan);
    std::vector<simd::Quad> right = x;
    plan.solve(blocks, x);
    const auto at = [&](std::vector<simd::Quad>& of, Eigen::Index i) {
      return numbers(of)[plan.position(static_cast<std::uint32_t>(i))];
    };
    for (Eigen::Index i = 0; i < problem.dense.rows(); ++i) {
      long double sum = -at(right, i), size = std::abs(sum);
      for (Eigen::Index j = 0; j < problem.dense.rows(); ++j) {
        const long double term = problem.dense(i, j) * at(x, j);
        sum += term;
        size += std::abs(term);
      }
      ASSERT_LE(std::abs(sum), 1e-9L * size) << seed << ", row " << i;
    }
  }
  EXPECT_EQ(solved, 300);
}

// To the last bit: one right hand side, and many in lanes, on every instruction set.
TEST(Kkt, IsTheSameOnEveryInstructionSet) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    const Problem problem(seed);
    const auto solve = [&](Isa isa) {
      const KktPlan plan(problem.particles, problem.constraints, problem.couplings, isa);
      std::vector<simd::Block> blocks = matrix_of(problem, plan);
      plan.factor(blocks);
      std::vector<simd::Quad> x = right_of(problem, plan);
      constexpr std::size_t batches = 3;
      std::vector<simd::Lanes> lanes(batches * plan.unknowns());
      // Every lane of every batch times another power of two, which changes no digit.
      const auto times = [&](std::size_t i, std::size_t lane) {
        return std::ldexp(1.0, static_cast<int>(i / plan.unknowns() * simd::kkt_lanes + lane));
      };
      for (std::size_t i = 0; i < lanes.size(); ++i)
        for (std::size_t lane = 0; lane < simd::kkt_lanes; ++lane)
          lanes[i].of[lane] = times(i, lane) * numbers(x)[i % plan.unknowns()];
      simd::kkt_kernels(isa).solve_lanes(plan.pattern(), blocks.data(), batches, lanes.front().of);
      plan.solve(blocks, x);
      for (std::size_t i = 0; i < lanes.size(); ++i)
        for (std::size_t lane = 0; lane < simd::kkt_lanes; ++lane)
          EXPECT_EQ(lanes[i].of[lane], times(i, lane) * numbers(x)[i % plan.unknowns()]) << seed;
      return x;
    };
    std::vector<simd::Quad> wanted = solve(Isa::scalar);
    for (const Isa isa : all_isas()) {
      if (!is_supported(isa)) continue;
      std::vector<simd::Quad> got = solve(isa);
      for (std::size_t i = 0; i < numbers(got).size(); ++i)
        ASSERT_EQ(numbers(got)[i], numbers(wanted)[i]) << seed << " on " << to_string(isa);
    }
  }
}

// What cannot be solved is said.
TEST(Kkt, SaysWhatHasNoFactors) {
  const std::pair<std::uint32_t, std::uint32_t> couplings[] = {{3, 0}};
  const KktPlan plan(1, 1, couplings, Isa::scalar);
  std::vector<simd::Block> blocks = plan.empty_matrix();  // no mass at all
  EXPECT_FALSE(plan.factor(blocks));
}

}  // namespace
}  // namespace plumb::detail
