// Rods that give: elastic, damped, one-sided and breaking ones, solved directly on trees and in loops.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include "plumb/joints.hpp"
#include "plumb/measures.hpp"
#include "plumb/world.hpp"
#include "scenes/generators/generators.hpp"
#include "scenes/spec.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr double frame = 1.0 / 60;

struct Made {
  std::vector<Vec3> positions, velocities;
  StepReport total;
  double energy_drift = 0;  ///< Largest, relative to the range.
};

Made run(const Scene& scene, const Settings& settings, int frames, double dt = frame) {
  World world(scene, settings);
  Made out{std::vector<Vec3>(scene.particles.size()), std::vector<Vec3>(scene.particles.size()), {}, 0};
  const auto energy = [&] {
    world.copy_positions(out.positions);
    world.copy_velocities(out.velocities);
    return measure_energy(scene, out.positions, out.velocities, mass_model_of(settings)).total();
  };
  const double first = energy();
  for (int i = 0; i < frames; ++i) {
    out.total += world.step(dt);
    out.energy_drift = std::max(out.energy_drift, std::abs(energy() - first) / energy_range(scene));
  }
  return out;
}

Settings direct(Gradient gradient, std::uint32_t substeps = 1, Precision precision = Precision::double_) {
  return {.method = Method::direct, .precision = precision, .gradient = gradient, .substeps = substeps};
}

// A chain, a tree of rods with mass, and a ring, which is solved as a loop.
std::vector<std::string> shapes(const std::string& law) {
  return {"chain:links=5,end_mass=2," + law, "tree:" + law, "ring:links=12," + law};
}

// Halving the substep takes three quarters of the error away, against a run that is 16 times finer.
TEST(ElasticRods, AreOfSecondOrder) {
  for (const std::string& shape : shapes("stiffness=3000"))
    for (const std::string& damping : {std::string(), std::string(",damping=2")})
      for (const Gradient gradient : {Gradient::mid, Gradient::old}) {
        const Scene scene = scenes::load_scene(shape + damping);
        const auto error = [&](std::uint32_t substeps, const Made& truth) {
          return rms_distance(run(scene, direct(gradient, substeps), 30).positions, truth.positions);
        };
        const Made truth = run(scene, direct(Gradient::mid, 1024), 30);
        const double coarse = error(32, truth), fine = error(64, truth);
        EXPECT_NEAR(std::log2(coarse / fine), 2, 0.1) << shape << damping << ' ' << to_string(gradient);
      }
}

// Gradient mid takes the change of elastic energy over the change of length, so that it keeps the sum.
TEST(ElasticRods, KeepEnergyWithGradientMid) {
  for (const double stiffness : {1.0, 1e3, 1e6, 1e9, 1e12})
    for (const std::string& shape : shapes("stiffness=" + std::to_string(stiffness))) {
      const Made made = run(scenes::load_scene(shape), direct(Gradient::mid), 600);
      EXPECT_LT(made.energy_drift, 1e-9) << shape;
      EXPECT_EQ(made.total.unsolved + made.total.elastic_substeps + made.total.fallbacks, 0u) << shape;
    }
}

// A slack cable neither pulls nor pushes, and its energy is kept through slack and taut times alike.
TEST(ElasticRods, CablesKeepEnergyWithGradientMid) {
  for (const std::string& shape : shapes("stiffness=1e5,cables=1")) {
    const Made made = run(scenes::load_scene(shape), direct(Gradient::mid, 8), 300);
    EXPECT_LT(made.energy_drift, 1e-9) << shape;
    EXPECT_EQ(made.total.unsolved, 0u) << shape;
  }
}

TEST(ElasticRods, EveryStiffnessIsStable) {
  for (const double stiffness : {1.0, 1e2, 1e4, 1e6, 1e8, 1e10, 1e12})
    for (const std::string& shape : shapes("stiffness=" + std::to_string(stiffness) + ",damping=1"))
      for (const Gradient gradient : {Gradient::mid, Gradient::old, Gradient::new_}) {
        const Scene scene = scenes::load_scene(shape);
        const Made made = run(scene, direct(gradient), 300);
        EXPECT_EQ(made.total.unsolved + made.total.frozen_islands, 0u) << shape << to_string(gradient);
        EXPECT_LT(norm(made.positions.back()), 125)
            << "it falls no farther than freely, " << shape << to_string(gradient);
      }
}

