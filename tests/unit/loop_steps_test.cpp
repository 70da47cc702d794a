// How islands with loops are stepped directly: by a factorisation, and by lines.

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "direct/loops/loop_newton.hpp"
#include "direct/loops/loop_rod.hpp"
#include "direct/loops/loop_state.hpp"
#include "direct/loops/loop_stepper.hpp"
#include "direct/loops/loop_vectors.hpp"
#include "direct/nets/loop_lines.hpp"
#include "scenes/generators/generators.hpp"
#include "support/islands.hpp"
#include "support/random_trees.hpp"
#include "support/worlds.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

/// The only island of a scene.
struct Island {
  Island(const Scene& scene, bool by_lines) : of(scene) {
    auto shape = std::make_shared<LoopTopology>(of.local(0).view());
    std::vector<Vec3> positions;
    for (const std::uint32_t vertex : of.islands.vertices(0))
      positions.push_back(scene.particles[vertex].position);
    if (by_lines)
      shape->use_lines(positions);
    else
      shape->system = std::make_unique<LoopSystem>(shape->rods, shape->nodes, true);
    std::vector<std::uint32_t> vertices;
    for (const std::uint32_t vertex : shape->order) vertices.push_back(of.islands.vertices(0)[vertex]);
    state = std::make_unique<LoopState>(shape, scene, MassModel::consistent, vertices, of.islands.edges(0));
    work = std::make_unique<LoopWorkspace>(*state, Gradient::old, Isa::scalar);
  }
  double largest_strain() const {
    double largest = 0;
    for (std::size_t k = 0; k < state->topology->rods.size(); ++k) {
      const auto [a, b] = state->topology->rods[k];
      const double length = std::sqrt(state->length2[k]);
      largest = std::max(largest, std::abs(norm(state->position(a) - state->position(b)) / length - 1));
    }
    return largest;
  }

  test::IslandsOf of;
  std::unique_ptr<LoopState> state;
  std::unique_ptr<LoopWorkspace> work;
};

// Exact in these numbers: (|d + e|² - L²)/2 from what it was before.
TEST(LoopVectors, ConstraintIsHalfTheChangeOfTheSquare) {
  const Vec3 d{3, 4, 0}, e{1, -2, 2};
  EXPECT_EQ(constraint(d, e, 0.5 * (25 - 16)), 0.5 * (16 + 4 + 4 - 16));
  double numbers[6] = {};
  put(numbers + 3, e);
  EXPECT_EQ(at(numbers, 1), e);
  EXPECT_EQ(at(numbers, 0), Vec3{});
}

// A rod's first end is always a node, whichever way round the scene has it.
TEST(LoopRod, BeginsAtANode) {
  Scene scene = test::hanging_net(4, 3);
  for (std::size_t k = 0; k < scene.rods.size(); k += 2) std::swap(scene.rods[k].a, scene.rods[k].b);
  const Island island(scene, false);
  const LoopTopology& shape = *island.state->topology;
  EXPECT_LT(shape.nodes, shape.vertices);
  for (const LoopRod rod : shape.rods) {
    EXPECT_LT(rod.a, shape.nodes);
    EXPECT_LT(rod.b, shape.vertices);
  }
}

// Rods that have their lengths have no excess; one that is 10 % too long has (1.21 - 1)/2 of L².
TEST(LoopNewton, MeasuresRods) {
  Scene scene = test::hanging_net(3, 3);
  const double length =
      norm(scene.particles[scene.rods[0].a].position - scene.particles[scene.rods[0].b].position);
  for (Rod& rod : scene.rods)
    rod.length = norm(scene.particles[rod.a].position - scene.particles[rod.b].position);
  scene.rods[0].length = length / 1.1;
  Island island(scene, false);
  measure_rods(*island.state, *island.work);
  int off = 0;
  for (std::size_t k = 0; k < scene.rods.size(); ++k) {
    const double excess = island.work->excess[k] / island.state->length2[k];
    if (std::abs(excess) < 1e-14) continue;
    ++off;
    EXPECT_NEAR(excess, 0.105, 1e-14);
  }
  EXPECT_EQ(off, 1);
}

