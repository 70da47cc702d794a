// How wide islands of rods that give are solved without a factorisation.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <span>
#include <vector>

#include "direct/elastic_nets/net_matrix.hpp"
#include "direct/elastic_nets/net_newton.hpp"
#include "direct/laws/change_share.hpp"
#include "direct/loops/loop_state.hpp"
#include "direct/loops/loop_stepper.hpp"
#include "scenes/basics/seeded.hpp"
#include "scenes/generators/generators.hpp"
#include "support/dense_solves.hpp"
#include "support/islands.hpp"
#include "support/laws.hpp"
#include "support/random_trees.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

/// The only island of a scene, with or without a factorisation.
struct Island {
  Island(const Scene& scene, bool is_net, Gradient gradient) : of(scene) {
    auto shape = std::make_shared<LoopTopology>(of.local(0).view());
    if (is_net)
      shape->use_net();
    else
      shape->system = std::make_unique<LoopSystem>(shape->rods, shape->nodes, true);
    for (const std::uint32_t vertex : shape->order) vertices.push_back(of.islands.vertices(0)[vertex]);
    state = std::make_unique<LoopState>(shape, scene, MassModel::consistent, vertices, of.islands.edges(0));
    work = std::make_unique<LoopWorkspace>(*state, gradient, Isa::scalar);
  }
  std::vector<Vec3> by_particle(std::span<const double> numbers) const {
    std::vector<Vec3> out(vertices.size());
    for (std::size_t i = 0; i < vertices.size(); ++i)
      if (3 * i < numbers.size()) out[vertices[i]] = {numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]};
    return out;
  }

  test::IslandsOf of;
  std::vector<std::uint32_t> vertices;
  std::unique_ptr<LoopState> state;
  std::unique_ptr<LoopWorkspace> work;
};

double largest_distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, norm(a[i] - b[i]));
  return largest;
}

struct Numbers {
  std::vector<double> mass;
  std::vector<NetMatrix::RodPart> parts;
  std::vector<Vec3> right;
};
/// Returns random numbers, with rods that press by up to `press` of what they pull.
Numbers random_numbers(const NetPattern& shape, double press) {
  std::mt19937_64 random(7);
  const auto between = [&](double low, double high) {
    return low + (high - low) * scenes::unit_double(random);
  };
  const auto vector = [&] {
    const double x = between(-1, 1), y = between(-1, 1);
    return Vec3{x, y, between(-1, 1)};
  };
  Numbers out;
  for (std::uint32_t i = 0; i < shape.nodes; ++i) {
    out.mass.push_back(between(0.5, 2));
    out.right.push_back(vector());
  }
  for (std::size_t k = 0; k < shape.rods.size(); ++k) {
    const Vec3 f = vector();
    const double along = between(0, 100);
    out.parts.push_back({f, along, between(-press, 1)});
  }
  return out;
}

Eigen::MatrixXd dense(const NetPattern& shape, const Numbers& numbers) {
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(3 * shape.nodes, 3 * shape.nodes);
  for (std::uint32_t i = 0; i < shape.nodes; ++i)
    for (int c = 0; c < 3; ++c) out(3 * i + c, 3 * i + c) = numbers.mass[i];
  for (std::size_t k = 0; k < shape.rods.size(); ++k) {
    const auto [f, along, across] = numbers.parts[k];
    const Eigen::Vector3d v(f.x, f.y, f.z);
    const Eigen::Matrix3d tile = along * v * v.transpose() + across * Eigen::Matrix3d::Identity();
    const auto [a, b] = shape.rods[k];
    out.block<3, 3>(3 * a, 3 * a) += tile;
    if (b >= shape.nodes) continue;
    out.block<3, 3>(3 * b, 3 * b) += tile;
    out.block<3, 3>(3 * a, 3 * b) -= tile;
    out.block<3, 3>(3 * b, 3 * a) -= tile;
  }
  return out;
}

/// A graph with triangles and anchors, whose nodes are numbered by levels.
LoopTopology graph() {
  const test::IslandsOf of(test::hanging_net(6, 5));
  LoopTopology shape(of.local(0).view());
  shape.rods.push_back({0, shape.nodes - 1});
  shape.rods.push_back({3, shape.nodes / 2});
  shape.use_net();
  return shape;
}

