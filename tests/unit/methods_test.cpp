// The table of methods: what each reads, refuses and why, and that a new one is one row.

#include "step/methods.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include "plumb/joints.hpp"
#include "plumb/plumb.hpp"
#include "plumb/reference/methods.hpp"
#include "relax/relax_solver.hpp"
#include "scenes/generators/generators.hpp"
#include "scenes/spec.hpp"
#include "step/compile/requirements.hpp"
#include "support/bodies.hpp"
#include "support/refusals.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

enum class Touch : std::uint8_t { nothing, plane, others };

/// Gives every rod a shape, and something to touch: a plane just below, or a ball beside it.
Scene with_touch(Scene scene, Touch touch) {
  if (touch == Touch::nothing) return scene;
  for (std::size_t i = 0; i < scene.rods.size() && scene.bodies.empty() && scene.capsules.size() < 40; ++i)
    if (!scene.particles[scene.rods[i].a].fixed || !scene.particles[scene.rods[i].b].fixed)
      scene.capsules.push_back(
          {.a = point_at(scene.rods[i].a), .b = point_at(scene.rods[i].b), .radius = 0.005});
  Vec3 low = scene.particles.front().position, high = low;
  for (const Particle& particle : scene.particles) {
    low = {std::min(low.x, particle.position.x), std::min(low.y, particle.position.y), 0};
    high = {std::max(high.x, particle.position.x), high.y, 0};
  }
  if (touch == Touch::plane)
    scene.planes.push_back({.offset = low.y - 0.05});
  else
    test::add_ball(scene, {0.5 * (low.x + high.x), low.y - 0.3, 0}, 0.2, 1);
  return scene;
}

struct Shape {
  const char* name;
  Scene scene;
};

std::vector<Shape> shapes() {
  return {{"chain", scenes::make_chain(12)},
          {"net", scenes::make_net(5, 4)},
          {"tree with mass", scenes::make_tree()},
          {"humanoid", scenes::load_scene("humanoid:body=thin")}};
}

/// Runs a cell of the matrix; empty, or the reason of its refusal.
std::string refusal(const Scene& scene, const Settings& settings) {
  return test::refusal([&] {
    World world(scene, settings);
    for (int i = 0; i < 3; ++i) world.step(1.0 / 60);
    EXPECT_TRUE(test::all_finite(world));
  });
}

// Every method, precision, gradient, accuracy and thing to touch, with every shape of scene runs, as the
// documentation states (kernel/LIMITS.md).
TEST(Methods, RunEveryCombination) {
  int cells = 0, refused = 0;
  for (const Shape& shape : shapes())
    for (const Touch touch : {Touch::nothing, Touch::plane, Touch::others}) {
      const Scene scene = with_touch(shape.scene, touch);
      for (const Method method : {Method::relax, Method::direct, Method::automatic})
        for (const Precision precision : {Precision::single, Precision::double_})
          for (const Gradient gradient : {Gradient::old, Gradient::mid, Gradient::new_})
            for (const bool controlled : {false, true}) {
              Settings settings{.method = method, .precision = precision, .gradient = gradient, .threads = 1};
              if (controlled) settings.accuracy = 1e-2;
              const std::string reason = refusal(scene, settings);
              ++cells;
              if (reason.empty()) continue;
              ++refused;
              ADD_FAILURE() << shape.name << ", " << to_string(method) << ", " << to_string(gradient) << ": "
                            << reason;
            }
    }
  RecordProperty("cells", cells);
  RecordProperty("refused", refused);
  EXPECT_EQ(cells, 432);
  EXPECT_EQ(refused, 0);
}

