// Rods that change their length wherever their island is: in free flight, in contact, with joints, relaxed.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "plumb/plumb.hpp"
#include "support/refusals.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr double frame = 1.0 / 60, pi = std::numbers::pi;

/// Two unit masses at the ends of a rod of 1 m, which turn about their middle once in so many seconds.
/// `shaped` ones have capsules, which contact looks at, above a plane that they never touch.
Scene spinner(double period, bool shaped) {
  Scene scene;
  scene.gravity = {};
  const double speed = 0.5 * 2 * pi / period;
  scene.particles = {{.position = {0.5, 0, 0}, .velocity = {0, speed, 0}, .mass = 1},
                     {.position = {-0.5, 0, 0}, .velocity = {0, -speed, 0}, .mass = 1}};
  scene.rods = {{.a = 0, .b = 1}};
  if (!shaped) return scene;
  scene.capsules.push_back({.a = point_at(0), .b = point_at(1), .radius = 0.01});
  scene.planes.push_back({.normal = {0, 0, 1}, .offset = -0.0105});
  return scene;
}

double spin_of(const World& world) {
  Vec3 sum{};
  for (std::uint32_t i = 0; i < 2; ++i) sum += cross(world.position(i), world.velocity(i));
  return sum.z;
}

/// Holds what became of a spinner whose rod was hauled in at 0.5 m/s for a second.
struct Spun {
  double turn_error, spin_error, length_error;  ///< rad, kg m²/s, m
  double work, energy;                          ///< J, what the rod did, and what motion gained
};

double kinetic_of(const World& world) {
  double sum = 0;
  for (std::uint32_t i = 0; i < 2; ++i) sum += 0.5 * dot(world.velocity(i), world.velocity(i));
  return sum;
}

Spun haul(const Settings& settings, bool shaped, std::uint32_t frames) {
  constexpr double period = 4;
  World world(spinner(period, shaped), settings);
  const double spin = spin_of(world), dt = 1.0 / frames, before = kinetic_of(world);
  double work = 0;
  for (std::uint32_t i = 1; i <= frames; ++i) {
    world.set_length(0, 1 - 0.5 * i * dt);
    world.step(dt);
    work += dt * world.power(0);
  }
  // The turn is the integral of spin over 2 (L/2)², with L = 1 - t/2.
  const double turned = std::atan2(world.position(0).y, world.position(0).x),
               exact = 2 * pi / period * 2 * (1 / 0.5 - 1);
  return {std::abs(std::remainder(turned - exact, 2 * pi)), std::abs(spin_of(world) - spin),
          std::abs(norm(world.position(0) - world.position(1)) - 0.5), work, kinetic_of(world) - before};
}

// Solved, order and spin are kept, beside what may touch as well as in flight. The length is kept to what
// counts as solved, 1e-7 of it. Energy grows by the work done, to the order of the step.
TEST(ChangedLengths, ConvergeWhereSolved) {
  for (const bool shaped : {false, true})
    for (const Gradient gradient : {Gradient::old, Gradient::mid}) {
      SCOPED_TRACE(std::string(to_string(gradient)) + (shaped ? " shaped" : ""));
      const Settings settings{.method = Method::direct, .gradient = gradient, .tensions = true};
      const Spun coarse = haul(settings, shaped, 120), fine = haul(settings, shaped, 240);
      EXPECT_NEAR(std::log2(coarse.turn_error / fine.turn_error), 2, 0.05);
      EXPECT_LE(fine.turn_error, 2e-4);
      EXPECT_LE(fine.spin_error, 1e-9);
      EXPECT_LE(fine.length_error, 1e-7);
      EXPECT_NEAR(fine.work, fine.energy, 0.01 * fine.energy);
    }
}