void scatter_delta(Island& island, unsigned seed) {
  test::Random random(seed);
  for (std::uint32_t i = 0; i < island.state->topology->nodes; ++i)
    put(island.work->delta.data() + 3 * std::size_t{i}, test::random_vector(random));
}

/// Largest |d . (delta_a - delta_b)| of a rod.
double largest_rate(const Island& island) {
  double largest = 0;
  for (const LoopRod rod : island.state->topology->rods) {
    const Vec3 d = island.state->position(rod.a) - island.state->position(rod.b);
    largest =
        std::max(largest, std::abs(dot(d, at(island.work->delta, rod.a) - at(island.work->delta, rod.b))));
  }
  return largest;
}

// Both ways of projecting leave velocities that pull on no rod, to rounding of velocities of about 1 m/s; and
// both are the least change by mass, so they agree.
TEST(LoopNewton, ProjectionsByFactorAndByLinesAgree) {
  const Scene scene = test::hanging_net(5, 4);
  Island factored(scene, false), lined(scene, true);
  scatter_delta(factored, 41);
  // The same velocities, in the order of lines.
  for (std::uint32_t i = 0; i < lined.state->topology->nodes; ++i)
    put(lined.work->delta.data() + 3 * std::size_t{i},
        at(factored.work->delta, lined.state->topology->order[i]));
  ASSERT_GT(largest_rate(factored), 0.01);
  measure_rods(*factored.state, *factored.work);
  project_delta(*factored.state, {}, *factored.work, factored.work->factor(true));
  EXPECT_LE(largest_rate(factored), 1e-13);
  ASSERT_TRUE(project_by_lines(*lined.state, 0, *lined.work));
  EXPECT_LE(largest_rate(lined), 1e-11) << "conjugate gradients";
  for (std::uint32_t i = 0; i < lined.state->topology->nodes; ++i)
    EXPECT_LE(norm(at(lined.work->delta, i) - at(factored.work->delta, lined.state->topology->order[i])),
              1e-9);
}

// A net that falls keeps its lengths: to rounding by factors, to the tolerance by lines.
TEST(LoopStepper, KeepsLengths) {
  const Scene scene = test::hanging_net(6, 5);
  for (const bool by_lines : {false, true}) {
    Island island(scene, by_lines);
    LoopStepper stepper(Gradient::old, 0);
    stepper.set_line_tolerance(1e-8);
    Tally report;
    for (int i = 0; i < 30; ++i) stepper.advance(*island.state, 0.005, *island.work, report);
    EXPECT_EQ(report.unsolved, 0u);
    EXPECT_LE(island.largest_strain(), 1e-8) << by_lines;
    EXPECT_LT(island.state->position(island.state->topology->nodes - 1).y, 1) << "it moves";
  }
  EXPECT_TRUE(LoopStepper::couples(Gradient::mid, MassModel::lumped));
  EXPECT_FALSE(LoopStepper::couples(Gradient::old, MassModel::lumped));
}

// What a substep that is taken back did to the past of multipliers is taken back too.
TEST(LoopLines, HistoryIsTakenBack) {
  Island island(test::hanging_net(5, 4), true);
  LineWorkspace& lines = *island.work->lines;
  LoopStepper stepper(Gradient::old, 0);
  Tally report;
  for (int i = 0; i < 3; ++i) stepper.advance(*island.state, 0.005, *island.work, report);
  ASSERT_EQ(lines.past.known, 2);
  lines.keep_history();
  const Array<double> before = lines.past.before;
  stepper.advance(*island.state, 0.005, *island.work, report);
  EXPECT_NE(lines.past.before, before);
  lines.take_history_back();
  EXPECT_EQ(lines.past.before, before);
  lines.forget();
  EXPECT_EQ(lines.past.known, 0);
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
