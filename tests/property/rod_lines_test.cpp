// Lines of an island's rods, and conjugate gradients over them against a dense solution.
#include "direct/nets/rod_lines.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <vector>

#include "plumb/plumb.hpp"
#include "scenes/generators/generators.hpp"
#include "support/graphs.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

/// An island as LineSolver sees it: the movable particles first.
struct Net {
  explicit Net(const Scene& scene) {
    std::vector<std::uint32_t> place(scene.particles.size());
    for (const bool movable : {true, false})
      for (std::uint32_t i = 0; i < scene.particles.size(); ++i) {
        if (scene.particles[i].fixed == movable) continue;
        place[i] = static_cast<std::uint32_t>(positions.size());
        positions.push_back(scene.particles[i].position);
        if (movable) mass.push_back(scene.particles[i].mass);
      }
    for (const Rod& rod : scene.rods) {
      const bool turned = scene.particles[rod.a].fixed;
      rods.push_back({place[turned ? rod.b : rod.a], place[turned ? rod.a : rod.b]});
    }
  }
  std::uint32_t nodes() const { return static_cast<std::uint32_t>(mass.size()); }
  Array<Line> lines() const { return find_lines(rods, nodes(), positions); }

  std::vector<LoopRod> rods;
  std::vector<Vec3> positions;
  std::vector<double> mass;
};

Scene crumpled_net(std::uint32_t width, std::uint32_t height, unsigned seed) {
  test::Random random(seed);
  Scene scene = scenes::make_net({.width = width, .height = height, .level = 1});
  for (Particle& particle : scene.particles) {
    const double x = test::signed_unit(random), y = test::signed_unit(random), z = test::signed_unit(random);
    particle.position += 0.03 * Vec3{x, y, z};
    if (!particle.fixed) particle.mass = std::pow(10, 1.5 * test::signed_unit(random));
  }
  return scene;
}

TEST(RodLines, OfANetAreItsRowsAndColumns) {
  const Net net(scenes::make_net({.width = 9, .height = 6, .level = 1}));
  const Array<Line> lines = net.lines();
  ASSERT_EQ(lines.size(), 5u + 9u);
  for (const Line& line : lines) {
    const auto along = [&](std::uint32_t k) {
      const Vec3 d = net.positions[net.rods[k].a] - net.positions[net.rods[k].b];
      return std::abs(d.x) > std::abs(d.z);
    };
    EXPECT_EQ(line.size(), along(line[0]) ? 8u : 5u);
    for (const std::uint32_t k : line) EXPECT_EQ(along(k), along(line[0]));
  }
}

TEST(RodLines, HoldEveryRodOnceAndRunOnThroughJoints) {
  for (const Scene& scene :
       {scenes::make_ring({.links = 7}), scenes::make_truss({.bays = 5, .chords = 3, .braces = 2}),
        crumpled_net(13, 7, 5), crumpled_net(20, 20, 6)}) {
    const Net net(scene);
    const Array<Line> lines = net.lines();
    const RodLines packed(lines, net.rods, net.nodes());
    std::multiset<std::uint32_t> seen;
    for (std::uint32_t s = 0; s < packed.slots(); ++s) {
      if (packed.numbers[s] == RodLines::none) {
        EXPECT_EQ(packed.turns[s], 0);
        continue;
      }
      seen.insert(packed.numbers[s]);
      if (packed.turns[s] == 0) continue;
      const LoopRod own = packed.ends[s], before = packed.ends[s - RodLines::lanes];
      const std::uint32_t joint = packed.joints[s];
      EXPECT_LT(joint, net.nodes());
      EXPECT_EQ((own.a == joint ? 1 : -1) * (before.a == joint ? 1 : -1), packed.turns[s]);
      EXPECT_TRUE((own.a == joint || own.b == joint) && (before.a == joint || before.b == joint));
    }
    EXPECT_EQ(seen.size(), net.rods.size());
    EXPECT_EQ(std::set(seen.begin(), seen.end()).size(), net.rods.size());
    Array<std::uint32_t> order = packed.node_order();
    std::sort(order.begin(), order.end());
    for (std::uint32_t i = 0; i < net.nodes(); ++i) EXPECT_EQ(order.at(i), i);
    EXPECT_EQ(order.size(), net.nodes());
  }
}

/// A solver of a net, and the same matrix, dense, by slot without padding.
struct Solved {
  explicit Solved(const Net& of)
      : net(of), lines(net.lines(), net.rods, net.nodes()), solver(lines, net.mass) {
    const std::span<double> directions = solver.directions();
    jacobian = Eigen::MatrixXd::Zero(lines.slots(), 3 * net.nodes());
    for (std::uint32_t s = 0; s < lines.slots(); ++s) {
      if (lines.numbers[s] == RodLines::none) continue;
      const auto [a, b] = lines.ends[s];
      const Vec3 d = net.positions[a] - net.positions[b];
      const double along[3] = {d.x, d.y, d.z};
      for (std::uint32_t c = 0; c < 3; ++c) {
        directions[3 * s + c] = along[c];
        jacobian(s, 3 * a + c) = along[c];
        if (b < net.nodes()) jacobian(s, 3 * b + c) = -along[c];
      }
    }
    weights = Eigen::VectorXd(3 * net.nodes());
    for (std::uint32_t i = 0; i < weights.size(); ++i) weights[i] = 1 / net.mass[i / 3];
    solver.factorize();
  }
  Eigen::MatrixXd matrix() const { return jacobian * weights.asDiagonal() * jacobian.transpose(); }

