// Islands that broken rods take apart go on as the islands that they are then.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "scenes/basics/seeded.hpp"
#include "scenes/generators/generators.hpp"
#include "step/breaks/breaks.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::fixed;
using test::movable;

constexpr double frame = 1.0 / 60;
constexpr double g = 9.81;
constexpr Vec3 weight{0, -g, 0};  ///< Of a kilogram, in N.

/// Appends a chain of `rods` rods of 0.1 m that hangs from an anchor at x. Rod `weak` holds `strength` (N).
void add_chain(Scene& scene, double x, std::uint32_t rods, std::uint32_t weak, double strength) {
  const auto first = static_cast<std::uint32_t>(scene.particles.size());
  scene.particles.push_back(fixed({x, 0, 0}));
  for (std::uint32_t i = 1; i <= rods; ++i) {
    // It starts aside, so that pulls grow as it swings.
    scene.particles.push_back(movable({x + 0.06 * i, -0.08 * i, 0}));
    scene.rods.push_back({.a = first + i - 1, .b = first + i});
    if (i - 1 == weak) scene.rods.back().law.strength = strength;
  }
}

Vec3 momentum(const Scene& scene, const World& world, std::uint32_t first, std::uint32_t end) {
  Vec3 sum;
  for (std::uint32_t i = first; i < end; ++i) sum += scene.particles[i].mass * world.velocity(i);
  return sum;
}

// The lower part falls freely with its momentum, and the upper one hangs on.
TEST(BrokenIslands, KeepTheirMomentum) {
  for (const Method method : {Method::direct, Method::relax})
    for (const Precision precision : {Precision::double_, Precision::single})
      for (const Gradient gradient : {Gradient::mid, Gradient::old, Gradient::new_}) {
        Scene scene;
        add_chain(scene, 0, 12, 5, 8.5 * g);
        Settings settings{
            .method = method, .precision = precision, .gradient = gradient, .substeps = 4, .threads = 1};
        if (method == Method::relax) settings.stop.sweeps = 100;
        World world(scene, settings);
        const double rounding = precision == Precision::single ? 1e-5 : 1e-12;
        int after = -1;
        Vec3 last;
        for (int i = 0; i < 120; ++i) {
          const StepReport report = world.step(frame);
          EXPECT_EQ(report.unsolved, 0u);
          if (after < 0 && report.broken_rods == 0) continue;
          const Vec3 now = momentum(scene, world, 6, 13);
          if (++after > 0) {
            EXPECT_EQ(report.awake_islands, 2u);
            EXPECT_LE(norm(now - last - 7 * frame * weight), rounding * norm(now))
                << to_string(method) << ' ' << to_string(gradient) << ' ' << after;
          }
          last = now;
        }
        EXPECT_GT(after, 30);
        if (method == Method::direct) {
          EXPECT_TRUE(world.problems().empty());
        }
      }
}

/// A world of the parts of `scene` with the state of `world`, without the rods that broke.
Scene broken_twin(const Scene& scene, const World& world) {
  Scene out = scene;
  for (std::uint32_t i = 0; i < scene.particles.size(); ++i) {
    out.particles[i].position = world.position(i);
    out.particles[i].velocity = world.velocity(i);
  }
  out.rods.clear();
  for (std::uint32_t i = 0; i < scene.rods.size(); ++i)
    if (!world.is_broken(i)) {
      out.rods.push_back(scene.rods[i]);
      out.rods.back().length = rod_length(scene, i);
    }
  return out;
}

// The same motion follows as from a scene of the parts. Its start is projected, to where a tenth of Newton's
// tolerance of 1e-9 of a rod grows.
TEST(BrokenIslands, MoveAsAWorldOfTheirParts) {
  Scene scene;
  for (std::uint32_t i = 0; i < 5; ++i) add_chain(scene, i, 10, 3 + i % 3, (7.0 + 0.1 * i) * g);
  const Settings settings{.method = Method::direct, .gradient = Gradient::mid, .substeps = 4, .threads = 1};
  World world(scene, settings);
  std::uint64_t broken = 0;
  while (broken < 5 && world.time() < 5) broken += world.step(frame).broken_rods;
  ASSERT_EQ(broken, 5u);
  World twin(broken_twin(scene, world), settings);
  for (int i = 0; i < 30; ++i) {
    const StepReport report = world.step(frame), of_twin = twin.step(frame);
    EXPECT_EQ(report.awake_islands, of_twin.awake_islands);
    EXPECT_EQ(report.direct_substeps, of_twin.direct_substeps);
  }
  EXPECT_LE(rms_distance(test::positions_of(world), test::positions_of(twin)), 1e-8);
}

