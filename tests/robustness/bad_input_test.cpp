// Bad input is refused with the particle, rod or setting and the reason, and a world that refuses stays as it
// was.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "plumb/plumb.hpp"
#include "scenes/generators/generators.hpp"
#include "support/refusals.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::refusal;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

// Every refusal of validate(), once, through the constructor: whoever builds a world need not validate
// before.
TEST(BadScenes, AreRefusedByTheWorld) {
  struct Case {
    const char* message;
    std::function<void(Scene&)> spoil;
  };
  const Case cases[] = {
      {"gravity is not finite: (0, nan, 0)", [](Scene& s) { s.gravity.y = nan; }},
      {"drag is negative (-1 per second)", [](Scene& s) { s.drag = -1; }},
      {"drag is not finite: nan", [](Scene& s) { s.drag = nan; }},
      {"particle 1: position is not finite: (nan, 0, 0)", [](Scene& s) { s.particles[1].position.x = nan; }},
      {"particle 2: velocity is not finite: (0, 0, inf)",
       [](Scene& s) { s.particles[2].velocity.z = infinity; }},
      {"particle 3: mass is not finite: nan", [](Scene& s) { s.particles[3].mass = nan; }},
      {"particle 3: mass is negative (-2 kg)", [](Scene& s) { s.particles[3].mass = -2; }},
      {"particle 3: has no mass, neither its own nor from a rod, and is not fixed",
       [](Scene& s) { s.particles[3].mass = 0; }},
      {"rod 1: particle 9 does not exist (the scene has 4 particles)", [](Scene& s) { s.rods[1].b = 9; }},
      {"rod 1: both ends are particle 1", [](Scene& s) { s.rods[1].b = 1; }},
      {"rod 2: length is negative (-1 m)", [](Scene& s) { s.rods[2].length = -1; }},
      {"rod 2: length is not finite: nan", [](Scene& s) { s.rods[2].length = nan; }},
      {"rod 2: length is zero, no length is given and its ends (particles 2 and 3) are at the same place",
       [](Scene& s) {
         s.rods[2].length = 0;
         s.particles[3].position = s.particles[2].position;
       }},
      {"rod 3: joins the same particles (3 and 2) as rod 2",
       [](Scene& s) { s.rods.push_back({.a = 3, .b = 2}); }},
      {"rod 3: both ends (particles 0 and 3) are fixed",
       [](Scene& s) {
         s.particles[3].fixed = true;
         s.rods.push_back({.a = 0, .b = 3});
       }},
      {"rod 0: mass is negative (-1 kg)", [](Scene& s) { s.rods[0].mass = -1; }},
  };
  for (const Case& c : cases) {
    Scene scene = scenes::make_chain(3);
    c.spoil(scene);
    EXPECT_EQ(refusal([&] { World world(scene, {.method = Method::relax}); }), c.message);
  }
}

TEST(BadSettings, AreRefusedByTheWorld) {
  const Scene scene = scenes::make_chain(3);
  const auto refused = [&](const Settings& settings) {
    return refusal([&] { World world(scene, settings); });
  };
  EXPECT_EQ(refused({.omega = 2}), "omega must be in (0, 2), got 2");
  EXPECT_EQ(refused({.substeps = 0}), "substeps must be from 1 to 1000000, got 0");
  EXPECT_EQ(refused({.stop = {.sweeps = 0}}), "sweeps must be at least 1, got 0");
  EXPECT_EQ(refused({.stop = {.tolerance = 0}}), "tolerance must be positive and finite, got 0");
  EXPECT_EQ(refused({.stop = {.budget_us = -1}}), "budget must be positive and finite, got -1 us");
  // No machine runs an instruction set that does not exist.
  std::string supported;
  for (const Isa isa : all_isas())
    if (is_supported(isa)) supported += (supported.empty() ? "" : ", ") + std::string(to_string(isa));
  EXPECT_EQ(refused({.isa = static_cast<Isa>(99)}),
            "this machine or build does not run instruction set unknown; it runs " + supported);
  for (const Isa isa : all_isas())
    EXPECT_EQ(refused({.isa = isa}).empty(), is_supported(isa)) << to_string(isa);
}