// A setting that differs from its default and that the method does not read is refused by its name.
TEST(Methods, RefuseSettingsThatTheyDoNotRead) {
  const auto set = [](detail::Reads id) {
    Settings s;
    switch (id) {
      case detail::Reads::precision:
        s.precision = Precision::single;
        break;
      case detail::Reads::gradient:
        s.gradient = Gradient::old;
        break;
      case detail::Reads::mass:
        s.mass = MassModel::lumped;
        break;
      case detail::Reads::weights:
        s.weights = Weights::equal;
        break;
      case detail::Reads::order:
        s.order = SweepOrder::jacobi;
        break;
      case detail::Reads::omega:
        s.omega = 1.5;
        break;
      case detail::Reads::time_order:
        s.time_order = 4, s.gradient = Gradient::old;
        break;
      case detail::Reads::accuracy:
        s.accuracy = 1e-3;
        break;
      case detail::Reads::sweeps:
        s.stop.sweeps = 3;
        break;
      case detail::Reads::tolerance:
        s.stop.tolerance = 1e-3;
        break;
      case detail::Reads::budget_us:
        s.stop.budget_us = 10.0;
        break;
      case detail::Reads::integrator:
        s.integrator = Integrator::rk2;
        break;
      case detail::Reads::springs:
        s.springs.model = SpringModel::particles;
        break;
      case detail::Reads::stiffness:
        s.springs.stiffness = 7;
        break;
      case detail::Reads::damping_ratio:
        s.springs.damping_ratio = 0.7;
        break;
      case detail::Reads::stabilization:
        s.multipliers.stabilization = Stabilization::none;
        break;
      case detail::Reads::baumgarte_rate:
        s.multipliers.baumgarte_rate = 7;
        break;
      case detail::Reads::sleep:
        s.sleep = false;
        break;
      case detail::Reads::layout:
        s.layout = LayoutChoice::soa;
        break;
      case detail::Reads::tensions:
        s.tensions = true;
        break;
      case detail::Reads::contacts:
        s.contacts = true;
        break;
      case detail::Reads::most_work:
        s.most_work = 7;
        break;
      case detail::Reads::sleep_time:
        s.sleep_time = 7;
        break;
      case detail::Reads::contact:
        s.contact.margin = 1e-3;
        break;
    }
    return s;
  };
  const Scene scene = scenes::make_chain(3);
  for (const detail::MethodRow& method : detail::method_rows())
    for (const detail::SettingRow& setting : detail::setting_rows()) {
      if (contains(method.reads, setting.id)) continue;
      Settings settings = set(setting.id);
      if (setting.id == detail::Reads::time_order && !contains(method.reads, detail::Reads::gradient))
        settings.gradient.reset();
      settings.method = method.method;
      const std::string reason = refusal(scene, settings);
      EXPECT_NE(reason.find(setting.name), std::string::npos) << method.name << ": " << reason;
    }
}

// The public list is the table itself, so that programs and the command name the same methods.
TEST(Methods, AreListedAsTheTableHasThem) {
  const std::vector<MethodInfo> listed = all_methods();
  ASSERT_EQ(listed.size(), detail::method_rows().size());
  for (std::size_t i = 0; i < listed.size(); ++i) {
    const detail::MethodRow& row = detail::method_rows()[i];
    EXPECT_EQ(listed[i].method, row.method);
    EXPECT_EQ(listed[i].name, row.name);
    EXPECT_EQ(listed[i].name, to_string(row.method));
    EXPECT_FALSE(listed[i].moves.empty());
    for (const detail::SettingRow& setting : detail::setting_rows())
      EXPECT_EQ(std::count(listed[i].reads.begin(), listed[i].reads.end(), setting.name),
                contains(row.reads, setting.id))
          << row.name << ", " << setting.name;
  }
}

TEST(Methods, AutomaticRefusesWhatNoIslandReads) {
  Settings settings;
  settings.stop.sweeps = 3;
  EXPECT_NE(refusal(scenes::make_chain(3), settings).find("sweeps"), std::string::npos);
  EXPECT_NE(refusal(scenes::make_net(20, 20), settings).find("sweeps"), std::string::npos);
  EXPECT_EQ(refusal(scenes::make_net(400, 400), settings), "") << "vast, and relaxed";
}

/// The name of the setting that a world says nothing reads.
std::string unread(const Scene& scene, const Settings& settings) {
  try {
    const World world(scene, settings);
  } catch (const UnreadSetting& error) {
    EXPECT_NE(std::string(error.what()).find(error.setting()), std::string::npos) << error.what();
    return std::string(error.setting());
  }
  return "";
}