// Relaxed, gradient old does as well in flight. What damps motion loses spin as it does of rods that keep
// their lengths, by shares of w² dt.
TEST(ChangedLengths, ConvergeWhereRelaxed) {
  for (const bool shaped : {false, true})
    for (const Gradient gradient : {Gradient::old, Gradient::mid, Gradient::new_}) {
      SCOPED_TRACE(std::string(to_string(gradient)) + (shaped ? " shaped" : ""));
      Settings settings{.method = Method::relax, .gradient = gradient, .tensions = true};
      settings.stop.sweeps = 60;
      const Spun coarse = haul(settings, shaped, 120), fine = haul(settings, shaped, 240);
      const bool is_second = gradient == Gradient::old && !shaped;
      EXPECT_NEAR(std::log2(coarse.turn_error / fine.turn_error), is_second ? 2 : 1, 0.1);
      EXPECT_LE(fine.turn_error, is_second ? 2e-4 : 0.07);
      EXPECT_LE(fine.length_error, 1e-6);
    }
}

/// A rope of six rods of 0.1 m hangs 0.7 m above a floor, with 5 kg at its end and capsules along it.
Scene hoist() {
  Scene scene;
  scene.drag = 2;
  scene.planes.push_back({.normal = {0, 1, 0}, .offset = 0});
  for (std::uint32_t i = 0; i <= 6; ++i)
    scene.particles.push_back({.position = {0, 1.3 - 0.1 * i, 0}, .mass = i == 6 ? 5 : 0.1, .fixed = i == 0});
  for (std::uint32_t i = 0; i < 6; ++i) scene.rods.push_back({.a = i, .b = i + 1, .length = 0.1});
  for (std::uint32_t i = 1; i < 6; ++i)
    scene.capsules.push_back({.a = point_at(i), .b = point_at(i + 1), .radius = 0.02});
  return scene;
}

template <class F>
void for_methods(F&& f) {
  for (const Method method : {Method::automatic, Method::direct, Method::relax})
    for (const Precision precision : {Precision::double_, Precision::single}) {
      SCOPED_TRACE(std::string(to_string(method)) + " " + std::string(to_string(precision)));
      Settings settings{.method = method, .precision = precision, .substeps = 4, .tensions = true};
      if (method == Method::relax) settings.stop.sweeps = 100;
      f(settings);
    }
}

/// Changes a rod's length at 0.5 m/s until it is `to` (m).
void wind(World& world, std::uint32_t rod, double from, double to) {
  const int frames = static_cast<int>(std::lround(std::abs(to - from) / (0.5 * frame)));
  for (int i = 1; i <= frames; ++i) {
    world.set_length(rod, from + (to - from) * i / frames);
    world.step(frame);
  }
}

// A load that is let down lies on the floor, and nothing pulls on the winch but what still hangs. Hauled up
// again, it hangs where it did. Relaxed rods are stretched by their strain.
TEST(ChangedLengths, LetDownToTheFloorAndHaulUpAgain) {
  for_methods([](const Settings& settings) {
    World world(hoist(), settings);
    const double weight = 9.81 * 5.5;
    for (int i = 0; i < 30; ++i) world.step(frame);
    EXPECT_NEAR(world.tension(0), weight, 0.02 * weight);
    wind(world, 0, 0.1, 0.9);
    for (int i = 0; i < 120; ++i) world.step(frame);
    for (std::uint32_t i = 1; i <= 6; ++i) EXPECT_GE(world.position(i).y, 0.019) << i;
    EXPECT_LE(world.position(6).y, 0.025);
    EXPECT_LE(world.tension(0), 9.81 * 0.5) << "the load lies";
    wind(world, 0, 0.9, 0.1);
    for (int i = 0; i < 240; ++i) world.step(frame);
    const double lowest = settings.method == Method::relax ? 0.69 : 0.695;
    EXPECT_GE(world.position(6).y, lowest);
    EXPECT_LE(world.position(6).y, 0.71);
    EXPECT_NEAR(world.tension(0), weight, 0.05 * weight);
  });
}

