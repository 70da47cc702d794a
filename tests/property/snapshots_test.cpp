// Rollback as netcode does it. A world guesses what a player does and saves every frame. After every eighth
// it goes back to before the first of them, and plays them again with what the player really did. It must
// come to the bits of a world that knew all along, on another machine.

#include "support/snapshots.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "plumb/joints.hpp"
#include "scenes/spec.hpp"
#include "support/beams.hpp"
#include "support/breaking.hpp"
#include "support/executors.hpp"
#include "support/laws.hpp"
#include "support/reeled_chain.hpp"
#include "support/sanitizers.hpp"
#include "support/swinging_machine.hpp"
#include "threads/sharing.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

struct Case {
  std::string name;
  std::function<Scene()> scene;
  Settings settings;
  /// Lets the player change the length of this rod, or rules, or islands.
  std::optional<std::uint32_t> winch{};
  bool changes_rules = false, edits = false, adds = false;

  friend void PrintTo(const Case& of, std::ostream* out) { *out << of.name; }
};

std::function<Scene()> spec(const char* text) {
  return [text] { return scenes::load_scene(text); };
}

/// Two blocks on a ball joint, a spring, a motor and a limited angle, above ground that a platform carries.
Scene machine() {
  Scene scene;
  for (const double x : {0.0, 0.5}) {
    MassProperties block = solid_box(2, {0.3, 0.2, 0.25});
    block.center = {x, 0.4, 0.02 * x};
    add_body(scene, block);
  }
  const auto at = [&](std::uint32_t body, Vec3 place) { return point_on_body(scene, body, place); };
  add_spherical(scene, at(0, {0.25, 0.4, 0}), at(1, {0.25, 0.4, 0}));
  scene.springs.push_back(
      {.a = at(0, {0, 0.5, 0}), .b = at(1, {0.5, 0.5, 0}), .length = 0.5, .stiffness = 200, .damping = 1});
  const Direction u{at(0, {0, 0.4, 0}), at(0, {0.1, 0.4, 0})}, v{at(1, {0.5, 0.4, 0}), at(1, {0.6, 0.4, 0})};
  scene.torsions.push_back(
      {.axis = {at(0, {0, 0.4, 0}), at(0, {0, 0.4, 0.1})}, .u = u, .v = v, .stiffness = 5, .damping = 0.1});
  scene.angles.push_back({.u = u, .v = v, .upper = 1, .friction = 0.1});
  for (const std::uint32_t body : {0u, 1u})
    for (const double x : {-0.15, 0.15}) {
      const Point end = at(body, {0.5 * body + x, 0.3, 0});
      scene.capsules.push_back({.a = end, .b = end, .radius = 0.02});
    }
  scene.platforms.push_back({});
  scene.planes.push_back({.offset = 0.1, .motion = {.platform = 0}});
  return scene;
}

/// Ropes that break where they fall over a box, and a net whose corner gives way.
Scene tearing() {
  Scene scene = scenes::load_scene("heap:ropes=4,links=8");
  for (Rod& rod : scene.rods) rod.law.strength = 40;
  return scene;
}
Scene tearing_net() {
  Scene scene = scenes::load_scene("net:width=6,height=5");
  for (Rod& rod : scene.rods) rod.law = {.stiffness = 2e4, .damping = 20, .strength = 45};
  return scene;
}

/// A truss between anchors that is too weak for its load. It stays one island.
Scene tearing_truss() {
  Scene scene = scenes::load_scene("truss:bays=4,braces=2,fixed=2");
  for (Rod& rod : scene.rods) rod.law.strength = 60;
  return scene;
}