// A budget or a tolerance is named, not the cap on sweeps that comes along. What is solved by its lines, or
// relaxed, reads a tolerance.
TEST(Methods, NameTheSettingThatNothingReads) {
  const Scene chain = scenes::make_chain(3);
  const StopRule budget{.sweeps = 10000, .budget_us = 5.0}, tolerance{.sweeps = 10000, .tolerance = 1e-3};
  EXPECT_EQ(unread(chain, {.stop = budget}), "budget");
  EXPECT_EQ(unread(chain, {.method = Method::direct, .stop = {.budget_us = 5.0}}), "budget");
  EXPECT_EQ(unread(chain, {.stop = tolerance}), "tolerance");
  EXPECT_EQ(unread(chain, {.method = Method::direct, .stop = {.tolerance = 1e-3}}), "tolerance");
  EXPECT_EQ(unread(chain, {.method = Method::relax, .stop = tolerance}), "");
  EXPECT_EQ(unread(scenes::load_scene("humanoid:body=thin"), {.stop = tolerance}), "tolerance");
  EXPECT_EQ(unread(scenes::make_net(20, 20), {.stop = tolerance}), "") << "solved by its lines";
  EXPECT_EQ(unread(scenes::make_net(400, 400), {.stop = budget}), "") << "relaxed";
  EXPECT_EQ(unread(chain, {.time_order = 4}), "time order");
}

TEST(Methods, AreNamedAsASentenceDoes) {
  using detail::methods_that;
  EXPECT_EQ(methods_that([](const detail::MethodRow&) { return false; }), "");
  EXPECT_EQ(methods_that([](const detail::MethodRow& row) { return row.method == Method::relax; }), "relax");
  EXPECT_EQ(methods_that([](const detail::MethodRow& row) { return row.moves_laws; }),
            "relax, direct and auto");
}

// A refusal names what the island has and no more, and all methods that move it.
TEST(Methods, NameWhatAnIslandHasAndWhatMovesIt) {
  register_reference_methods();
  Scene bodies;
  MassProperties box = solid_box(1, {0.1, 0.2, 0.3});
  const std::uint32_t one = add_body(bodies, box);
  box.center = {0.3, 0, 0};
  const std::uint32_t other = add_body(bodies, box);
  add_revolute(bodies, one, other, {0.15, 0, 0}, {0, 0, 1});
  const Settings springs{.method = Method::springs, .threads = 1};
  EXPECT_EQ(refusal(bodies, springs),
            "particle 0: its island has bodies and joints, which method springs cannot move; relax, direct, "
            "multipliers, featherstone and auto can");
  bodies.joint_drag = 1;
  EXPECT_EQ(refusal(bodies, springs),
            "particle 0: its island has bodies, joints and drag of joints, which method springs cannot move; "
            "relax, direct and auto can");
  Scene air = scenes::make_tree();
  air.rods[0].orthogonal_drag = 1;
  EXPECT_NE(refusal(air, springs)
                .find("its island has air on rods, which method springs cannot move; "
                      "direct and auto can"),
            std::string::npos);
  EXPECT_NE(refusal(air, {.method = Method::relax})
                .find("its island has air on rods, which method relax cannot move; direct and auto can"),
            std::string::npos);
  Scene cables = scenes::make_chain(3);
  cables.rods[1].law.one_sided = true;
  EXPECT_EQ(refusal(cables, springs),
            "rod 1: gives, which method springs cannot move; relax, direct and auto can");
}

// Worlds refuse what would change nothing, too.
TEST(Methods, WorldsRefuseRulesThatNothingReads) {
  World world(scenes::make_chain(3), {.method = Method::direct});
  EXPECT_THROW(world.set_weights(Weights::equal), InputError);
  EXPECT_THROW(world.set_stop_rule({.sweeps = 3}), InputError);
}