// Elastic rods of stiffness k are off the rigid ones by what they stretch: truths from 1e7 N/m on put that at
// 1.7e3 N/k for this chain.
TEST(ElasticRods, VeryStiffOnesAreRigid) {
  for (const std::string shape : {"chain:links=5,end_mass=2", "ring:links=12"})
    for (const Gradient gradient : {Gradient::mid, Gradient::old, Gradient::new_}) {
      const Made rigid = run(scenes::load_scene(shape), direct(gradient, 16), 30);
      for (const double stiffness : {1e11, 1e12, 1e13}) {
        const std::string stiff = shape + ",stiffness=" + std::to_string(stiffness);
        const Made elastic = run(scenes::load_scene(stiff), direct(gradient, 16), 30);
        EXPECT_LT(rms_distance(elastic.positions, rigid.positions), 2e3 / stiffness + 1e-11)
            << stiff << to_string(gradient);
      }
    }
}

// A force that is set anew in every step, to a value that trembles by rounding, leaves a chain of rods that
// substeps do not resolve where it hangs. Gradient old starts from a velocity in every one of these steps.
TEST(ElasticRods, HangWhereTheyHangWhileAForceTrembles) {
  for (const double stiffness : {1e3, 1e4, 1e5, 1e7})
    for (const bool has_loop : {false, true}) {
      Scene scene;
      scene.gravity = {};
      scene.drag = 3;
      for (std::uint32_t i = 0; i <= 3; ++i) {
        scene.particles.push_back({.position = {0, -0.5 * i, 0}, .mass = 1, .fixed = i == 0});
        if (i > 0) scene.rods.push_back({.a = i - 1, .b = i, .law = {.stiffness = stiffness, .damping = 50}});
      }
      if (has_loop) scene.rods.push_back({.a = 1, .b = 3, .law = {.stiffness = 1}});
      Settings settings = direct(Gradient::old);
      settings.tensions = true;
      World world(scene, settings);
      for (int i = 0; i < 2400; ++i) {
        world.set_force(3, {0, -48 * (1 + (i % 2) * 1e-12), 0});
        world.step(frame);
      }
      EXPECT_NEAR(world.tension(0), 48, 1e-6) << stiffness << has_loop;
      EXPECT_NEAR(norm(world.velocity(3)), 0, 1e-6) << stiffness << has_loop;
    }
}

// A mass that bounces on an elastic cable keeps its energy in float, since such cables are solved in double.
TEST(ElasticRods, CablesKeepEnergyInFloat) {
  Scene scene;
  scene.particles = {{.position = {0, 0, 0}, .fixed = true}, {.position = {0.1, -0.1, 0}, .mass = 1}};
  scene.rods = {{.a = 0, .b = 1, .length = 0.32, .law = {.stiffness = 1e6, .one_sided = true}}};
  for (const Gradient gradient : {Gradient::mid, Gradient::new_}) {
    World world(scene, direct(gradient, 1, Precision::single));
    const auto energy = [&] {
      std::vector<Vec3> x(2), v(2);
      world.copy_positions(x);
      world.copy_velocities(v);
      return measure_energy(scene, x, v).total();
    };
    const double first = energy();
    double most = 0;
    for (int i = 0; i < 600; ++i) {
      world.step(frame);
      most = std::max(most, energy() - first);
    }
    EXPECT_LE(most, 1e-8) << to_string(gradient);
  }
}

// Two particles on an elastic rod, thrown and spun without gravity: momentum stays, to rounding.
TEST(ElasticRods, KeepMomentum) {
  Scene scene = scenes::load_scene("graph:particles=12,stiffness=2e3,damping=3");
  scene.gravity = {};
  for (std::size_t i = 0; i < scene.particles.size(); ++i) {
    scene.particles[i].fixed = false;
    scene.particles[i].mass = 1 + 0.2 * static_cast<double>(i);
    scene.particles[i].velocity = {std::sin(1.0 + i), std::cos(2.0 * i), 0.3 * std::sin(3.0 * i)};
  }
  for (const Gradient gradient : {Gradient::mid, Gradient::old, Gradient::new_}) {
    const Made start = run(scene, direct(gradient, 4), 0), end = run(scene, direct(gradient, 4), 60);
    const Momentum before = measure_momentum(scene, start.positions, start.velocities);
    const Momentum after = measure_momentum(scene, end.positions, end.velocities);
    EXPECT_LT(norm(after.linear - before.linear), 1e-10) << to_string(gradient);
    if (gradient == Gradient::mid) {
      EXPECT_LT(norm(after.angular - before.angular), 1e-9);
    }
  }
}

