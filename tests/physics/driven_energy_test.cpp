// Anchors that move, and rods that change their length, do work. What islands with bodies gain beside that is
// taken back as where nothing is driven.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "plumb/plumb.hpp"
#include "support/bodies.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::frame;

constexpr std::uint32_t links = 10;
constexpr double link = 0.2;  // m

/// A box hangs from a light rope, whose first particle is fixed, and swings.
Scene crane(double mass, Vec3 velocity) {
  Scene scene;
  for (std::uint32_t i = 0; i <= links; ++i) {
    const Vec3 at{0, -link * i, 0};
    scene.particles.push_back(i == 0 ? test::fixed(at) : test::movable(at, mass / 100, velocity));
    if (i > 0) scene.rods.push_back({.a = i - 1, .b = i});
  }
  constexpr double half = 0.25;
  MassProperties box = solid_box(mass, {2 * half, 2 * half, 2 * half});
  box.center = {0, -link * links - half, 0};
  const std::uint32_t body = add_body(scene, box);
  scene.pins.push_back({point_at(links), point_on_body(scene, body, {0, -link * links, 0})});
  for (Particle& particle : scene.particles)
    if (!particle.fixed) particle.velocity = velocity;
  return scene;
}

double energy(const Scene& scene, const World& world) {
  return measure_energy(scene, test::positions_of(world), test::velocities_of(world), MassModel::consistent)
      .total();
}

/// Returns the most energy (J) that is gained in `frames` frames, before which drive(world, frame) is called.
template <class Drive>
double most_gained(const Scene& scene, int frames, Drive&& drive) {
  World world(scene, {.threads = 1});
  const double before = energy(scene, world);
  double most = 0;
  for (int i = 0; i < frames; ++i) {
    drive(world, i);
    world.step(frame);
    most = std::max(most, energy(scene, world) - before);
  }
  return most;
}

// A nanometre to and fro does next to no work: 10⁻⁷ m/s against 30 kN in the worst substep are millijoules a
// second at most. Before, boxes of 20 kg gained 374 J in 10 s, and those of 200 kg 7,000 times their motion.
TEST(DrivenEnergy, OfWhatTremblesIsThatOfWhatRests) {
  for (const double mass : {20.0, 200.0}) {
    const Scene scene = crane(mass, {2, 0, 0});
    const double motion = 0.5 * 1.1 * mass * 4;
    EXPECT_LT(most_gained(scene, 300, [](World&, int) {}), 1e-9 * motion);
    EXPECT_LT(most_gained(scene, 300,
                          [](World& world, int i) {
                            world.move_anchor(0, {i % 2 == 0 ? 1e-9 : -1e-9, 0, 0});
                          }),
              1e-4 * motion);
    EXPECT_LT(
        most_gained(scene, 300,
                    [](World& world, int i) { world.set_length(3, link + (i % 2 == 0 ? 1e-9 : -1e-9)); }),
        1e-4 * motion);
  }
}

// Seen from an anchor that goes evenly, nothing does work. What swings there has no more energy than at the
// start, in the anchor's frame. Before, it had up to 29 times as much.
TEST(DrivenEnergy, IsKeptInTheFrameOfAnAnchor) {
  for (const double mass : {2.0, 20.0, 200.0})
    for (const Vec3 u : {Vec3{1.2, 0, 0}, Vec3{0.5, 0.4, -0.3}, Vec3{0, -1, 0}}) {
      const Scene scene = crane(mass, {});
      World world(scene, {.threads = 1});
      const auto seen = [&](double t) {
        std::vector<Vec3> x = test::positions_of(world), v = test::velocities_of(world);
        for (std::size_t k = 0; k < x.size(); ++k) {
          x[k] -= t * u;
          if (!scene.particles[k].fixed) v[k] -= u;
        }
        return measure_energy(scene, x, v, MassModel::consistent).total();
      };
      const double before = seen(0), motion = 0.5 * 1.1 * mass * dot(u, u);
      double most = 0, least = 0;
      for (int i = 1; i <= 240; ++i) {
        world.move_anchor(0, (i * frame) * u);
        world.step(frame);
        most = std::max(most, seen(i * frame) - before);
        least = std::min(least, seen(i * frame) - before);
      }
      EXPECT_LT(most, 1e-9 * motion) << mass << ' ' << u.y;
      if (u.y == 0) {  // else the anchor jerks the rope, which is a blow
        EXPECT_GT(least, -1e-9 * motion) << mass;
      }
    }
}

// A crane brings its load from rest to 1.2 m/s at once and stops. A load of mass M gets no more than 2 M v².
TEST(DrivenEnergy, OfACraneIsBounded) {
  const Scene scene = crane(200, {});
  const double v = 1.2, most = most_gained(scene, 600, [&](World&world, int i) {
                          world.move_anchor(0, {v * frame * std::min(i + 1, 120), 0, 0});
                        });
  EXPECT_LT(most, 2 * 220 * v * v);
  EXPECT_GT(most, 0.1 * 220 * v * v);  // it swings
}

