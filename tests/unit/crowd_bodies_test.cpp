// How relaxation rights bodies that are inside out.

#include "contact/relaxed/bodies/crowd_bodies.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "contact/shapes/body_shape.hpp"
#include "plumb/joints.hpp"
#include "scene/barycentric.hpp"
#include "support/random_trees.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

/// A body of 2 kg whose particles are moved by given ways in a substep of a second. Those in `fixed` are.
struct Moved {
  explicit Moved(const std::array<Vec3, 4>& ways, std::uint32_t fixed = 0) {
    scene.gravity = {};
    add_body(scene, solid_box(2, Vec3{0.2, 0.3, 0.5}));
    for (std::size_t i = 0; i < 4; ++i) scene.particles[i].fixed = i < fixed;
    // Islands have the movable ones first.
    std::rotate(scene.particles.begin(), scene.particles.begin() + fixed, scene.particles.end());
    for (Rod& rod : scene.rods)
      for (std::uint32_t* const end : {&rod.a, &rod.b}) *end = (*end + 4 - fixed) % 4;
    for (std::uint32_t& each : scene.bodies[0].particles) each = (each + 4 - fixed) % 4;
    for (std::size_t i = 0; i + fixed < 4; ++i) scene.particles[i].velocity = ways[i];
    kind.emplace_back(scene, best_isa(), Linkage::Use::relaxed);
    states.emplace_back(kind.front(), 0, scene);
    LinkageState* const cluster[] = {&states.front()};
    crowd.gather(cluster, {});
    crowd.predict(1, Gradient::new_);
    bodies.gather(cluster, crowd);
    before = places();
    bodies.right(crowd);
    after = places();
  }
  std::array<Vec3, 4> places() const {
    std::array<Vec3, 4> out;
    for (std::uint32_t i = 0; i < 4; ++i)
      out[i] = crowd.position_of(0, i) + crowd.moved(crowd.number_of(0, i));
    return out;
  }
  std::array<Vec3, 4> at_first() const {
    std::array<Vec3, 4> out;
    for (std::uint32_t i = 0; i < 4; ++i) out[i] = crowd.position_of(0, i);
    return out;
  }
  /// Returns the largest change of a distance between two particles, m.
  double most_strained() const {
    const std::array<Vec3, 4> first = at_first();
    double most = 0;
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t k = 0; k < i; ++k)
        most = std::max(most, std::abs(norm(after[i] - after[k]) - norm(first[i] - first[k])));
    return most;
  }

  Scene scene;
  std::vector<Linkage> kind;
  std::vector<LinkageState> states;
  Crowd<double> crowd;
  CrowdBodies<double> bodies;
  std::array<Vec3, 4> before, after;  ///< m
};

std::array<Vec3, 4> random_ways(test::Random& random, double size) {
  std::array<Vec3, 4> out;
  for (Vec3& each : out) each = size * test::random_vector(random);
  return out;
}

// A body that blows push into its mirror image has its shape again, where the pushes have no sum and no
// torque about where its particles were. To rounding of 2 kg m and 1 m.
TEST(CrowdBodies, AreRightedWithoutAPush) {
  test::Random random(3);
  int righted = 0;
  for (int i = 0; i < 200; ++i) {
    const Moved body(random_ways(random, 0.6));
    const double sign = signed_volume(body.at_first());
    const double share = signed_volume(body.before) / sign;
    if (share > 0.2) {
      EXPECT_EQ(body.after, body.before);
      continue;
    }
    ++righted;
    EXPECT_LT(body.most_strained(), 1e-13);
    EXPECT_GT(signed_volume(body.after) * sign, 0);
    Vec3 push{}, torque{};
    for (std::uint32_t k = 0; k < 4; ++k) {
      const Vec3 by = body.kind.front().mass_of(k) * (body.after[k] - body.before[k]);
      push += by;
      torque += cross(body.before[k], by);
    }
    EXPECT_LT(norm(push), 1e-13);
    EXPECT_LT(norm(torque), 1e-13);
  }
  EXPECT_GT(righted, 50) << "so few that the test does not say much";
}

// Its other particles go round the fixed ones, to the millionth of a way of 2 m that their weight lets pass.
TEST(CrowdBodies, AreRightedAboutWhatIsFixed) {
  test::Random random(4);
  for (const std::uint32_t fixed : {1u, 2u, 3u}) {
    int righted = 0;
    for (int i = 0; i < 200; ++i) {
      const Moved body(random_ways(random, 1), fixed);
      const double sign = signed_volume(body.at_first());
      if (signed_volume(body.before) / sign > 0.2) continue;
      ++righted;
      for (std::uint32_t k = 4 - fixed; k < 4; ++k) EXPECT_EQ(body.after[k], body.before[k]);
      EXPECT_LT(body.most_strained(), 1e-5);
      EXPECT_GT(signed_volume(body.after) * sign, 0);
    }
    EXPECT_GT(righted, 20) << fixed << ": so few that the test does not say much";
  }
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