// Method featherstone moves trees that hang from one point. What it cannot move is named by the scene's own
// numbers, here behind a chain that it can.
TEST(BadScenes, ThatFeatherstoneCannotMoveAreRefused) {
  const auto refused = [](const Scene& scene) {
    return refusal([&] { World world(scene, {.method = Method::featherstone}); });
  };
  Scene scene = scenes::make_chain(3);
  const auto add = [&](Vec3 position, bool fixed) {
    scene.particles.push_back(fixed ? test::fixed(position) : test::movable(position));
  };
  for (int i = 0; i < 4; ++i) add({1.0 * i, 0, 1}, false);  // 4 to 7
  for (std::uint32_t i = 4; i < 7; ++i) scene.rods.push_back({.a = i + 1, .b = i});
  EXPECT_EQ(refused(scene), "");

  Scene loop = scene;
  loop.rods.push_back({.a = 6, .b = 4});
  EXPECT_EQ(refused(loop),
            "rod 6: closes a loop (particles 6 and 4 are joined by other rods already), which method "
            "featherstone cannot move; use method direct");

  add({0, 1, 1}, true);  // 8
  add({1, 1, 1}, true);  // 9
  scene.rods.push_back({.a = 8, .b = 5});
  EXPECT_EQ(refused(scene), "") << "one way to the ground";
  Scene twice = scene;
  twice.rods.push_back({.a = 7, .b = 9});
  EXPECT_EQ(refused(twice),
            "rod 7: ties to fixed particle 9 what rod 6 ties to fixed particle 8 already, and method "
            "featherstone needs one way to the ground; use method direct");
  twice.rods.back().b = 8;
  EXPECT_EQ(refused(twice),
            "rod 7: ties to fixed particle 8 what rod 6 ties to fixed particle 8 already, and method "
            "featherstone needs one way to the ground; use method direct");
  for (const Scene& other : {loop, twice})
    EXPECT_NO_THROW(World(other, {.method = Method::multipliers})) << "multipliers move anything";
}

// What float cannot hold is no position for a world of floats.
TEST(BadScenes, BeyondTheRangeOfFloatAreRefused) {
  Scene scene;
  scene.particles = {test::movable({0, 0, 0}), test::movable({1e39, 0, 0})};
  EXPECT_NO_THROW(World(scene, {.method = Method::relax, .precision = Precision::double_, .threads = 1}));
  EXPECT_NE(refusal([&] {
              World world(scene, {.method = Method::relax, .precision = Precision::single, .threads = 1});
            }).find("particle 1"),
            std::string::npos);
}

// The shortest rods that are accepted keep their length as well as others do; shorter ones would lose it to
// underflow.
TEST(BadScenes, RodsTooShortForThePrecisionAreRefused) {
  const auto scaled_chain = [](double length) {
    Scene scene = scenes::make_chain(3, length);
    scene.gravity = length * scene.gravity;  // so that it swings as a chain of 1 m links does
    return scene;
  };
  struct Case {
    Precision precision;
    double shortest, tolerance;
  };
  for (const Case c : {Case{Precision::single, 3.2e-16, 1e-6}, Case{Precision::double_, 1.01e-146, 1e-14}}) {
    const Settings settings{
        .method = Method::relax, .precision = c.precision, .stop = {.sweeps = 200}, .threads = 1};
    const Scene scene = scaled_chain(c.shortest);
    World world(scene, settings);
    EXPECT_EQ(test::run(world, 1.0 / 60, 60).frozen_islands, 0u);
    EXPECT_LE(test::stretch_of(scene, world).max, c.tolerance) << to_string(c.precision);
    Scene mixed = scenes::make_chain(3);
    mixed.rods[1].length = 0.9 * c.shortest;
    const std::string message = refusal([&] { World refused(mixed, settings); });
    EXPECT_EQ(message.find("rod 1: length "), 0u) << message;
    EXPECT_NE(message.find(" is too short for " + std::string(to_string(c.precision))), std::string::npos)
        << message;
  }
}

/// A world in motion, and its twin that is asked nothing wrong.
class BadRequests : public testing::Test {
 protected:
  BadRequests() {
    test::run(world, 1.0 / 60, 10);
    test::run(twin, 1.0 / 60, 10);
  }
  template <class F>
  void expect_refused(const std::string& message, F&& f) {
    const std::uint64_t before = world.state_hash();
    const double time = world.time();
    EXPECT_EQ(refusal(f), message);
    EXPECT_EQ(world.state_hash(), before);
    EXPECT_EQ(world.time(), time);
    const StepReport report = world.step(1.0 / 60), wanted = twin.step(1.0 / 60);
    EXPECT_EQ(world.state_hash(), twin.state_hash()) << "something was left behind";
    EXPECT_EQ(report.block_sweeps, wanted.block_sweeps);
  }

  Scene scene = scenes::make_chain(5, 0.1, 3);
  Settings settings{.method = Method::relax, .stop = {.sweeps = 12}, .threads = 1};
  World world{scene, settings}, twin{scene, settings};
};

TEST_F(BadRequests, SteppingByNothing) {
  expect_refused("dt must be positive and finite, got 0", [&] { world.step(0); });
  expect_refused("dt must be positive and finite, got -1", [&] { world.step(-1); });
  expect_refused("dt must be positive and finite, got nan", [&] { world.step(nan); });
  expect_refused("dt must be positive and finite, got inf", [&] { world.step(infinity); });
}