// A box hangs from two ropes, whose anchors go as they like while a rod is paid out. What is taken back is of
// third order in a substep, so that errors are of second order still.
TEST(DrivenEnergy, LeavesTheOrder) {
  const auto run = [](std::uint32_t substeps) {
    Scene scene;
    MassProperties box = solid_box(2, {0.6, 0.2, 0.4});
    box.center = {0, -0.95, 0};
    const std::uint32_t body = add_body(scene, box);
    std::vector<std::uint32_t> anchors;
    for (const double x : {-0.25, 0.25}) {
      const auto first = static_cast<std::uint32_t>(scene.particles.size());
      anchors.push_back(first);
      for (std::uint32_t i = 0; i <= 3; ++i) {
        const Vec3 at{x, -0.85 / 3 * i, 0};
        scene.particles.push_back(i == 0 ? test::fixed(at) : test::movable(at, 0.5));
        if (i > 0) scene.rods.push_back({.a = first + i - 1, .b = first + i});
      }
      scene.pins.push_back({point_at(first + 3), point_on_body(scene, body, {x, -0.85, 0})});
    }
    World world(scene, {.method = Method::direct, .gradient = Gradient::old, .substeps = substeps});
    const auto last = static_cast<std::uint32_t>(scene.rods.size() - 1);
    for (int i = 1; i <= 30; ++i) {
      const double t = i * frame;
      world.move_anchor(anchors[0], {-0.25 + 0.3 * std::sin(5 * t), 0.1 * std::sin(7 * t), 0});
      world.move_anchor(anchors[1], {0.25 - 0.2 * t, 0, 0.1 * t});
      world.set_length(last, 0.85 / 3 + 0.2 * t);
      world.step(frame);
    }
    return test::positions_of(world);
  };
  const std::vector<Vec3> truth = run(256);
  const double coarse = rms_distance(run(2), truth), fine = rms_distance(run(4), truth);
  EXPECT_LT(fine, 1e-4);
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.2);
}

// What an anchor gave stays when it stops: flights of a higher order do not go back to the energy of before.
TEST(DrivenEnergy, StaysWhereAnAnchorStops) {
  const Scene scene = crane(20, {1, 0, 0});
  World world(
      scene,
      {.method = Method::direct, .gradient = Gradient::old, .substeps = 8, .time_order = 4, .threads = 1});
  const double before = energy(scene, world);
  test::run(world, frame, 20);
  EXPECT_NEAR(energy(scene, world), before, 1e-6);
  for (int i = 1; i <= 30; ++i) {
    world.move_anchor(0, {0.01 * i, 0.02 * i, 0});
    world.step(frame);
  }
  test::run(world, frame, 2);
  const double after = energy(scene, world);
  EXPECT_GT(after, before + 50);  // 22 kg were lifted by 0.6 m
  test::run(world, frame, 60);
  EXPECT_NEAR(energy(scene, world), after, 1e-3);
}

/// A rope of elastic rods that hangs from an anchor, and a bar of anchors that comes at 0.6 m/s, `below` (m)
/// it.
Scene make_squeezed(double below) {
  Scene scene;
  for (std::uint32_t i = 0; i <= 3; ++i) {
    const Vec3 at{0, -0.1 * i, 0};
    scene.particles.push_back(i == 0 ? test::fixed(at) : test::movable(at, 0.05));
    if (i == 0) continue;
    scene.rods.push_back({.a = i - 1, .b = i, .law = {.stiffness = 2e4}});
    scene.capsules.push_back({.a = point_at(i - 1), .b = point_at(i), .radius = 0.02});
  }
  for (const double z : {-0.5, 0.5}) scene.particles.push_back(test::fixed({-0.3, -below, z}));
  scene.capsules.push_back({.a = point_at(4), .b = point_at(5), .radius = 0.02});
  return scene;
}

// Beside the anchor the bar turns a rod as fast as it likes, and nothing bears its push but the rod's
// stretch. Levers give what they touch 3 to 10 times the bar's speed before it is 1 cm below; thrown things
// got 69 m/s.
TEST(DrivenEnergy, ThrowsNothingThatIsSqueezed) {
  for (const Method method : {Method::direct, Method::relax})
    for (const double below : {0.06, 0.03, 0.01}) {
      World world(make_squeezed(below),
                  {.method = method, .substeps = method == Method::relax ? 8u : 1u, .threads = 1});
      double fastest = 0;
      for (int i = 0; i < 120; ++i) {
        for (const std::uint32_t end : {4u, 5u})
          world.move_anchor(end, world.position(end) + Vec3{0.01, 0, 0});
        world.step(1.0 / 60);
        for (std::uint32_t k = 1; k <= 3; ++k) fastest = std::max(fastest, norm(world.velocity(k)));
      }
      EXPECT_LT(fastest, 20) << to_string(method) << ' ' << below;
      EXPECT_GT(fastest, 2) << "it is pushed";
    }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