// What does not break has the bits that it has in a world where nothing breaks.
TEST(BrokenIslands, LeaveOthersTheirBits) {
  Scene scene;
  for (std::uint32_t i = 0; i < 9; ++i)
    add_chain(scene, i, 8, 2, i == 4 ? 7 * g : std::numeric_limits<double>::infinity());
  Scene whole = scene;
  for (Rod& rod : whole.rods)
    if (std::isfinite(rod.law.strength)) rod.law.strength = 1e6;
  for (const Method method : {Method::direct, Method::relax}) {
    const Settings settings{.method = method, .threads = 1};
    World world(scene, settings), other(whole, settings);
    const StepReport total = test::run(world, frame, 90);
    test::run(other, frame, 90);
    EXPECT_EQ(total.broken_rods, 1u);
    for (std::uint32_t i = 0; i < scene.particles.size(); ++i)
      if (i / 9 != 4) {
        EXPECT_EQ(world.position(i), other.position(i)) << i;
        EXPECT_EQ(world.velocity(i), other.velocity(i)) << i;
      }
  }
}

// Numbers of threads and instruction sets change no bit, though solvers come and go.
TEST(BrokenIslands, HaveTheSameBitsEverywhere) {
  Scene scene;
  for (std::uint32_t i = 0; i < 40; ++i) add_chain(scene, i, 12, i % 9, (4.5 + 0.3 * i) * g);
  const auto hash = [&](Method method, unsigned threads, Isa isa) {
    World world(scene, {.method = method, .isa = isa, .threads = threads});
    EXPECT_GT(test::run(world, frame, 120).broken_rods, 10u);
    return world.state_hash();
  };
  for (const Method method : {Method::direct, Method::relax}) {
    const std::uint64_t first = hash(method, 1, Isa::scalar);
    for (const Isa isa : {Isa::scalar, best_isa()})
      for (const unsigned threads : {1u, 2u}) EXPECT_EQ(hash(method, threads, isa), first);
  }
}

// Forces, loads, anchors that move and lengths that change go on through a break.
TEST(BrokenIslands, KeepWhatActsOnThem) {
  Scene scene;
  add_chain(scene, 0, 6, 2, 1e3);
  scene.gravity = {};
  for (std::uint32_t i = 1; i <= 6; ++i) scene.particles[i].position = {0, -0.1 * i, 0};
  World world(scene, {.method = Method::direct, .gradient = Gradient::old, .tensions = true, .threads = 1});
  world.set_force(6, {0, -2e3, 0});
  EXPECT_EQ(world.step(frame).broken_rods, 1u);
  EXPECT_NEAR(world.tension(2), 2e3 / 8, 1e-6) << "for half of the first of four pieces";
  const double speed = momentum(scene, world, 3, 7).y;
  world.set_length(1, 0.09);
  world.set_length(2, 0.05);  // it is broken: nothing happens
  world.move_anchor(0, {0, 0.01, 0});
  EXPECT_EQ(world.step(frame).broken_rods, 0u);
  EXPECT_NEAR(momentum(scene, world, 3, 7).y, speed - 2e3 * frame, 1e-9 * 2e3);
  EXPECT_EQ(world.tension(2), 0);
  EXPECT_TRUE(world.is_broken(2));
  EXPECT_NEAR(norm(world.position(2) - world.position(1)), 0.09, 1e-12);
  EXPECT_NEAR(norm(world.position(1) - Vec3{0, 0.01, 0}), 0.1, 1e-12);
}

// Parts fall asleep each by itself.
TEST(BrokenIslands, SleepByThemselves) {
  Scene scene;
  add_chain(scene, 0, 6, 2, 3.5 * g);
  for (std::uint32_t i = 1; i <= 6; ++i) scene.particles[i].position = {0, -0.1 * i, 0};
  scene.drag = 5;
  World world(scene, {.method = Method::direct, .gradient = Gradient::new_, .threads = 1});
  StepReport report;
  for (int i = 0; i < 1200; ++i) report = world.step(frame);
  EXPECT_EQ(report.awake_islands, 1u);
  EXPECT_EQ(world.velocity(2), Vec3{});
  EXPECT_LT(world.velocity(6).y, -0.9 * g / 5);
}