  /// Some b that has a solution.
  std::vector<double> right(unsigned seed) const {
    test::Random random(seed);
    Eigen::VectorXd m(lines.slots());
    for (double& each : m) each = test::signed_unit(random);
    const Eigen::VectorXd b = matrix() * m;
    return {b.begin(), b.end()};
  }

  Net net;
  RodLines lines;
  LineSolver solver;
  Eigen::MatrixXd jacobian;
  Eigen::VectorXd weights;
};

double norm_of(const std::vector<double>& b) {
  return Eigen::Map<const Eigen::VectorXd>(b.data(), static_cast<Eigen::Index>(b.size())).norm();
}

// The residual asked for, in the dense matrix, and what it was called to do to nodes.
TEST(LineSolver, SolvesTheDenseMatrix) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    Solved solved{Net(crumpled_net(5 + seed, 4 + seed % 7, seed))};
    const std::vector<double> b = solved.right(seed + 100);
    std::vector<double> left = b, m(b.size()), motion(3 * solved.net.nodes());
    const double goal = 1e-9 * norm_of(b);
    ASSERT_TRUE(solved.solver.solve(left, goal, 500, m, motion));
    const Eigen::Map<const Eigen::VectorXd> x(m.data(), static_cast<Eigen::Index>(m.size()));
    const Eigen::Map<const Eigen::VectorXd> right(b.data(), static_cast<Eigen::Index>(b.size()));
    EXPECT_LE((solved.matrix() * x - right).norm(), 2 * goal);
    const Eigen::VectorXd moved = solved.weights.asDiagonal() * (solved.jacobian.transpose() * x);
    for (Eigen::Index k = 0; k < moved.size(); ++k)
      EXPECT_NEAR(motion[static_cast<std::size_t>(k)], moved[k], 1e-9 * moved.cwiseAbs().maxCoeff());
  }
}

TEST(LineSolver, OneIterationWhereLinesAreAtRightAngles) {
  Solved solved{Net(scenes::make_net({.width = 20, .height = 20, .level = 1}))};
  std::vector<double> b = solved.right(1), m(b.size()), motion(3 * solved.net.nodes());
  EXPECT_TRUE(solved.solver.solve(b, 1e-12 * norm_of(b), 1, m, motion));
}

// A straight row between fixed corners makes the matrix singular; some solution is found all the same.
TEST(LineSolver, RedundantRodsAreNoObstacle) {
  Solved solved{Net(scenes::make_net({.width = 16, .height = 16}))};
  std::vector<double> b = solved.right(1), m(b.size()), motion(3 * solved.net.nodes());
  EXPECT_TRUE(solved.solver.solve(b, 1e-9 * norm_of(b), 100, m, motion));
  for (const double each : m) EXPECT_TRUE(std::isfinite(each));
}

// Rods straight between fixed particles can be loaded as nothing they do relieves: no solution, and no NaN.
TEST(LineSolver, RefusesWhatRodsCanDoNothingAbout) {
  Scene row;
  for (std::uint32_t i = 0; i < 5; ++i)
    row.particles.push_back({.position = {0.1 * i, 0, 0}, .mass = 1, .fixed = i == 0 || i == 4});
  for (std::uint32_t i = 0; i < 4; ++i) row.rods.push_back({.a = i, .b = i + 1});
  Solved solved{Net(row)};
  std::vector<double> b(solved.lines.slots()), m(b.size()), motion(3 * solved.net.nodes());
  for (std::uint32_t s = 0; s < b.size(); ++s) {  // all longer at once
    if (solved.lines.numbers[s] != RodLines::none) b[s] = 1e-3;
  }
  EXPECT_FALSE(solved.solver.solve(b, 1e-12, 200, m, motion));
  for (const auto* values : {&m, &motion})
    for (const double each : *values) EXPECT_TRUE(std::isfinite(each));
}

TEST(LineSolver, ForgetsWhatOverflowed) {
  Solved solved{Net(crumpled_net(9, 9, 3))};
  std::vector<double> huge = solved.right(1), b = huge, m(b.size()), motion(3 * solved.net.nodes());
  for (double& each : huge) each *= 1e150;
  EXPECT_FALSE(solved.solver.solve(huge, 1, 100, m, motion));
  EXPECT_TRUE(solved.solver.solve(b, 1e-9 * norm_of(b), 100, m, motion));
}

TEST(RodLines, EndAtHubs) {
  Scene wheel;
  constexpr std::uint32_t spokes = 3000;
  wheel.particles.push_back({.position = {0, 0, 0}});
  for (std::uint32_t i = 0; i < spokes; ++i) {
    const double angle = 2 * 3.14159265358979 * i / spokes;
    wheel.particles.push_back({.position = {std::cos(angle), std::sin(angle), 0}});
    wheel.rods.push_back({.a = 0, .b = i + 1});
    wheel.rods.push_back({.a = i + 1, .b = (i + 1) % spokes + 1});
  }
  const Array<Line> lines = Net(wheel).lines();
  EXPECT_EQ(lines.size(), spokes + 1u);
  EXPECT_EQ(lines.front().size(), spokes);
}

TEST(LineSolver, SaysWhenItDoesNotGetThere) {
  Solved solved{Net(crumpled_net(20, 20, 3))};
  std::vector<double> b = solved.right(1), m(b.size()), motion(3 * solved.net.nodes());
  EXPECT_FALSE(solved.solver.solve(b, 1e-9 * norm_of(b), 2, m, motion));
  b.assign(b.size(), std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(solved.solver.solve(b, 1, 100, m, motion));
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
