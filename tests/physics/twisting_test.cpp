// Twists: rings against Michell, what gradient mid keeps, and what the order in time is.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "plumb/plumb.hpp"
#include "support/graphs.hpp"
#include "support/refusals.hpp"
#include "support/worlds.hpp"
#include "truth/truth.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using std::numbers::pi;
using test::fixed;
using test::movable;

/// A ring of length 1 m, bending stiffness 1 N m^2, torsional stiffness `gj` (N m^2) and mass 1 kg, round the
/// z axis, at rest as a circle but for its twist (rad). Gravity is off.
Scene ring(std::uint32_t rods, double gj, double twist) {
  const double l = 1.0 / rods, radius = l / (2 * std::sin(pi / rods));
  Scene scene;
  scene.gravity = {};
  for (std::uint32_t i = 0; i < rods; ++i) {
    const double phi = 2 * pi * i / rods;
    scene.particles.push_back(movable(radius * Vec3{std::cos(phi), std::sin(phi), 0}, l));
    scene.rods.push_back({.a = i, .b = (i + 1) % rods, .length = l});
    scene.bends.push_back({.a = i, .b = (i + 1) % rods, .c = (i + 2) % rods, .stiffness = 1 / l});
  }
  Twist& chain = scene.twists.emplace_back();
  for (std::uint32_t i = 0; i <= rods; ++i) chain.particles.push_back(i % rods);
  chain.stiffness = gj;
  chain.angle = twist;
  return scene;
}

/// A wire of about 1 m along x, clamped at both ends, with EI = GJ = 1 N m^2 and mass 1 kg, slack in an arc
/// that leaves its plane a little.
Scene wire(std::uint32_t rods, double twist) {
  const double l = 1.0 / rods;
  Scene scene;
  std::vector<Vec3> at(rods + 1);
  const auto place = [&](double s) {
    return Vec3{0.92 * s, 0.12 * (1 - std::cos(2 * pi * s)), 0.05 * s * std::sin(2 * pi * s)};
  };
  scene.particles.push_back(fixed(place(0) - Vec3{l, 0, 0}));
  for (std::uint32_t i = 0; i <= rods; ++i) {
    const Vec3 x = place(l * i);
    scene.particles.push_back(i == 0 || i == rods ? fixed(x) : movable(x, l));
    if (i > 0) scene.rods.push_back({.a = i, .b = i + 1, .length = norm(x - scene.particles[i].position)});
  }
  scene.particles.push_back(fixed(place(1) + Vec3{l, 0, 0}));
  Twist& chain = scene.twists.emplace_back();
  for (std::uint32_t i = 0; i < rods + 3; ++i) chain.particles.push_back(i);
  for (std::uint32_t i = 0; i < rods + 1; ++i)
    scene.bends.push_back({.a = i, .b = i + 1, .c = i + 2, .stiffness = (i == 0 || i == rods ? 2 : 1) / l});
  chain.stiffness = 1;
  chain.angle = twist;
  return scene;
}

void give_velocities(Scene& scene, unsigned seed, double most) {
  test::Random random(seed);
  for (Particle& particle : scene.particles) {
    const double x = test::signed_unit(random), y = test::signed_unit(random), z = test::signed_unit(random);
    if (!particle.fixed) particle.velocity = most * Vec3{x, y, z};
  }
}

Settings direct(Gradient gradient, std::uint32_t substeps = 1) {
  return {.method = Method::direct, .gradient = gradient, .substeps = substeps, .threads = 1};
}

double energy_of(const Scene& scene, const World& world) {
  return test::energy_of(scene, world).total() + twist_energy(scene, 0, world.twist(0));
}

/// Carries a cross section from tangent to tangent by the shortest turns.
Vec3 carried(Vec3 section, Vec3 from, Vec3 to) {
  const Vec3 axis = cross(from, to), turned = cross(axis, section);
  return section + turned + 1 / (1 + dot(from, to)) * cross(axis, turned);
}

/// By how much a closed chain's cross section is turned once it was carried round, in (-pi, pi].
double turn_round(const Scene& scene, const std::vector<Vec3>& x) {
  const auto& chain = scene.twists[0].particles;
  std::vector<Vec3> tangents;
  for (std::size_t i = 1; i < chain.size(); ++i) {
    const Vec3 d = x[chain[i]] - x[chain[i - 1]];
    tangents.push_back(1 / norm(d) * d);
  }
  Vec3 first = cross(tangents[0], Vec3{0.3, 0.5, 0.8});
  first = 1 / norm(first) * first;
  Vec3 section = first;
  for (std::size_t i = 0; i < tangents.size(); ++i)
    section = carried(section, tangents[i], tangents[(i + 1) % tangents.size()]);
  return std::atan2(dot(cross(first, section), tangents[0]), dot(first, section));
}

