// Hulls that fall on each other in piles, and that touch where their edges cross.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "contact/shapes/hulls/convex_hull.hpp"
#include "plumb/plumb.hpp"
#include "support/bodies.hpp"
#include "support/boxes.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::frame;

constexpr double size = 0.15, wide = 2 * size;  // m, of tetrahedra whose edges are diagonals of such cubes

/// Says how deep any two hulls of a scene are in each other (m), if each body has one.
class Depths {
 public:
  explicit Depths(const Scene& scene) {
    for (const Hull& hull : scene.hulls) {
      hulls_.emplace_back(hull.points);
      std::vector<Point>& points = corners_.emplace_back();
      for (const Vec3 corner : hulls_.back().vertices())
        points.push_back(point_on_body(scene, hull.body, corner));
    }
  }
  double deepest(const World& world) {
    for (std::size_t i = 0; i < hulls_.size(); ++i) {
      std::vector<Vec3> now;
      for (const Point& each : corners_[i]) now.push_back(test::place_of(world, each));
      hulls_[i] = hulls_[i].moved_to(now);
    }
    double most = 0;
    for (std::size_t i = 0; i < hulls_.size(); ++i)
      for (std::size_t k = 0; k < i; ++k)
        if (hulls_[i].bounds().overlaps(hulls_[k].bounds()))
          most = std::max(most, -detail::nearness(hulls_[i].shape(0), hulls_[k].shape(0)).distance);
    return most;
  }

 private:
  std::vector<detail::ConvexHull> hulls_;
  std::vector<std::vector<Point>> corners_;
};

// Thirty tetrahedra fall from up to 18 m. What is left is what turning by up to a third of a radian within a
// substep moves corners by beside the planes they are kept off, a sixth of the width at the worst. Before,
// edges that crossed were pushed at an end, which turned them into each other, by 0.3 of it in the mean.
TEST(HullPiles, HardlyOverlap) {
  constexpr int piles = 8, hulls = 30;
  double sum = 0;
  for (int pile = 0; pile < piles; ++pile) {
    std::mt19937 random(pile);
    std::uniform_real_distribution<double> aside(-0.3, 0.3);
    Scene scene;
    scene.planes.push_back({});
    for (int i = 0; i < hulls; ++i)
      test::add_tetrahedron(scene, {aside(random), 0.4 + 0.6 * i, aside(random)}, size, random);
    World world(scene, {.threads = 1});
    Depths depths(scene);
    double most = 0;
    for (int i = 0; i < 180; ++i) {
      world.step(frame);
      most = std::max(most, depths.deepest(world));
    }
    sum += most;
  }
  EXPECT_LT(sum / piles, wide / 6);
}

/// Adds a tetrahedron between two edges, at right angles, which are diagonals of a cube's top and bottom.
std::uint32_t add_between_edges(Scene& scene, Vec3 middle) {
  const double inertia = 0.4 * size * size;
  const std::uint32_t body = add_body(
      scene, {.mass = 1, .center = middle, .inertia = {.xx = inertia, .yy = inertia, .zz = inertia}});
  Hull hull{.body = body, .surface = {.friction = 0}};
  for (const Vec3 at : {Vec3{1, 1, 1}, Vec3{-1, 1, -1}, Vec3{1, -1, -1}, Vec3{-1, -1, 1}})
    hull.points.push_back(middle + size * at);
  scene.hulls.push_back(hull);
  return body;
}

// The lower edge of one tetrahedron crosses the upper edge of another at the middles of both, and overlaps it
// by a tenth of their width. The push that parts them goes through both centres of mass and turns neither.
// Before, it acted at ends of the edges.
TEST(HullPiles, PartWhereTheirEdgesCross) {
  constexpr double overlap = 0.1 * wide;
  Scene scene;
  scene.gravity = {};
  const std::uint32_t lower = add_between_edges(scene, {0, 0, 0});
  const std::uint32_t upper = add_between_edges(scene, {0, wide - overlap, 0});
  World world(scene, {.threads = 1});
  for (int i = 0; i < 120; ++i) world.step(frame);
  EXPECT_NEAR(test::middle_of(scene, world, upper).y - test::middle_of(scene, world, lower).y, wide, 2e-3)
      << "a slop, and what the share of an overlap that a substep takes back leaves of it";
  for (const std::uint32_t body : {lower, upper}) {
    const std::array<double, 4> turned = world.pose(body).orientation;
    EXPECT_NEAR(std::abs(turned[0]), 1, 1e-6) << "rounding and what sweeps leave";
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