// A particle on a spring and a damper, hanging: x'' = g - (k x + r x')/m has a solution in closed form.
TEST(ElasticRods, SwingAsTheDampedOscillator) {
  constexpr double k = 50, m = 2, r = 3, g = 9.81;
  Scene scene;
  scene.particles = {{.position = {0, 0, 0}, .fixed = true}, {.position = {0, -1, 0}, .mass = m}};
  scene.rods = {{.a = 0, .b = 1, .length = 1, .law = {.stiffness = k, .damping = r}}};
  const double rate = r / (2 * m), omega = std::sqrt(k / m - rate * rate), rest = m * g / k, t = 1;
  const double x =
      rest * (1 - std::exp(-rate * t) * (std::cos(omega * t) + rate / omega * std::sin(omega * t)));
  for (const Gradient gradient : {Gradient::mid, Gradient::old}) {
    const auto error = [&](std::uint32_t substeps) {
      return std::abs(run(scene, direct(gradient, substeps), 60).positions[1].y + 1 + x);
    };
    EXPECT_LT(error(16), 2e-6) << to_string(gradient) << ": (omega h)^2/12 of the amplitude";
    EXPECT_NEAR(std::log2(error(8) / error(16)), 2, 0.05) << to_string(gradient);
  }
}

// A rope between two anchors at rest: at every particle the pulls of its rods carry its weight.
TEST(ElasticRods, HangInTheirCatenary) {
  Scene scene = scenes::load_scene("line:links=40,span=8,slack=0.05,mass=0.5,stiffness=2000,damping=20");
  scene.drag = 4;
  for (const Gradient gradient : {Gradient::mid, Gradient::old, Gradient::new_}) {
    const Made made = run(scene, direct(gradient), 1800);
    const auto pull = [&](std::uint32_t rod) {
      const Vec3 d = made.positions[rod + 1] - made.positions[rod];
      const double length = norm(d);
      return 2000 * (length - rod_length(scene, rod)) / length * d;
    };
    for (std::uint32_t i = 1; i < 40; ++i) {
      const Vec3 left = pull(i) - pull(i - 1) + 0.5 * scene.gravity;
      EXPECT_LT(norm(left), 1e-9 * norm(pull(0))) << to_string(gradient) << ' ' << i;
    }
  }
}

// A blow along a straight rope travels at sqrt(EA/rho), that is L sqrt(k/m) on rods of length L.
TEST(ElasticRods, CarryWavesAtTheirSpeed) {
  constexpr std::uint32_t rods = 400;
  constexpr double length = 0.05, k = 5e4, m = 0.02;
  Scene scene;
  scene.gravity = {};
  for (std::uint32_t i = 0; i <= rods; ++i) {
    const double s = (i - 60.0) / 15;  // a smooth bump of velocity, many rods wide
    scene.particles.push_back(
        {.position = {length * i, 0, 0}, .velocity = {std::exp(-s * s), 0, 0}, .mass = m});
    if (i > 0) scene.rods.push_back({.a = i - 1, .b = i, .law = {.stiffness = k}});
  }
  const double speed = length * std::sqrt(k / m), time = 0.1;
  for (const Gradient gradient : {Gradient::mid, Gradient::old}) {
    const Made made = run(scene, direct(gradient), 500, time / 500);
    // Half of the bump goes to the right. Its middle is the mean of where velocities are, by their squares.
    double sum = 0, weighted = 0;
    for (std::uint32_t i = 130; i <= rods; ++i) {
      const double v = made.velocities[i].x;
      sum += v * v;
      weighted += v * v * length * i;
    }
    EXPECT_NEAR((weighted / sum - length * 60) / time / speed, 1, 0.01) << to_string(gradient);
  }
}

// A slack elastic cable catches a falling load. Until the cable is taut the load falls freely, and after that
// it swings about its rest length: energy says how deep it goes.
TEST(ElasticRods, ASlackCableCatchesItsLoad) {
  constexpr double k = 1e4, m = 3, g = 9.81, slack = 0.4;
  Scene scene;
  scene.particles = {{.position = {0, 0, 0}, .fixed = true}, {.position = {0, -0.6, 0}, .mass = m}};
  scene.rods = {{.a = 0, .b = 1, .length = 1, .law = {.stiffness = k, .one_sided = true}}};
  World world(scene, direct(Gradient::mid, 256));
  double lowest = 0;
  for (int i = 0; i < 60; ++i) {
    world.step(frame);
    lowest = std::min(lowest, world.position(1).y);
  }
  // m g (slack + depth) = k depth^2/2
  const double depth = (m * g + std::sqrt(m * g * (m * g + 2 * k * slack))) / k;
  EXPECT_LE(-1 - depth, lowest + 1e-9);
  World fine(scene, direct(Gradient::mid, 1));
  for (int i = 0; i < 4000; ++i) {
    fine.step(1e-4);
    lowest = std::min(lowest, fine.position(1).y);
  }
  EXPECT_NEAR(lowest, -1 - depth, 2e-6) << "within half a substep of the turn, v^2/g of it";
}