// EI = GJ, so that a ring buckles from 2 pi sqrt(3) on (Michell 1889). A blow makes it swing below that, and
// grows above. It is in the second mode out of plane; rounding would take longer.
TEST(Twisting, ARingBucklesAtMichellsTwist) {
  for (const double share : {0.97, 1.03}) {
    Scene scene = ring(40, 1, share * 2 * pi * std::sqrt(3.0));
    for (std::uint32_t i = 0; i < 40; ++i)
      scene.particles[i].velocity = {0, 0, 1e-6 * std::cos(4 * pi * i / 40)};
    World world(scene, direct(Gradient::mid));
    const auto largest_after = [&](int steps) {
      double largest = 0;
      for (int i = 0; i < steps; ++i) {
        world.step(2e-3);
        for (std::uint32_t k = 0; k < 40; ++k) largest = std::max(largest, std::abs(world.position(k).z));
      }
      return largest;
    };
    const double early = largest_after(50), late = largest_after(200);
    if (share < 1)
      EXPECT_LE(late, 2 * early);
    else
      EXPECT_GE(late, 100 * early);
  }
}

// A straight rod that is clamped at both ends, without thrust, buckles under the torque M of tan(x) = x with
// x = M L/(2 EI), 4.4934 (Greenhill 1883). Its rods are elastic, because rigid ones between anchors are held.
TEST(Twisting, AClampedRodBucklesUnderGreenhillsTorque) {
  for (const double share : {0.97, 1.03}) {
    Scene scene = wire(40, share * 2 * 4.4934);  // EI = GJ and L = 1
    scene.gravity = {};
    for (std::uint32_t i = 0; i < scene.particles.size(); ++i)
      scene.particles[i].position = {0.025 * (i - 1.0), 0, 0};
    for (Rod& rod : scene.rods) {
      rod.length = 0.025;
      rod.law.stiffness = 1e4;
    }
    for (std::uint32_t i = 2; i < 41; ++i)
      scene.particles[i].velocity = {0, 1e-6 * std::sin(pi * 0.025 * (i - 1.0)), 0};
    World world(scene, direct(Gradient::mid));
    const auto largest_after = [&](int steps) {
      double largest = 0;
      for (int i = 0; i < steps; ++i) {
        world.step(2e-3);
        for (std::uint32_t k = 2; k < 41; ++k)
          largest = std::max(largest, std::hypot(world.position(k).y, world.position(k).z));
      }
      return largest;
    };
    const double early = largest_after(100), late = largest_after(900);
    if (share < 1)
      EXPECT_LE(late, 2 * early);
    else
      EXPECT_GE(late, 100 * early);
  }
}

// A ring that is free has no torque from outside. Its twist is that of its shape: what carrying a cross
// section round turns it by, which gradient mid follows with order two.
TEST(Twisting, GradientMidKeepsWhatAFreeRingHas) {
  Scene scene = ring(20, 1, 3);
  give_velocities(scene, 3, 1);
  const double flat = turn_round(scene, test::positions_of(World(scene, direct(Gradient::mid))));
  const auto off_shape = [&](std::uint32_t substeps) {
    World world(scene, direct(Gradient::mid, substeps));
    const auto momentum = [&] {
      return measure_momentum(scene, test::positions_of(world), test::velocities_of(world));
    };
    const double energy = energy_of(scene, world);
    const Momentum start = momentum();
    double most = 0;
    for (int i = 0; i < 100; ++i) {
      EXPECT_EQ(world.step(1.0 / 600).fallbacks, 0u);
      EXPECT_NEAR(energy_of(scene, world), energy, 1e-10 * energy);
      const double of_shape = 3 + flat - turn_round(scene, test::positions_of(world));
      most = std::max(most, std::abs(world.twist(0) - of_shape));
    }
    EXPECT_LE(norm(momentum().linear - start.linear), 1e-12);
    EXPECT_LE(norm(momentum().angular - start.angular), 1e-12);
    return most;
  };
  const double coarse = off_shape(4), fine = off_shape(8);
  EXPECT_LE(coarse, 1e-3);
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.5);
}