std::vector<Case> cases() {
  const Settings relax{.method = Method::relax}, direct{.method = Method::direct, .tensions = true};
  const auto with = [](Settings settings, auto&& change) {
    change(settings);
    return settings;
  };
  std::vector<Case> out{
      {"relaxed_ropes_float",
       spec("ensemble:chains=20,links=6,vary=0.5"),
       with(relax, [](Settings& s) { s.precision = Precision::single, s.substeps = 2; }),
       {},
       true},
      {"relaxed_graph_jacobi",
       spec("graph:particles=60"),
       with(relax, [](Settings& s) { s.order = SweepOrder::jacobi, s.tensions = true; }),
       {},
       true},
      {"relaxed_net_mid", spec("net:width=20,height=12"),
       with(relax, [](Settings& s) { s.gradient = Gradient::mid, s.precision = Precision::single; })},
      {"relaxed_chain_accurate", spec("chain:links=30"),
       with(relax, [](Settings& s) { s.accuracy = 1e-3, s.gradient = Gradient::old; })},
      {"relaxed_cables",
       [] {
         return test::with_law(scenes::load_scene("net:width=8,height=8"),
                               {.stiffness = 1e4, .damping = 5, .one_sided = true});
       },
       with(relax, [](Settings& s) { s.gradient = Gradient::old, s.tensions = true; })},
      {"ropes", spec("ensemble:chains=20,links=6,end_mass=100,vary=0.5"), {.tensions = true}},
      {"ropes_accurate", spec("ensemble:chains=9,links=6,end_mass=1000"), {.accuracy = 1e-3}},
      {"tree", spec("tree"), direct},
      {"long_line", spec("chain:links=300,end_mass=50"),
       with(direct, [](Settings& s) { s.gradient = Gradient::old, s.mass = MassModel::lumped; })},
      {"winch", spec("winch:rods=6"), direct, 0},
      {"truss", spec("truss:bays=5"), direct, 3},
      // Under sanitizers the large one alone takes a third of the time of all tests.
      {"net_old", spec(test::sanitized ? "net:width=10,height=10" : "net:width=16,height=16"),
       with(direct, [](Settings& s) { s.gradient = Gradient::old, s.mass = MassModel::lumped; })},
      {"net_mid", spec("net:width=12,height=12,level=1"), direct},
      {"net_of_heavy_rods",
       [] {
         Scene scene = scenes::load_scene("net:width=10,height=10");
         for (Rod& rod : scene.rods) rod.mass = 0.1;
         return scene;
       },
       with(direct, [](Settings& s) { s.gradient = Gradient::new_, s.substeps = 2; })},
      {"elastic_net",
       [] {
         return test::with_law(scenes::load_scene("net:width=16,height=16"),
                               {.stiffness = 1e5, .damping = 5});
       },
       direct},
      {"reel",
       [] {
         return test::make_reeled({.direction = {0.6, -0.8, 0}});
       },
       direct},
      {"tackle",
       [] {
         return test::atwood({1, 1.5}, 0.2, 0.3);
       },
       direct},
      {"wire", spec("wire"), direct},
      {"beam", [] { return test::cantilever(6); }, direct},
      {"machine", machine, {.tensions = true, .contacts = true}},
      {"machine_mid", machine, {.gradient = Gradient::mid, .tensions = true, .contacts = true}},
      {"figures", spec("crowd:humanoids=3,hit=1"), {.contacts = true}},
      {"rope_over_ground", spec("rope:links=12"), {.tensions = true, .contacts = true}},
      {"heap", spec("heap:ropes=5,links=8"), {.substeps = 4, .contacts = true}},
      {"heap_relaxed",
       spec("heap:ropes=5,links=8"),
       with(relax, [](Settings& s) { s.substeps = 4, s.precision = Precision::single, s.contacts = true; }),
       {},
       true},
      {"boxes", spec("boxes:boxes=4"), {.contacts = true}},
      {"drape", spec("drape:size=6"), {.tensions = true}},
      {"tearing_heap", tearing, {.contacts = true}},
      {"tearing_truss", tearing_truss, direct},
      {"tearing_net", tearing_net, direct},
      {"tearing_net_relaxed", tearing_net, with(relax, [](Settings& s) { s.substeps = 2; })},
      {"resting", spec("chain:links=4"), {.gradient = Gradient::new_, .sleep_time = 0.05}},
  };
  const auto add_edited = [&](const char* name, std::function<Scene()> scene, Settings settings) {
    out.push_back({.name = name, .scene = std::move(scene), .settings = settings, .edits = true});
  };
  add_edited("edited_ropes", spec("ensemble:chains=20,links=6,vary=0.5"), {.tensions = true});
  add_edited("edited_ropes_float", spec("ensemble:chains=20,links=6,vary=0.5"),
             with(relax, [](Settings& s) { s.precision = Precision::single, s.tensions = true; }));
  add_edited("edited_ropes_new", spec("ensemble:chains=9,links=8"),
             with(direct, [](Settings& s) { s.gradient = Gradient::new_, s.substeps = 2; }));
  add_edited("edited_graph", spec("graph:particles=60"), relax);
  add_edited("edited_net", spec("net:width=8,height=6"), direct);
  add_edited("edited_tearing_net", tearing_net, direct);
  add_edited("edited_wire", spec("wire"), direct);
  for (const char* const name : {"edited_ropes", "edited_ropes_float", "edited_wire", "tackle", "reel",
                                 "heap", "ropes_accurate", "relaxed_ropes_float"}) {
    out.push_back(*std::find_if(out.begin(), out.end(), [&](const Case& of) { return of.name == name; }));
    out.back().name = "living_" + out.back().name;
    out.back().adds = true;
  }
  for (std::size_t i = 0; i < std::size(test::breaking_laws); ++i) {
    const auto chain = [i] { return test::hanging_chain(test::breaking_laws[i]); };
    out.push_back({"breaking_" + std::to_string(i), chain, direct});
    out.push_back({"breaking_relaxed_" + std::to_string(i), chain, relax});
  }
  return out;
}