// A joint that may be limited puts a rope into the other engine, which must do the same.
TEST(ChangedLengths, DoTheSameWithJointsAsWithout) {
  Scene plain;
  for (std::uint32_t i = 0; i <= 3; ++i)
    plain.particles.push_back({.position = {0.1 * i, 0, 0}, .mass = 1, .fixed = i == 0});
  for (std::uint32_t i = 0; i < 3; ++i) plain.rods.push_back({.a = i, .b = i + 1, .length = 0.1});
  Scene jointed = plain;
  jointed.angles.push_back({.u = {point_at(1), point_at(2)}, .v = {point_at(2), point_at(3)}});
  const auto run = [](const Scene& scene, std::uint32_t substeps) {
    World world(scene, {.method = Method::direct, .gradient = Gradient::old, .substeps = substeps});
    wind(world, 1, 0.1, 0.2);
    wind(world, 1, 0.2, 0.05);
    return world.position(3);
  };
  const Vec3 truth = run(plain, 512);
  const double coarse = norm(run(jointed, 8) - truth), fine = norm(run(jointed, 16) - truth);
  EXPECT_LE(fine, 1e-3);
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.3);
}

// Snapshots, threads and other settings leave lengths as they are.
TEST(ChangedLengths, GoOnAfterSnapshotsAndOtherSettings) {
  for_methods([](Settings settings) {
    World world(hoist(), settings);
    wind(world, 0, 0.1, 0.5);
    world.set_length(0, 0.51);
    std::vector<std::byte> kept(world.snapshot_size());
    world.save(kept);
    const auto go_on = [](World& of) {
      for (int i = 0; i < 60; ++i) {
        of.set_length(0, 0.51 + 0.007 * i);
        of.step(frame);
      }
      return of.state_hash();
    };
    const std::uint64_t hash = go_on(world);
    world.restore(kept);
    EXPECT_EQ(go_on(world), hash);
    settings.threads = 2;
    World other(hoist(), settings);
    other.restore(kept);
    EXPECT_EQ(go_on(other), hash);

    world.restore(kept);
    world.step(frame);
    Settings changed = settings;
    changed.threads = 1;
    changed.method = settings.method == Method::relax ? Method::direct : Method::relax;
    changed.stop = changed.method == Method::relax ? StopRule{.sweeps = 100} : StopRule{};
    world.set_settings(changed);
    for (int i = 0; i < 30; ++i) world.step(frame);
    EXPECT_NEAR(norm(world.position(0) - world.position(1)), 0.51, 0.01);
  });
}

// The work of a start beside joints, with gradient mid: a blow, and then pulls at the new rate.
TEST(ChangedLengths, DoTheWorkOfAStartBesideJoints) {
  Scene scene;
  scene.particles = {{.position = {0, 0, 0}, .fixed = true},
                     {.position = {0, -1, 0}, .mass = 1},
                     {.position = {0.5, -1, 0}, .mass = 1}};
  scene.rods = {{.a = 0, .b = 1}, {.a = 1, .b = 2}};
  scene.angles.push_back({.u = {point_at(0), point_at(1)}, .v = {point_at(1), point_at(2)}});
  World world(scene, {.method = Method::direct, .gradient = Gradient::mid, .tensions = true});
  const auto energy = [&] {
    double sum = 0;
    for (std::uint32_t i = 1; i <= 2; ++i)
      sum += 0.5 * dot(world.velocity(i), world.velocity(i)) + 9.81 * world.position(i).y;
    return sum;
  };
  const double before = energy(), dt = 1.0 / 240;
  double work = 0;
  for (int i = 1; i <= 48; ++i) {
    world.set_length(0, 1 - 0.5 * i * dt);
    world.step(dt);
    work += dt * world.power(0);
  }
  EXPECT_GT(work, 1);
  EXPECT_NEAR(work, energy() - before, 1e-3 * work);
}

/// Three rods that hang straight, with a joint at their middle that may be limited.
Scene jointed_line(double mass) {
  Scene scene;
  for (std::uint32_t i = 0; i <= 3; ++i)
    scene.particles.push_back({.position = {0, -0.5 * i, 0}, .mass = mass, .fixed = i == 0});
  for (std::uint32_t i = 0; i < 3; ++i) scene.rods.push_back({.a = i, .b = i + 1});
  scene.angles.push_back({.u = {point_at(1), point_at(2)}, .v = {point_at(2), point_at(3)}});
  return scene;
}