TEST(Twisting, GradientMidKeepsTheEnergyOfAClampedWire) {
  Scene scene = wire(20, 3);
  give_velocities(scene, 3, 1);
  World world(scene, direct(Gradient::mid));
  const double start = energy_of(scene, world);
  double least = world.twist(0), most = least;
  for (int i = 0; i < 3000; ++i) {
    world.step(1.0 / 600);
    least = std::min(least, world.twist(0));
    most = std::max(most, world.twist(0));
    ASSERT_NEAR(energy_of(scene, world), start, 1e-10 * start);
  }
  EXPECT_GE(most - least, 0.1);  // the wire's twist turns into bending and back
}

TEST(Twisting, GradientMidKeepsTheEnergyOfAWireThatHangsFromATackle) {
  Scene scene = wire(12, 2);
  const auto pulley = static_cast<std::uint32_t>(scene.particles.size());
  scene.particles.push_back(fixed({0.5, 0.6, 0}));
  scene.particles.push_back(movable({0.6, 0.2, 0.1}, 0.3));
  scene.tackles = {{.particles = {5, pulley, 9, pulley, pulley + 1}},
                   {.particles = {3, pulley, 7}, .law = {.stiffness = 50}}};
  give_velocities(scene, 5, 0.3);
  World world(scene, direct(Gradient::mid, 2));
  const double start = energy_of(scene, world);
  double least = world.twist(0), most = least;
  StepReport report;
  for (int i = 0; i < 400; ++i) {
    report += world.step(0.001);
    least = std::min(least, world.twist(0));
    most = std::max(most, world.twist(0));
    ASSERT_NEAR(energy_of(scene, world), start, 1e-10 * start);  // as of the wire alone
  }
  EXPECT_EQ(report.fallbacks + report.unsolved, 0u);
  EXPECT_GE(most - least, 0.01);
}

// Against a run with a sixteenth of the finer step, which adds 1/256 of its error.
TEST(Twisting, OrderInTime) {
  const Scene scene = wire(8, 5);
  const auto end = [&](Gradient gradient, std::uint32_t substeps) {
    World world(scene, direct(gradient, substeps));
    EXPECT_EQ(test::run(world, 1.0 / 60, 6).halvings, 0u);
    return test::positions_of(world);
  };
  const std::vector<Vec3> truth = end(Gradient::mid, 2048);
  const auto order = [&](Gradient gradient) {
    return std::log2(rms_distance(end(gradient, 64), truth) / rms_distance(end(gradient, 128), truth));
  };
  EXPECT_NEAR(order(Gradient::mid), 2, 0.15);
  EXPECT_NEAR(order(Gradient::new_), 1, 0.2);
}

// The truth knows nothing of how a World steps. Clamped wires, with and without rest angles.
TEST(Twisting, ConvergesToTheTruthWithOrderTwo) {
  for (const double rest : {0.0, 0.3}) {
    Scene scene = wire(8, 5);
    scene.gravity = {0, -9.81, 0};
    for (Bend& bend : scene.bends) bend.angle = rest;
    const truth::Truth truth = truth::solve(scene, {.save_at = {0.1}, .mass = MassModel::lumped});
    EXPECT_LE(truth.energy_drift, 1e-9);
    const auto error = [&](Gradient gradient, std::uint32_t substeps) {
      World world(scene, direct(gradient, substeps));
      test::run(world, 1.0 / 60, 6);
      return rms_distance(test::positions_of(world), truth.frames[0].positions);
    };
    EXPECT_NEAR(std::log2(error(Gradient::mid, 64) / error(Gradient::mid, 128)), 2, 0.15) << rest;
    EXPECT_NEAR(std::log2(error(Gradient::new_, 64) / error(Gradient::new_, 128)), 1, 0.2) << rest;
    EXPECT_LE(error(Gradient::mid, 512), 1e-5) << rest;
  }
}

TEST(Twisting, TheTruthRefusesWhatIsNotSmooth) {
  const auto refusal = [](auto&& change) {
    Scene scene = wire(4, 1);
    change(scene);
    return test::refusal([&] { truth::solve(scene, {.save_at = {0.01}}); });
  };
  EXPECT_EQ(refusal([](Scene&) {}), "");
  EXPECT_EQ(refusal([](Scene& s) { s.bends[1].damping = 1; }),
            "bend 1 is damped, which a truth does not know");
  EXPECT_EQ(refusal([](Scene& s) { s.rods[2].law.stiffness = 1e3; }),
            "twist 0 is of elastic rods, which a truth does not know");
  EXPECT_EQ(refusal([](Scene& s) {
              s.particles[2].position = {0.25, 0, 0};
              s.particles[1].position = {};
              for (Rod& rod : s.rods) rod.length = 0;
              s.bends[0].angle = 1;
            }),
            "bend 0 has a rest angle and starts straight, where its pull has no direction");
}