// A twist holds its island together until one of its own rods breaks; then all parts go on by themselves.
TEST(BrokenIslands, StayWholeWhileATwistHolds) {
  Scene scene;
  add_chain(scene, 0, 10, 4, 100);
  scene.rods[7].law.strength = 2.9 * g;  // three particles hang from it
  for (std::uint32_t i = 1; i <= 10; ++i) scene.particles[i].position = {0, -0.1 * i, 0};
  for (std::uint32_t i = 1; i < 10; ++i)
    scene.bends.push_back({.a = i - 1, .b = i, .c = i + 1, .stiffness = 0.1});
  for (const bool holds : {true, false}) {
    scene.twists = {
        {.particles = holds ? std::vector<std::uint32_t>{0, 1, 2, 3} : std::vector<std::uint32_t>{3, 4, 5, 6},
         .stiffness = 0.1,
         .angle = 1}};
    World world(scene, {.substeps = 4, .threads = 1});
    EXPECT_EQ(test::run(world, frame, 10).broken_rods, 1u);
    EXPECT_EQ(world.step(frame).awake_islands, 1u);
    world.set_force(6, {0, -200, 0});
    EXPECT_EQ(world.step(frame).broken_rods, 1u);
    world.set_force(6, {});
    EXPECT_EQ(world.step(frame).awake_islands, holds ? 1u : 3u);
    if (!holds) {
      EXPECT_EQ(world.twist(0), 0);
    }
  }
}

// What fell from a block of relaxed islands is not there any more: it does not break again, nor keep others
// awake.
TEST(BrokenIslands, LeaveTheirBlock) {
  Scene scene;
  add_chain(scene, 0, 6, 2, 3.5 * g);
  add_chain(scene, 1, 6, 9, 0);
  for (std::uint32_t i = 0; i < 7; ++i)
    for (const std::uint32_t first : {0u, 7u}) scene.particles[first + i].position.x = first;
  scene.drag = 5;
  Settings settings{.method = Method::relax, .threads = 1};
  settings.stop.sweeps = 200;
  World world(scene, settings);
  StepReport last;
  std::uint64_t broken = 0;
  for (int i = 0; i < 2400; ++i) broken += (last = world.step(frame)).broken_rods;
  EXPECT_EQ(broken, 1u);
  EXPECT_EQ(last.awake_islands, 1u);
  EXPECT_EQ(world.velocity(13), Vec3{});
  EXPECT_LT(world.velocity(6).y, -0.9 * g / 5);
}

// Gradient new's velocity is the mean of its last substep, which was another one than the next.
TEST(BrokenIslands, FallFreelyWhereSubstepsChange) {
  Scene scene;
  add_chain(scene, 0, 12, 5, 8.5 * g);
  World world(scene, {.method = Method::direct, .gradient = Gradient::new_, .substeps = 4, .threads = 1});
  while (world.step(frame).broken_rods == 0) ASSERT_LT(world.time(), 2);
  const auto height = [&] {
    double sum = 0;
    for (std::uint32_t i = 6; i < 13; ++i) sum += world.position(i).y;
    return sum / 7;
  };
  const double before = height(), dt = frame / 2;
  const double speed = momentum(scene, world, 6, 13).y / 7 - g * frame / 8;
  world.step(dt);
  EXPECT_NEAR(height(), before + speed * dt - g * dt * dt / 2, 1e-13);
}

// A rod with mass spread along it still joins its ends; where it is lumped they take it.
TEST(BrokenIslands, StayWholeWhereTheMassOfARodJoinsThem) {
  for (const MassModel model : {MassModel::consistent, MassModel::lumped}) {
    Scene scene;
    add_chain(scene, 0, 6, 2, 3.5 * g);
    for (Rod& rod : scene.rods) rod.mass = 0.1;
    World world(scene, {.method = Method::direct, .mass = model, .threads = 1});
    StepReport last;
    std::uint64_t broken = 0;
    for (int i = 0; i < 60; ++i) broken += (last = world.step(frame)).broken_rods;
    EXPECT_EQ(broken, 1u);
    EXPECT_EQ(last.awake_islands, model == MassModel::lumped ? 2u : 1u);
  }
}