// Against a dense solution (Eigen): the residual falls to 1e-12, times the condition of 1e3 at most.
TEST(NetMatrix, SolvesWhatADenseMatrixDoes) {
  const LoopTopology shape = graph();
  for (const double press : {0.0, 0.05}) {
    const Numbers numbers = random_numbers(*shape.net, press);
    NetMatrix matrix(*shape.net);
    matrix.set(numbers.mass, numbers.parts);
    std::vector<Vec3> x(shape.nodes);
    ASSERT_EQ(matrix.solve(numbers.right, 1e-13, 200, x), NetMatrix::Outcome::solved);
    Eigen::VectorXd right(3 * shape.nodes);
    for (std::uint32_t i = 0; i < shape.nodes; ++i)
      right.segment<3>(3 * i) << numbers.right[i].x, numbers.right[i].y, numbers.right[i].z;
    const Eigen::VectorXd truth =
        test::solve_dense(dense(*shape.net, numbers).cast<test::Real>(), right.cast<test::Real>())
            .cast<double>();
    for (std::uint32_t i = 0; i < shape.nodes; ++i)
      EXPECT_LE(norm(x[i] - Vec3{truth(3 * i), truth(3 * i + 1), truth(3 * i + 2)}), 1e-9);
  }
}

// Rods that press harder than masses resist have no minimum, and the matrix says so.
TEST(NetMatrix, TellsThatItIsIndefinite) {
  const LoopTopology shape = graph();
  Numbers numbers = random_numbers(*shape.net, 0);
  for (auto& part : numbers.parts) part = {part.f, 0, -3};
  NetMatrix matrix(*shape.net);
  matrix.set(numbers.mass, numbers.parts);
  std::vector<Vec3> x(shape.nodes);
  EXPECT_EQ(matrix.solve(numbers.right, 1e-13, 200, x), NetMatrix::Outcome::indefinite);
}

// On a flat net elimination along rows and columns fills nothing, so that one iteration is all it takes.
TEST(NetMatrix, IsExactAlongRowsAndColumns) {
  const test::IslandsOf of(scenes::make_net(12, 9));
  LoopTopology shape(of.local(0).view());
  shape.use_net();
  Numbers numbers = random_numbers(*shape.net, 0);
  const std::uint32_t across = 12;
  for (std::uint32_t k = 0; k < shape.rods.size(); ++k) {
    const std::uint32_t a = shape.order[shape.rods[k].a], b = shape.order[shape.rods[k].b];
    const auto vertices = of.islands.vertices(0);
    const bool is_row = vertices[a] / across == vertices[b] / across;
    numbers.parts[k] = {is_row ? Vec3{1, 0, 0} : Vec3{0, 1, 0}, 1e6, 0};
  }
  NetMatrix matrix(*shape.net);
  matrix.set(numbers.mass, numbers.parts);
  std::vector<Vec3> x(shape.nodes);
  EXPECT_EQ(matrix.solve(numbers.right, 1e-8, 1, x), NetMatrix::Outcome::solved);
}

// Changes that do not fall are halved from the fifth on, and whole ones come back as soon as they fall.
TEST(ChangeShare, IsHalvedWhereChangesDoNotFall) {
  ChangeShare share;
  for (int i = 0; i < 4; ++i) EXPECT_EQ(share.next(1), 1);
  EXPECT_EQ(share.next(1), 0.5);
  EXPECT_EQ(share.next(0.8), 0.25);
  EXPECT_EQ(share.next(0.5), 0.5);
  EXPECT_EQ(share.next(0.5), 1);
  EXPECT_EQ(share.next(0.5), 1);
  for (int i = 0; i < 9; ++i) share.next(1);
  EXPECT_EQ(share.next(1), 1.0 / 16);
}

// A substep is what the factorised matrix with multipliers makes of it, whatever the gradient and the law.
// Both end their iterations within 1e-11 of a rod of the solution.
TEST(ElasticNet, MovesAsAFactorisedOneDoes) {
  for (const RodLaw law : {RodLaw{.stiffness = 1e4}, RodLaw{.stiffness = 1e5, .damping = 20},
                           RodLaw{.stiffness = 3e4, .one_sided = true}})
    for (const Gradient gradient : {Gradient::old, Gradient::mid, Gradient::new_}) {
      const Scene scene = test::with_law(test::hanging_net(9, 7), law);
      Island net(scene, true, gradient), factorised(scene, false, gradient);
      const LoopStepper stepper(gradient, 0.1);
      for (Island* each : {&net, &factorised}) {
        Tally counters;
        for (int i = 0; i < 20; ++i)
          ASSERT_TRUE(stepper.try_substep(*each->state, 1.0 / 480, *each->work, counters))
              << to_string(gradient);
        stepper.find_velocities(*each->state, *each->work);
      }
      EXPECT_EQ(net.work->second, nullptr) << "nothing was factorised";
      EXPECT_LE(largest_distance(net.by_particle(net.state->x), factorised.by_particle(factorised.state->x)),
                1e-10)
          << to_string(gradient);
      EXPECT_LE(
          largest_distance(net.by_particle(net.work->delta), factorised.by_particle(factorised.work->delta)),
          1e-7)
          << to_string(gradient);
    }
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