// A new method is one row: here one under another number that relaxes.
TEST(Methods, ARowIsAllThatANewMethodNeeds) {
  const auto mine = static_cast<Method>(77);
  detail::register_method({.method = mine,
                           .name = "mine",
                           .moves = "particles and rods",
                           .reads = detail::Reads::sweeps | detail::Reads::accuracy,
                           .make = detail::make_relax_solvers});
  const Scene scene = scenes::make_chain(5);
  Settings settings{.method = mine, .threads = 1}, relax{.method = Method::relax, .threads = 1};
  World world(scene, settings), twin(scene, relax);
  test::run(world, 1.0 / 60, 10);
  test::run(twin, 1.0 / 60, 10);
  EXPECT_EQ(world.state_hash(), twin.state_hash());
  EXPECT_EQ(to_string(mine), "mine");
  settings.omega = 1.5;
  EXPECT_NE(refusal(scene, settings).find("mine"), std::string::npos);
}

// The thesis's other methods are there once, however often they are registered.
TEST(Methods, OfTheReferenceLibraryAreRegisteredOnce) {
  register_reference_methods();
  const std::size_t rows = detail::method_rows().size();
  register_reference_methods();
  EXPECT_EQ(detail::method_rows().size(), rows);
  for (const Method method : {Method::springs, Method::multipliers, Method::featherstone}) {
    World world(scenes::make_chain(3), {.method = method, .threads = 1});
    world.step(1e-3);
    EXPECT_TRUE(test::all_finite(world)) << to_string(method);
  }
}

/// Two bodies on a ball joint and a hinge, the first tied to an anchor by a spring.
Scene jointed() {
  Scene scene;
  MassProperties box = solid_box(1, {0.1, 0.2, 0.3});
  const std::uint32_t ground = test::add_fixed_body(scene), one = add_body(scene, box);
  box.center = {0.3, 0, 0};
  const std::uint32_t other = add_body(scene, box);
  add_spherical(scene, point_on_body(scene, ground, {-0.1, 0, 0}), point_on_body(scene, one, {-0.1, 0, 0}));
  add_revolute(scene, one, other, {0.15, 0, 0}, {0, 0, 1});
  scene.springs.push_back(
      {.a = point_at(1), .b = point_on_body(scene, other, {0.4, 0, 0}), .length = 0.5, .stiffness = 10});
  return scene;
}

// The thesis's other methods on every kind of scene (kernel/LIMITS.md).
TEST(Methods, OfTheReferenceLibraryMoveOrRefuseForAReason) {
  register_reference_methods();
  Scene looped = jointed();
  add_spherical(looped, point_on_body(looped, 0, {0.4, 0, 0}), point_on_body(looped, 2, {0.4, 0, 0}));
  const Scene touching = with_touch(scenes::make_chain(12), Touch::plane);
  struct Row {
    Shape shape;
    const char* reasons[3];  // of springs, multipliers and featherstone
  };
  const Row rows[] = {
      {{"chain", scenes::make_chain(12)}, {"", "", ""}},
      {{"tree with mass", scenes::make_tree()}, {"", "", ""}},
      {{"ring", scenes::make_ring({})}, {"", "", "one way to the ground"}},
      {{"bodies", jointed()}, {"method springs moves no springs", "", ""}},
      {{"bodies in a loop", looped}, {"method springs moves no springs", "", "more than one place"}},
      {{"chain with shapes", touching}, {"nothing touch", "nothing touch", "nothing touch"}},
      {{"bodies with shapes", scenes::load_scene("humanoid:body=thin")}, {"joints", "shapes", "shapes"}},
  };
  for (const Row& row : rows)
    for (const Method method : {Method::springs, Method::multipliers, Method::featherstone}) {
      const char* const expected = row.reasons[static_cast<int>(method) - static_cast<int>(Method::springs)];
      const std::string reason = refusal(row.shape.scene, {.method = method, .substeps = 16, .threads = 1});
      EXPECT_EQ(reason.empty(), *expected == 0)
          << row.shape.name << ", " << to_string(method) << ": " << reason;
      EXPECT_NE(reason.find(expected), std::string::npos) << row.shape.name << ": " << reason;
    }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