/// All that a world lets be read, as bits, so that NaN is equal to itself.
std::vector<std::uint64_t> readings(const World& world, const Scene& scene, const Settings& settings) {
  std::vector<std::uint64_t> out{world.state_hash()};
  const auto add = [&](double value) { out.push_back(std::bit_cast<std::uint64_t>(value)); };
  const auto add_vector = [&](Vec3 v) {
    for (const double c : {v.x, v.y, v.z}) add(c);
  };
  add(world.time());
  std::vector<Vec3> reactions(world.particle_count());
  if (settings.tensions) world.copy_reactions(reactions);
  const std::vector<Vec3> positions = test::positions_of(world), velocities = test::velocities_of(world);
  for (std::uint32_t i = 0; i < world.particle_count(); ++i) {
    out.push_back(world.handle<Particle>(i).generation);
    add_vector(positions[i]);
    add_vector(velocities[i]);
    add_vector(reactions[i]);
  }
  for (std::uint32_t i = 0; i < world.rod_count(); ++i) {
    out.push_back(world.handle<Rod>(i).generation);
    if (!world.handle<Rod>(i)) continue;
    out.push_back(world.is_broken(i) ? 1 : 0);
    if (!settings.tensions) continue;
    add(world.tension(i));
    add(world.power(i));
  }
  for (const Problem& problem : world.problems()) {
    out.push_back(static_cast<std::uint64_t>(problem.kind));
    add(problem.strain);
  }
  for (std::uint32_t i = 0; i < scene.tackles.size(); ++i)
    if (world.handle<Particle>(scene.tackles[i].particles[0]).generation == 1) add(world.tackle_tension(i));
  for (std::uint32_t i = 0; i < scene.reels.size(); ++i) add(world.reel_out(i));
  for (std::uint32_t i = 0; i < scene.twists.size(); ++i) add(world.twist(i));
  for (std::uint32_t i = 0; i < scene.torsions.size(); ++i) add(world.torsion_angle(i));
  for (std::uint32_t i = 0; i < scene.platforms.size(); ++i) add_vector(world.platform(i).position);
  if (settings.tensions && !scene.capsules.empty())
    for (std::uint32_t i = 0; i < scene.capsules.size(); ++i) add_vector(world.contact_force(i));
  if (settings.contacts)
    for (const Contact& contact : world.contacts()) {
      out.push_back(static_cast<std::uint64_t>(contact.phase));
      add_vector(contact.impulse);
      add_vector(contact.point);
    }
  return out;
}