// A rigid cable that is slack lets its load fall freely, and holds it then.
TEST(ElasticRods, ARigidCableIsNeverTooLong) {
  for (const Gradient gradient : {Gradient::mid, Gradient::old, Gradient::new_}) {
    Scene scene;
    scene.particles = {{.position = {0, 0, 0}, .fixed = true}, {.position = {0, -0.6, 0}, .mass = 3}};
    scene.rods = {{.a = 0, .b = 1, .length = 1, .law = {.one_sided = true}}};
    World world(scene, direct(gradient, 4));
    for (int i = 0; i < 12; ++i) world.step(frame);  // 0.2 s are too few for 0.4 m
    EXPECT_NEAR(world.position(1).y, -0.6 - 0.5 * 9.81 * 0.04, 1e-12) << to_string(gradient);
    for (int i = 0; i < 200; ++i) {
      EXPECT_EQ(world.step(frame).unsolved, 0u);
      EXPECT_LT(-world.position(1).y, 1 + 1e-9) << to_string(gradient);
    }
  }
}

// A chain whose third rod holds less than what hangs from it breaks there, is counted, and falls freely
// below.
TEST(ElasticRods, BreakWhereTheyPullTooMuch) {
  for (const char* const law : {"", ",stiffness=1e6,damping=100"})
    for (const Gradient gradient : {Gradient::mid, Gradient::old, Gradient::new_}) {
      Scene scene = scenes::load_scene(std::string("chain:links=6,mass=1") + law);
      for (std::size_t i = 0; i < scene.particles.size(); ++i)
        scene.particles[i].position = {0, -0.1 * static_cast<double>(i), 0};
      scene.rods[2].law.strength = 3.5 * 9.81;  // four particles hang from it
      World world(scene, direct(gradient, 4));
      StepReport total;
      for (int i = 0; i < 60; ++i) total += world.step(frame);
      EXPECT_EQ(total.broken_rods, 1u) << law << to_string(gradient);
      EXPECT_TRUE(world.is_broken(2));
      EXPECT_FALSE(world.is_broken(1));
      EXPECT_NEAR(world.velocity(6).y, -9.81, 0.3) << law << to_string(gradient);
      EXPECT_NEAR(world.position(2).y, -0.2, 1e-3);
      EXPECT_TRUE(world.problems().empty());
    }
}

// Pulls of a rope at rest: what hangs below, to rounding. Those of a pendulum: m (g cos a + v^2/l).
TEST(Tensions, AreThoseOfStaticsAndOfThePendulum) {
  for (const Gradient gradient : {Gradient::mid, Gradient::old, Gradient::new_})
    for (const char* const law : {"", ",stiffness=1e7,damping=1e4"}) {
      Scene scene = scenes::load_scene(std::string("chain:links=30,end_mass=40") + law);
      for (std::size_t i = 0; i < scene.particles.size(); ++i)
        scene.particles[i].position = {0, -0.1 * static_cast<double>(i), 0};
      scene.drag = 3;
      Settings settings = direct(gradient);
      settings.tensions = true;
      World world(scene, settings);
      for (int i = 0; i < 900; ++i) world.step(frame);
      for (std::uint32_t i = 0; i < 30; ++i)
        EXPECT_NEAR(world.tension(i) / ((40 + 29 - i) * 9.81), 1, 1e-9) << to_string(gradient) << law << i;
    }
  const auto pendulum_error = [](Gradient gradient, std::uint32_t substeps) {
    Settings settings = direct(gradient, substeps);
    settings.tensions = true;
    World world(scenes::load_scene("chain:links=1,length=1,end_mass=2"), settings);
    for (int i = 0; i < 20; ++i) world.step(frame);
    // The mean over the last frame, by Simpson's rule from states of a run that is 64 times finer.
    World fine(scenes::load_scene("chain:links=1,length=1,end_mass=2"), direct(Gradient::mid, 4096));
    const auto pull = [&] {
      const Vec3 x = fine.position(1), v = fine.velocity(1);
      return 2 * (dot(v, v) - 9.81 * x.y);
    };
    for (int i = 0; i < 19; ++i) fine.step(frame);
    double sum = pull();
    fine.step(frame / 2);
    sum += 4 * pull();
    fine.step(frame / 2);
    return std::abs(world.tension(0) - (sum + pull()) / 6);
  };
  EXPECT_NEAR(std::log2(pendulum_error(Gradient::mid, 8) / pendulum_error(Gradient::mid, 16)), 2, 0.2);
}