// A rod that goes round across its clamp sweeps the area of a hemisphere a turn. Twist counts whole turns.
TEST(Twisting, CountsWholeTurns) {
  Scene scene;
  scene.gravity = {};
  scene.particles = {fixed({0, 0, -1}), fixed({}), movable({1, 0, 0}, 1, {0, 1, 0})};
  scene.rods = {{.a = 1, .b = 2, .length = 1}};
  scene.twists = {{.particles = {0, 1, 2}, .stiffness = 1e-12, .angle = 0.5}};
  World world(scene, direct(Gradient::mid));
  test::run(world, 6 * pi / 600, 600);
  EXPECT_NEAR(world.twist(0), 0.5 + 6 * pi, 1e-3);  // one radian a second, to second order in 0.03 rad
}

// A motor at the end of a wire does the work of its torque GJ theta/L, and a straight wire takes all of it.
TEST(Twisting, AMotorTwistsAWire) {
  const Scene scene = wire(10, 0);
  double length = 0;
  for (const Rod& rod : scene.rods) length += rod.length;
  World world(scene, direct(Gradient::mid));
  const double start = energy_of(scene, world);
  double work = 0;
  for (int i = 1; i <= 200; ++i) {
    const double before = world.twist(0);
    world.set_twist(0, 0.01 * i);
    world.step(1e-3);
    work += 0.01 * (before + world.twist(0)) / 2 / length;
  }
  EXPECT_NEAR(energy_of(scene, world) - start, work, 1e-9 * work);
  const double end = world.twist(0);
  EXPECT_GE(end, 1.0);
  EXPECT_LE(end, 2.0);
}

// What broke is not twisted. A flat ring whose twist pulls out of its plane stays flat once a rod is broken.
TEST(Twisting, EndsWhereARodBreaks) {
  for (const bool breaks : {false, true}) {
    Scene scene = ring(12, 1, 5);
    for (Bend& bend : scene.bends) bend.stiffness = 1e-3;
    if (breaks) scene.rods[3].law.strength = 1;
    World world(scene, direct(Gradient::mid));
    world.set_force(3, {30, 1, 0});
    world.set_force(9, {-30, 0, 0});
    test::run(world, 1e-3, 40);
    double height = 0;
    EXPECT_EQ(world.is_broken(3), breaks);
    for (std::uint32_t i = 0; i < 12; ++i) height = std::max(height, std::abs(world.position(i).z));
    if (breaks)
      EXPECT_LE(height, 1e-3);
    else
      EXPECT_GE(height, 1e-2);
  }
}

TEST(Twisting, HasTheSameBitsEverywhere) {
  const Scene scene = wire(12, 4);
  const auto hash = [&](Isa isa, unsigned threads) {
    World world(scene, {.isa = isa, .threads = threads});
    test::run(world, 1.0 / 60, 20);
    return world.state_hash();
  };
  const std::uint64_t expected = hash(Isa::scalar, 1);
  EXPECT_EQ(hash(best_isa(), 1), expected);
  EXPECT_EQ(hash(best_isa(), 2), expected);
}

TEST(Twisting, IsRefusedWhereNothingKnowsIt) {
  const Scene plain = wire(4, 1);
  const auto refusal = [&](const Settings& settings, auto&& change) {
    Scene scene = plain;
    scene.bends.clear();
    change(scene);
    return test::refusal([&] { World(scene, settings); });
  };
  const auto as_it_is = [](Scene&) {};
  EXPECT_EQ(refusal({.method = Method::relax}, as_it_is),
            "twist 0: method relax moves no twists; direct and auto do");
  EXPECT_EQ(refusal({.gradient = Gradient::old}, as_it_is),
            "twist 0: gradient old moves no twists: a straight chain has no direction at the old position; "
            "mid and new do");
  const auto ball = [](Scene& scene) {
    scene.capsules = {{.a = point_at(2), .b = point_at(2), .radius = 0.1}};
  };
  EXPECT_EQ(refusal({}, ball),
            "twist 0: its island has joints or shapes, which nothing moves together with it yet");
  World world(plain);
  EXPECT_EQ(test::refusal([&] { world.set_twist(1, 0); }), "twist 1: unknown, the world has 1 twist");
  EXPECT_EQ(test::refusal([&] { world.set_twist(0, std::nan("")); }), "twist 0: angle is not finite");
  EXPECT_EQ(test::refusal([&] { world.twist(7); }), "twist 7: unknown, the world has 1 twist");
  EXPECT_EQ(test::refusal([&] { twist_energy(plain, 1, 0); }), "twist 1: unknown, the scene has 1 twists");
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