// A wire that breaks goes on as two, each with its bends, and a tackle that breaks nothing holds both parts.
TEST(BrokenIslands, KeepBendsAndTackles) {
  Scene wire;
  add_chain(wire, 0, 10, 4, 6.5 * g);
  for (std::uint32_t i = 1; i < 10; ++i)
    wire.bends.push_back({.a = i - 1, .b = i, .c = i + 1, .stiffness = 5});
  World world(wire, {.threads = 1});
  StepReport last;
  std::uint64_t broken = 0;
  for (int i = 0; i < 90; ++i) {
    broken += (last = world.step(frame)).broken_rods;
    EXPECT_EQ(last.unsolved + last.elastic_substeps, 0u);
  }
  EXPECT_EQ(broken, 1u);
  EXPECT_EQ(last.awake_islands, 2u);
  EXPECT_GT(norm(world.position(10) - world.position(8)), 0.19);  // its bends hold it nearly straight

  wire.bends.clear();
  wire.tackles.push_back({.particles = {2, 7}, .length = 1.5, .law = {.one_sided = true}});
  World tied(wire, {.threads = 1});
  broken = 0;
  for (int i = 0; i < 90; ++i) broken += (last = tied.step(frame)).broken_rods;
  EXPECT_EQ(broken, 1u);
  EXPECT_EQ(last.awake_islands, 1u);
  EXPECT_LE(norm(tied.position(7) - tied.position(2)), 1.5 * (1 + 1e-9));
}

// Free nets that tear into many parts keep momentum and angular momentum to rounding through all of it.
TEST(BrokenIslands, KeepMomentumOfATornNet) {
  Scene scene = scenes::make_net(12, 12);
  scene.gravity = {};
  std::mt19937_64 random(3);
  for (Particle& particle : scene.particles) {
    particle.fixed = false;
    particle.mass = 0.1;
    particle.velocity = 4.0 * (particle.position - 0.5 * scene.particles.back().position) +
                        Vec3{0, 0, scenes::unit_double(random)};
  }
  for (Rod& rod : scene.rods) rod.law = {.stiffness = 1e3, .strength = 4 + 8 * scenes::unit_double(random)};
  World world(scene, {.gradient = Gradient::mid, .threads = 2});
  const auto both = [&] {
    const std::vector<Vec3> x = test::positions_of(world), v = test::velocities_of(world);
    Vec3 sum, turn;
    for (std::size_t i = 0; i < x.size(); ++i) {
      sum += 0.1 * v[i];
      turn += 0.1 * cross(x[i], v[i]);
    }
    return std::pair{sum, turn};
  };
  const auto [sum, turn] = both();
  StepReport last;
  std::uint64_t broken = 0;
  for (int i = 0; i < 120; ++i) broken += (last = world.step(frame)).broken_rods;
  EXPECT_GT(broken, 50u);
  EXPECT_GT(last.awake_islands, 5u);
  const double scale = 0.1 * 144 * 3;
  EXPECT_LE(norm(both().first - sum), 1e-10 * scale);
  EXPECT_LE(norm(both().second - turn), 1e-9 * scale);
}

// A steady anchor is no blow to parts that go on from it: the pull is that of an island which a slack cable
// keeps whole.
TEST(BrokenIslands, KnowHowFastTheirAnchorsGo) {
  for (const Gradient gradient : {Gradient::mid, Gradient::old, Gradient::new_})
    for (const bool has_mass : {false, true}) {
      Scene scene;
      add_chain(scene, 0, 6, 3, 20 * g);
      for (std::uint32_t i = 1; i <= 6; ++i) scene.particles[i].position = {0, -0.1 * i, 0};
      for (std::uint32_t i = 0; has_mass && i < 3; ++i) scene.rods[i].mass = 0.5;
      Scene whole = scene;
      whole.rods.push_back({.a = 1, .b = 5, .length = 100, .law = {.stiffness = 1, .one_sided = true}});
      const Settings settings{
          .method = Method::direct, .gradient = gradient, .substeps = 2, .tensions = true, .threads = 1};
      World world(scene, settings), other(whole, settings);
      for (int i = 1; i <= 40; ++i)
        for (World* const each : {&world, &other}) {
          each->move_anchor(0, {0, 0.02 * i, 0});
          each->set_force(6, {0, i == 30 ? -30 * g : 0, 0});
          each->step(0.01);
        }
      ASSERT_TRUE(world.is_broken(3) && other.is_broken(3));
      EXPECT_NEAR(world.tension(0), other.tension(0), 1e-6 * other.tension(0))
          << to_string(gradient) << has_mass;
      EXPECT_NEAR(world.position(3).y, other.position(3).y, 1e-9) << to_string(gradient) << has_mass;
    }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