class Rollback : public testing::TestWithParam<Case> {
 protected:
  static constexpr std::uint32_t frames = 48, back = 8;
  static constexpr double dt = 1.0 / 60;

  Rollback() : scene_(GetParam().scene()), settings_(GetParam().settings) {}

  Settings on(Isa isa, unsigned threads, Executor* executor) const {
    Settings settings = settings_;
    settings.isa = isa;
    settings.threads = threads;
    settings.executor = executor;
    return settings;
  }
  test::Player player(std::uint32_t seed) const {
    test::Player out(scene_, seed);
    if (GetParam().winch) out.with_winch(*GetParam().winch);
    if (GetParam().changes_rules) out.with_rules();
    if (GetParam().edits) out.with_edits();
    if (GetParam().adds) out.with_additions();
    return out;
  }
  std::vector<std::uint64_t> read(const World& world) const { return readings(world, scene_, settings_); }

  Scene scene_;
  Settings settings_;
};

TEST_P(Rollback, ComesToTheBitsOfAWorldThatKnewAllAlong) {
  const test::Player truth = player(1), guess = player(2);
  test::PoolExecutor pool(2);
  detail::EagerExecutor eager(pool, {.projections = 1, .rods = 64});
  World straight(scene_, on(Isa::scalar, 1, nullptr)), played(scene_, on(best_isa(), 2, &eager));
  std::vector<test::Snapshot> ring(back);
  for (std::uint32_t frame = 0; frame < frames; ++frame) {
    truth.act(straight, frame);
    straight.step(dt);
    ring[frame % back] = test::snapshot_of(played);
    guess.act(played, frame);
    played.step(dt);
    if (frame % back != back - 1) continue;
    played.restore(ring[0]);
    for (std::uint32_t again = frame + 1 - back; again <= frame; ++again) {
      truth.act(played, again);
      played.step(dt);
    }
    ASSERT_EQ(read(played), read(straight)) << "frame " << frame;
    ASSERT_TRUE(test::snapshot_of(played) == test::snapshot_of(straight)) << "frame " << frame;
  }
}

TEST_P(Rollback, ReadsWhatTheSavedWorldReads) {
  const test::Player truth = player(1), guess = player(2);
  World world(scene_, on(best_isa(), 1, nullptr)), fresh(scene_, on(best_isa(), 1, nullptr));
  const auto go = [&](World& to, std::uint32_t from, std::uint32_t count, const test::Player& by) {
    for (std::uint32_t frame = from; frame < from + count; ++frame) {
      by.act(to, frame);
      to.step(dt);
    }
  };
  go(world, 0, 20, truth);
  const test::Snapshot saved = test::snapshot_of(world);
  const auto then = read(world);
  EXPECT_TRUE(test::snapshot_of(world) == saved) << "reading changed it";
  go(world, 20, 12, guess);
  world.restore(saved);
  fresh.restore(saved);
  EXPECT_EQ(read(world), then);
  EXPECT_EQ(read(fresh), then);
  EXPECT_TRUE(test::snapshot_of(fresh) == saved);
}

// What was ordered since the last step is part of a snapshot.
TEST_P(Rollback, KnowsWhatWaitsForTheNextStep) {
  const test::Player truth = player(1), guess = player(2);
  World world(scene_, on(best_isa(), 1, nullptr)), fresh(scene_, on(best_isa(), 1, nullptr));
  const auto act = [&](World& to, const test::Player& by) {
    for (const std::uint32_t frame : {24u, 27u, 25u}) by.act(to, frame);
  };
  test::run(world, dt, 3);
  test::run(fresh, dt, 2);
  act(world, truth);
  act(fresh, guess);
  fresh.restore(test::snapshot_of(world));
  EXPECT_EQ(read(fresh), read(world));
  for (World* const each : {&world, &fresh}) {
    test::run(*each, dt, 2);
    act(*each, guess);
    test::run(*each, dt, 2);
  }
  EXPECT_EQ(read(fresh), read(world));
}

INSTANTIATE_TEST_SUITE_P(Every, Rollback, testing::ValuesIn(cases()),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