// What sleeps keeps its pulls, whatever steps the world takes then.
TEST(Tensions, StayWhereAnIslandSleeps) {
  Scene scene = scenes::load_scene("chain:links=4");
  for (std::size_t i = 0; i < scene.particles.size(); ++i)
    scene.particles[i].position = {0, -0.1 * static_cast<double>(i), 0};
  World world(scene, {.tensions = true});
  EXPECT_TRUE(std::isnan(world.tension(0)));
  StepReport report;
  for (int i = 0; i < 60; ++i) report = world.step(frame);
  ASSERT_EQ(report.awake_islands, 0u);
  world.step(frame / 3);
  EXPECT_NEAR(world.tension(0), 4 * 9.81, 1e-9);
}

TEST(Laws, AreRefusedWhereNothingMovesThem) {
  Scene scene = scenes::load_scene("chain:links=3,stiffness=10");
  EXPECT_THROW(World(scene, {.method = Method::springs}), std::exception);
  World world(scenes::load_scene("chain:links=3"), {});
  EXPECT_THROW(world.tension(0), std::exception);
  EXPECT_THROW(world.set_length(0, -1), std::exception);
  EXPECT_THROW(world.set_length(3, 1), std::exception);
  Scene touching = scenes::load_scene("chain:links=3");
  touching.capsules.push_back({.a = point_at(3), .b = point_at(3), .radius = 0.01});
  touching.planes.push_back({.offset = -0.1});
  World with_shapes(touching, {.tensions = true});
  for (int i = 0; i < 30; ++i) with_shapes.step(frame);
  EXPECT_LT(std::abs(with_shapes.tension(0)), 3 * 9.81) << "it lies on the ground, and contact moves it";
}

// What is wrong is named by its ids.
TEST(Problems, NameRodsThatDoNotFit) {
  Scene scene = scenes::load_scene("line:links=10,span=10,slack=-0.1");
  World world(scene, {});
  for (int i = 0; i < 10; ++i) world.step(frame);
  const std::vector<Problem> problems = world.problems();
  ASSERT_EQ(problems.size(), 11u);
  EXPECT_EQ(problems[0].kind, Problem::Kind::elastic);
  for (std::uint32_t i = 0; i < 10; ++i) {
    EXPECT_EQ(problems[i + 1].kind, Problem::Kind::stretched);
    EXPECT_EQ(problems[i + 1].rod, i);
    EXPECT_NEAR(problems[i + 1].strain, 1 / 0.9 - 1, 1e-4);
  }
  EXPECT_EQ(world.problems(0.2).size(), 1u) << "all rods are within that";
}

// A square whose second diagonal is too long stands still, and does not fit any better for it. It is no event
// of every step.
TEST(Problems, NameIslandsThatSleepAsTheyDoNotFit) {
  Scene scene;
  scene.particles = {{.position = {0, 0, 0}, .fixed = true},
                     {.position = {0, 1, 0}, .fixed = true},
                     {.position = {1, 0, 0}, .mass = 1},
                     {.position = {1, 1, 0}, .mass = 1}};
  scene.rods = {{.a = 0, .b = 2}, {.a = 1, .b = 3}, {.a = 2, .b = 3}, {.a = 0, .b = 3}};
  scene.rods.push_back({.a = 1, .b = 2, .length = 1.0001 * std::sqrt(2)});
  World world(scene, {.events = true});
  for (int i = 0; i < 120; ++i) world.step(frame);
  ASSERT_EQ(world.step(frame).awake_islands, 0u);
  ASSERT_EQ(world.problems().size(), 1u);
  EXPECT_EQ(world.problems()[0].kind, Problem::Kind::elastic);
  EXPECT_TRUE(world.events().empty());
}

// Rods that lack too little to be named by themselves, and one that gives as it is meant to.
TEST(Problems, NameIslandsWhoseRodsLackLittle) {
  for (const double lacks : {1e-6, 1e-4, 5e-3}) {
    Scene scene = scenes::load_scene("line:links=10,span=10,slack=0");
    for (Rod& rod : scene.rods) rod.length = 1 - lacks;
    World world(scene, {});
    world.step(frame);
    ASSERT_EQ(world.problems().size(), 1u) << lacks;
    EXPECT_EQ(world.problems()[0].kind, Problem::Kind::elastic);
    for (Rod& rod : scene.rods) rod.law.stiffness = 1e5;
    World elastic(scene, {});
    elastic.step(frame);
    EXPECT_TRUE(elastic.problems().empty()) << lacks;
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