// Relaxed beside joints, a load has the speed of its winch or its anchor as soon as that changes, whatever
// the gradient. It pulls as Newton says, and a winch does the work that energy gains.
TEST(ChangedLengths, ALoadFollowsARelaxedWinchBesideJoints) {
  constexpr double mass = 2, g = 9.81;
  for (const Gradient gradient : {Gradient::old, Gradient::mid, Gradient::new_})
    for (const bool by_anchor : {false, true})
      for (const std::uint32_t substeps : {1u, 2u, 3u}) {
        Settings settings{
            .method = Method::relax, .gradient = gradient, .substeps = substeps, .tensions = true};
        settings.stop.sweeps = 300;
        World world(jointed_line(mass), settings);
        double hauled = 0, rate = 0, work = 0;
        for (int i = 1; i <= 40; ++i) {
          // It jumps, grows, stands for a while, and falls to nothing.
          const double next = i < 5 ? 0.4 : i < 15 ? 0.04 * i : i < 25 ? 0.6 : std::max(0.06 * (35 - i), 0.0);
          hauled += next * frame;
          if (by_anchor)
            world.move_anchor(0, {0, hauled, 0});
          else
            world.set_length(0, 0.5 - hauled);
          world.step(frame);
          SCOPED_TRACE(std::string(to_string(gradient)) + " at " + std::to_string(i));
          ASSERT_NEAR(world.tension(0), 3 * mass * (g + (next - rate) / frame), 1e-6);
          if (by_anchor) {
            ASSERT_NEAR(world.reaction(0).y, world.tension(0), 1e-6);
          }
          ASSERT_NEAR(world.velocity(3).y, next, 1e-8);
          work += frame * (by_anchor ? 0 : world.power(0));
          if (!by_anchor) {
            ASSERT_NEAR(work, 3 * mass * (g * hauled + next * next / 2), 1e-6);
          }
          rate = next;
        }
      }
}

// What swings while its rate jumps every fifth step converges to the same motion as where it is solved.
TEST(ChangedLengths, RelaxedJumpsBesideJointsConverge) {
  const auto run = [](Method method, Gradient gradient, std::uint32_t substeps) {
    Scene scene = jointed_line(1);
    for (Particle& each : scene.particles) each.position = {-each.position.y, 0, 0};
    if (method == Method::direct) scene.angles.clear();
    Settings settings{.method = method, .gradient = gradient, .substeps = substeps};
    settings.stop.sweeps = method == Method::relax ? 1000 : settings.stop.sweeps;
    World world(scene, settings);
    double length = 0.5;
    for (int i = 0; i < 40; ++i) {
      length += i / 5 % 2 == 0 ? -0.005 : 0.003;
      world.set_length(0, length);
      world.step(frame);
    }
    return world.position(3);
  };
  const Vec3 truth = run(Method::direct, Gradient::old, 512);
  for (const Gradient gradient : {Gradient::old, Gradient::mid}) {
    const double coarse = norm(run(Method::relax, gradient, 16) - truth),
                 fine = norm(run(Method::relax, gradient, 32) - truth);
    EXPECT_LE(fine, 1e-3) << to_string(gradient);
    EXPECT_NEAR(std::log2(coarse / fine), 2, 0.3) << to_string(gradient);
  }
}