TEST_F(BadRequests, StopRules) {
  expect_refused("sweeps must be at least 1, got 0", [&] { world.set_stop_rule({.sweeps = 0}); });
  expect_refused("tolerance must be positive and finite, got nan",
                 [&] { world.set_stop_rule({.sweeps = 3, .tolerance = nan}); });
  expect_refused("budget must be positive and finite, got inf us",
                 [&] { world.set_stop_rule({.sweeps = 3, .budget_us = infinity}); });
}

TEST_F(BadRequests, Forces) {
  expect_refused("particle 6: unknown, the world has 6 particles", [&] { world.set_force(6, {1, 0, 0}); });
  expect_refused("particle 0: is fixed, a force cannot move it", [&] { world.set_force(0, {1, 0, 0}); });
  expect_refused("particle 2: force is not finite", [&] { world.set_force(2, {0, nan, 0}); });
}

TEST_F(BadRequests, Reading) {
  const char* const unknown = "particle 6: unknown, the world has 6 particles";
  expect_refused(unknown, [&] { (void)world.position(6); });
  expect_refused(unknown, [&] { (void)world.velocity(6); });
  expect_refused(unknown, [&] { (void)world.positions()[6]; });
  expect_refused(unknown, [&] { (void)world.velocities()[6]; });
  std::vector<Vec3> few(5, Vec3{1, 2, 3}), many(7, Vec3{1, 2, 3});
  expect_refused("positions of 6 particles cannot be copied into 5 elements",
                 [&] { world.copy_positions(few); });
  expect_refused("velocities of 6 particles cannot be copied into 7 elements",
                 [&] { world.copy_velocities(many); });
  for (const auto& untouched : {few, many})
    for (const Vec3 v : untouched) EXPECT_EQ(v, (Vec3{1, 2, 3}));
}

TEST_F(BadRequests, Anchors) {
  expect_refused("particle 4000000000: unknown, the world has 6 particles",
                 [&] { world.move_anchor(4'000'000'000u, {}); });
  expect_refused("particle 5: is movable, only fixed particles are moved as anchors",
                 [&] { world.move_anchor(5, {}); });
  expect_refused("particle 0: target is not finite", [&] { world.move_anchor(0, {0, 0, infinity}); });
}

// Found by an adversary: numbers that a precision cannot hold are refused, and nothing is lost.
TEST(Steps, RefuseWhatThePrecisionCannotHold) {
  for (const Precision precision : {Precision::single, Precision::double_})
    for (const Method method : {Method::relax, Method::direct}) {
      World world(scenes::make_chain(3), {.method = method, .precision = precision, .threads = 1});
      world.step(1.0 / 60);
      const std::uint64_t hash = world.state_hash();
      const bool is_float = precision == Precision::single;
      EXPECT_THROW(world.step(is_float ? 1e-50 : 1e-306), InputError);
      EXPECT_THROW(world.move_anchor(0, {is_float ? 1e100 : 1e200, 0, 0}), InputError);
      EXPECT_EQ(world.state_hash(), hash);
      EXPECT_EQ(world.time(), 1.0 / 60);
      world.step(1.0 / 60);
      EXPECT_TRUE(test::all_finite(world));
    }
}

/// Fails before any task runs, or after all have.
class FailingExecutor final : public Executor {
 public:
  explicit FailingExecutor(bool runs) : runs_(runs) {}
  unsigned concurrency() const override { return 2; }
  void run(unsigned n, Task task, void* context) override {
    for (unsigned i = 0; runs_ && i < n; ++i) task(context, i);
    throw std::runtime_error("no threads");
  }

 private:
  bool runs_;
};

// What an executor throws is passed on, and the step is done: state and time agree.
TEST(Steps, AreDoneThoughTheExecutorFails) {
  const Scene scene = scenes::make_ensemble({.chains = 40, .links = 6});
  for (const bool runs : {false, true}) {
    FailingExecutor executor(runs);
    World world(scene, {.method = Method::direct, .executor = &executor});
    World twin(scene, {.method = Method::direct, .threads = 1});
    for (int i = 1; i <= 3; ++i) {
      EXPECT_THROW(world.step(1.0 / 60), std::runtime_error);
      twin.step(1.0 / 60);
      EXPECT_EQ(world.state_hash(), twin.state_hash()) << i;
      EXPECT_EQ(world.time(), twin.time());
    }
  }
}

/// Says that it can run nothing.
class IdleExecutor final : public Executor {
 public:
  unsigned concurrency() const override { return 0; }
  void run(unsigned, Task, void*) override {}
};

TEST(Steps, RefuseAnExecutorWithoutConcurrency) {
  IdleExecutor executor;
  EXPECT_THROW(World(scenes::make_chain(3), {.executor = &executor}), InputError);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
