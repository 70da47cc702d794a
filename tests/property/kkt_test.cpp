// Small matrices in blocks of four: residuals of the scalar bodies in dense matrices, the vector bodies
// against the scalar ones.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <random>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "linear/kkt_order.hpp"
#include "linear/sparse_kkt.hpp"
#include "plumb/settings.hpp"
#include "scenes/basics/seeded.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

using Dense = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

using Couplings = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

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
  Couplings couplings;
};

/// A square net of rods with mass, and triples of it that are coupled by a constraint now and then.
struct Net {
  explicit Net(std::uint32_t n, unsigned seed) : particles(n * n) {
    std::mt19937_64 random(seed);
    const auto couple = [&](std::uint32_t a, std::uint32_t b) {
      for (std::uint32_t c = 0; c < 3; ++c) {
        couplings.emplace_back(3 * b + c, 3 * a + c);
        for (const std::uint32_t end : {a, b}) couplings.emplace_back(3 * end + c, 3 * particles + rods);
      }
      ++rods;
    };
    for (std::uint32_t j = 0; j < n; ++j)
      for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t here = j * n + i;
        if (i > 0) couple(here, here - 1);
        if (j > 0) couple(here - n, here);
        if (scenes::unit_double(random) < 0.01)
          couple(here, static_cast<std::uint32_t>(particles * scenes::unit_double(random)) / 2);
      }
  }

  std::uint32_t particles, rods = 0;
  Couplings couplings;
};

Array<simd::Block> matrix_of(const Problem& problem, const KktPlan& plan) {
  Array<simd::Block> blocks(plan.blocks());
  plan.clear(blocks);
  const std::span<double> values = numbers(blocks);
  for (const auto& [a, b] : problem.couplings)
    values[plan.place(a, b)] = static_cast<double>(problem.dense(a, b));
  for (std::uint32_t i = 0; i < problem.dense.rows(); ++i)
    values[plan.place(i, i)] = static_cast<double>(problem.dense(i, i));
  return blocks;
}