// A box on a ball joint, hauled up by a rod at its top, neither swings nor tears off its joint.
TEST(ChangedLengths, HaulABodyOnARelaxedBallJoint) {
  for (const Precision precision : {Precision::double_, Precision::single}) {
    Scene scene;
    scene.particles = {{.position = {0, 0, 0}, .fixed = true}, {.position = {0, -1, 0}, .mass = 0.1}};
    scene.rods = {{.a = 0, .b = 1}};
    const std::uint32_t body =
        add_body(scene, {.mass = 2, .center = {0, -1.2, 0}, .inertia = {.xx = 0.1, .yy = 0.1, .zz = 0.1}});
    scene.pins.push_back({.a = point_at(1), .b = point_on_body(scene, body, {0, -1, 0})});
    Settings settings{.method = Method::relax, .precision = precision, .gradient = Gradient::mid};
    settings.substeps = 4;
    settings.stop.sweeps = 200;
    World world(scene, settings);
    for (int i = 1; i <= 60; ++i) {
      world.set_length(0, 1 - 0.3 * frame * (i < 30 ? i : 30));
      world.step(frame);
      const double next = i <= 30 ? 0.3 : 0, off = precision == Precision::single ? 0.02 : 1e-3;
      for (std::uint32_t k = 1; k < world.particle_count(); ++k)
        ASSERT_NEAR(world.velocity(k).y, next, off) << i << " " << k;
    }
  }
}

// Loops whose lengths changed go on in a world that knows of none yet, and reading velocities on the way
// changes no bits.
TEST(ChangedLengths, GoOnInLoops) {
  Scene ring;
  for (std::uint32_t i = 0; i < 4; ++i)
    ring.particles.push_back({.position = {i % 2 * 0.1, i / 2 * -0.1, 0}, .mass = 0.1, .fixed = i == 0});
  for (const auto& [a, b] : {std::pair{0u, 1u}, {0u, 2u}, {1u, 3u}, {2u, 3u}})
    ring.rods.push_back({.a = a, .b = b, .length = 0.1});
  for (const Gradient gradient : {Gradient::old, Gradient::mid, Gradient::new_}) {
    const Settings settings{.method = Method::direct, .gradient = gradient, .substeps = 2};
    World world(ring, settings), read(ring, settings);
    for (int i = 0; i < 20; ++i)
      for (World* const each : {&world, &read}) {
        each->set_length(1, 0.1 + 0.002 * i);
        each->step(frame);
        if (each == &read) {
          EXPECT_TRUE(is_finite(each->velocity(3)));
        }
      }
    EXPECT_EQ(world.state_hash(), read.state_hash());
    std::vector<std::byte> kept(world.snapshot_size());
    world.save(kept);
    World fresh(ring, settings);
    fresh.restore(kept);
    for (int i = 0; i < 20; ++i)
      for (World* const each : {&world, &fresh}) each->step(frame);
    EXPECT_EQ(world.state_hash(), fresh.state_hash());
  }
}

// Ropes that were made anew, here by a cut, have the lengths of then.
TEST(ChangedLengths, StayWhereARopeIsCut) {
  for_methods([](const Settings& settings) {
    World world(hoist(), settings);
    wind(world, 0, 0.1, 0.4);
    wind(world, 2, 0.1, 0.2);
    world.cut(4);
    world.set_length(0, 0.41);
    for (int i = 0; i < 120; ++i) world.step(frame);
    EXPECT_NEAR(norm(world.position(0) - world.position(1)), 0.41, 1e-3);
    EXPECT_NEAR(norm(world.position(2) - world.position(3)), 0.2, 1e-3);
    EXPECT_LE(world.position(6).y, 0.03) << "the load has fallen";
    wind(world, 2, 0.2, 0.1);
    EXPECT_NEAR(norm(world.position(2) - world.position(3)), 0.1, 1e-3);
  });
}

TEST(ChangedLengths, AreRefusedWithAReason) {
  Scene scene = hoist();
  const std::uint32_t body =
      add_body(scene, {.mass = 1, .center = {3, 3, 0}, .inertia = {.xx = 1, .yy = 1, .zz = 1}});
  scene.rods[5].law.stiffness = 1e6;
  World world(scene, {});
  const auto refusal = [&](std::uint32_t rod) { return test::refusal([&] { world.set_length(rod, 0.2); }); };
  EXPECT_EQ(refusal(5),
            "rod 5: its length cannot change, since it gives, where its island has joints or shapes");
  EXPECT_EQ(refusal(6), "rod 6: its length cannot change, since a body holds both its ends") << body;
  EXPECT_EQ(refusal(0), "");
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