/// As plan.position() has it.
Array<simd::Quad> right_of(const Problem& problem, const KktPlan& plan) {
  Array<simd::Quad> right(plan.columns(), simd::Quad{});
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
    Array<simd::Block> blocks = matrix_of(problem, plan);
    if (!plan.factor(blocks)) continue;
    ++solved;
    Array<simd::Quad> x = right_of(problem, plan);
    Array<simd::Quad> right = x;
    plan.solve(blocks, x);
    const auto at = [&](Array<simd::Quad>& of, Eigen::Index i) {
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

// Nets are ordered in another way than what is small. A unit matrix with rods of random directions has a
// condition of 1e3, so that 1e-10 leaves room for 64² numbers.
TEST(Kkt, SolvesNets) {
  for (const std::uint32_t n : {9u, 20u, 40u}) {
    const Net net(n, n);
    const KktPlan plan(net.particles, net.rods, net.couplings, Isa::scalar);
    Array<simd::Block> blocks(plan.blocks());
    plan.clear(blocks);
    const std::uint32_t size = 3 * net.particles + net.rods;
    Eigen::SparseMatrix<double> matrix(size, size);
    std::vector<Eigen::Triplet<double>> entries;
    std::mt19937_64 random(n);
    const auto set = [&](std::uint32_t a, std::uint32_t b, double value) {
      numbers(blocks)[plan.place(a, b)] = value;
      entries.emplace_back(a, b, value);
      if (a != b) entries.emplace_back(b, a, value);
    };
    for (std::uint32_t i = 0; i < size; ++i) set(i, i, i < 3 * net.particles ? 1 : -1e-11);
    for (const auto& [a, b] : net.couplings)
      set(a, b, b < 3 * net.particles ? 0.1 : 2 * scenes::unit_double(random) - 1);
    matrix.setFromTriplets(entries.begin(), entries.end(), [](double, double last) { return last; });
    ASSERT_TRUE(plan.factor(blocks)) << n;
    Array<simd::Quad> x(plan.columns(), simd::Quad{});
    Eigen::VectorXd right(size), got(size);
    for (std::uint32_t i = 0; i < size; ++i) right[i] = numbers(x)[plan.position(i)] = 1 + 0.1 * (i % 7);
    plan.solve(blocks, x);
    for (std::uint32_t i = 0; i < size; ++i) got[i] = numbers(x)[plan.position(i)];
    EXPECT_LT((matrix * got - right).lpNorm<Eigen::Infinity>(), 1e-10 * got.lpNorm<Eigen::Infinity>()) << n;
  }
}

// What an order promises: every node once, and a constraint after its triples or as the first of one.
TEST(Kkt, OrdersConstraintsBehindTriples) {
  for (const std::uint32_t n : {3u, 9u, 20u})
    for (unsigned seed = 0; seed < 5; ++seed) {
      const Net net(n, seed);
      const KktGraph graph(net.particles, net.rods, net.couplings);
      std::vector<int> gone(graph.neighbours.size(), 0), taken(graph.neighbours.size(), 0);
      for (const Array<std::uint32_t>& column : order_columns(graph).columns) {
        std::uint32_t unknowns = 0;
        for (const std::uint32_t node : column) {
          EXPECT_EQ(gone[node]++, 0) << node;
          unknowns += graph.is_triple(node) ? 3 : 1;
          if (graph.is_triple(node)) continue;
          std::uint32_t waits_for = 0, first = node;
          for (const std::uint32_t each : graph.neighbours[node]) {
            waits_for += gone[each] == 0;
            if (gone[each] != 0 && taken[each] == 0) first = each;
          }
          if (waits_for == 0) continue;
          EXPECT_NE(first, node) << "no triple is gone that has given none to a constraint";
          taken[first] = 1;
        }
        EXPECT_LE(unknowns, 4u);
      }
      EXPECT_EQ(std::count(gone.begin(), gone.end(), 1), static_cast<std::ptrdiff_t>(gone.size()));
    }
}

// The rows of factors, against elimination by the book.
TEST(Kkt, FindsTheRowsOfFactors) {
  const Net net(12, 1);
  const KktGraph graph(net.particles, net.rods, net.couplings);
  const auto [columns, got] = order_columns(graph);
  std::vector<std::uint32_t> column_of(graph.neighbours.size());
  for (std::uint32_t k = 0; k < columns.size(); ++k)
    for (const std::uint32_t node : columns[k]) column_of[node] = k;
  std::vector<std::set<std::uint32_t>> below(columns.size());
  for (std::uint32_t node = 0; node < column_of.size(); ++node)
    for (const std::uint32_t other : graph.neighbours[node])
      if (column_of[other] > column_of[node]) below[column_of[node]].insert(column_of[other]);
  for (std::set<std::uint32_t>& rows : below)
    for (auto row = rows.begin(); row != rows.end(); ++row) below[*row].insert(std::next(row), rows.end());
  ASSERT_EQ(got.size(), below.size());
  for (std::size_t k = 0; k < got.size(); ++k)
    EXPECT_EQ(got[k], Array<std::uint32_t>(below[k].begin(), below[k].end())) << k;
}

// The exact minimum degree fills the factors of a net of 32 x 32 with 922,000 updates of tiles.
TEST(Kkt, FillsNetsWithLittle) {
  const Net net(32, 0);
  const KktGraph graph(net.particles, net.rods, net.couplings);
  std::size_t updates = 0;
  for (const Array<std::uint32_t>& rows : order_columns(graph).rows)
    updates += rows.size() * (rows.size() + 1) / 2;
  EXPECT_LT(updates, 700'000u);
}

// To the last bit: one right hand side, and many in lanes, on every instruction set.
TEST(Kkt, IsTheSameOnEveryInstructionSet) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    const Problem problem(seed);
    const auto solve = [&](Isa isa) {
      const KktPlan plan(problem.particles, problem.constraints, problem.couplings, isa);
      Array<simd::Block> blocks = matrix_of(problem, plan);
      plan.factor(blocks);
      Array<simd::Quad> x = right_of(problem, plan);
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
    Array<simd::Quad> wanted = solve(Isa::scalar);
    for (const Isa isa : all_isas()) {
      if (!is_supported(isa)) continue;
      Array<simd::Quad> got = solve(isa);
      for (std::size_t i = 0; i < numbers(got).size(); ++i)
        ASSERT_EQ(numbers(got)[i], numbers(wanted)[i]) << seed << " on " << to_string(isa);
    }
  }
}

// What cannot be solved is said.
TEST(Kkt, SaysWhatHasNoFactors) {
  const std::pair<std::uint32_t, std::uint32_t> couplings[] = {{3, 0}};
  const KktPlan plan(1, 1, couplings, Isa::scalar);
  Array<simd::Block> blocks(plan.blocks());
  plan.clear(blocks);  // no mass at all
  EXPECT_FALSE(plan.factor(blocks));
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
