// Settings change in place or in a world that goes on from the state of the one before, and what hands do
// works on chains, nets, figures and heaps.
#include "view/exhibit/side.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "plumb/error.hpp"
#include "support/figures.hpp"
#include "support/refusals.hpp"
#include "view/exhibits.hpp"

namespace plumb::view::PLUMB_TEST_FILE {
namespace {

using test::is_sound;
using test::refusal;
using test::run;
using test::set;
using test::start_of;

struct State {
  std::vector<Vec3> positions, velocities;
};

State state_of(const Side& side) {
  State out{side.positions(), std::vector<Vec3>(side.scene().particles.size())};
  side.world().copy_velocities(out.velocities);
  return out;
}

double largest_change(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double out = 0;
  for (std::size_t i = 0; i < a.size(); ++i) out = std::max(out, norm(a[i] - b[i]));
  return out;
}

double fastest(const std::vector<Vec3>& velocities) {
  return largest_change(velocities, std::vector<Vec3>(velocities.size()));
}

/// Changes a setting and expects the state to stay: positions to 1e-12 m and velocities to 1e-9 m/s, which is
/// rounding. Where a new world goes on, it takes out of velocities what pulls on rods, which steps leave by
/// their error, and tells how much that was.
void expect_carried(Exhibit& exhibit, const Request& request, bool rebuilds) {
  const State before = state_of(exhibit.sides()[0]);
  const std::uint32_t worlds = exhibit.sides()[0].rebuilds();
  EXPECT_EQ(exhibit.take(request), "");
  EXPECT_EQ(exhibit.sides()[0].rebuilds() - worlds, rebuilds ? 1U : 0U) << request.name;
  const State after = state_of(exhibit.sides()[0]);
  EXPECT_LE(largest_change(before.positions, after.positions), 1e-12) << request.name << request.value;
  const double taken_out = rebuilds ? exhibit.sides()[0].world().info().projected_velocity : 0;
  EXPECT_LE(largest_change(before.velocities, after.velocities), taken_out + 1e-9)
      << request.name << request.value;
  EXPECT_LE(taken_out, 0.02 * fastest(before.velocities) + 1e-9) << request.name << request.value;
  run(exhibit, 3);
  EXPECT_TRUE(is_sound(exhibit)) << request.name;
}

TEST(ViewSide, ChangesInPlace) {
  Exhibit exhibit(start_of("chain:links=12", {{.method = Method::relax, .substeps = 4}}));
  run(exhibit, 30);
  for (const Request& request : {set("substeps", "7"), set("sweeps", "30"), set("weights", "equal"),
                                 set("tolerance", "1e-4"), set("gravity", "3")})
    expect_carried(exhibit, request, false);
  EXPECT_EQ(exhibit.sides()[0].settings().substeps, 7U);
  EXPECT_EQ(exhibit.sides()[0].scene().gravity, (Vec3{0, -3, 0}));
  Exhibit direct(start_of("chain:links=12", {{.method = Method::direct, .substeps = 4}}));
  run(direct, 30);
  expect_carried(direct, set("end_mass", "20"), false);
  EXPECT_EQ(direct.sides()[0].scene().particles.back().mass, 20);
}

// What a chain does not read when it is solved is kept for when it is relaxed again.
TEST(ViewSide, KeepsWhatNothingReads) {
  Exhibit exhibit(start_of("chain:links=12", {{.method = Method::relax, .stop = {.tolerance = 1e-3}}}));
  run(exhibit, 3);
  exhibit.take(set("method", "auto"));
  run(exhibit, 3);
  EXPECT_TRUE(is_sound(exhibit));
  exhibit.take(set("method", "relax"));
  EXPECT_EQ(exhibit.sides()[0].world().settings().stop.tolerance, 1e-3);
}

TEST(ViewSide, GoesOnInANewWorld) {
  for (const char* scene : {"chain:links=12", "net:width=6,height=6", "humanoid", "rods5"}) {
    SCOPED_TRACE(scene);
    Exhibit exhibit(start_of(scene, {{.method = Method::direct, .substeps = 4}}));
    run(exhibit, 30);
    expect_carried(exhibit, set("drag", "0.5"), true);
    expect_carried(exhibit, set("drag", "0"), true);
  }
}

TEST(ViewSide, TakesMethodsAndTheirSettingsInPlace) {
  for (const char* scene : {"chain:links=12", "net:width=6,height=6", "humanoid", "rods5"}) {
    SCOPED_TRACE(scene);
    Exhibit exhibit(start_of(scene, {{.method = Method::direct, .substeps = 4}}));
    run(exhibit, 30);
    for (const Request& request : {set("accuracy", "1e-3"), set("accuracy", "off"), set("gradient", "old"),
                                   set("gradient", "auto"), set("method", "relax"), set("order", "jacobi"),
                                   set("order", "gauss-seidel"), set("method", "auto"), set("substeps", "6")})
      expect_carried(exhibit, request, false);
  }
}

TEST(ViewSide, GoesOnWithBodiesThatTouch) {
  Exhibit exhibit(start_of("pile", {{.substeps = 2}}));
  run(exhibit, 40);
  expect_carried(exhibit, set("drag", "0.2"), true);
}

TEST(ViewSide, GoesOnWithRodsThatAreCut) {
  Exhibit exhibit(start_of("chain:links=12", {{.method = Method::direct, .substeps = 4}}));
  run(exhibit, 10);
  exhibit.take({.verb = Verb::cut, .number = 6});
  exhibit.take({.verb = Verb::cut, .number = 2});
  run(exhibit, 10);
  expect_carried(exhibit, set("drag", "0.5"), true);
  const Side& side = exhibit.sides()[0];
  EXPECT_TRUE(side.is_gone(2) && side.is_gone(6));
  EXPECT_FALSE(side.is_gone(3));
  EXPECT_EQ(side.world().rod_count(), side.scene().rods.size() - 2);
  const std::vector<float> strains = side.strains();
  EXPECT_TRUE(std::isnan(strains[2]) && std::isnan(strains[6]));
  for (const std::uint32_t rod : {0U, 3U, 7U, 11U}) EXPECT_LT(std::abs(strains[rod]), 1e-6F);
  // Numbers are those of the scene after the rebuild, too.
  exhibit.take({.verb = Verb::cut, .number = 8});
  EXPECT_TRUE(side.is_gone(8));
  EXPECT_NE(refusal([&] { exhibit.take({.verb = Verb::cut, .number = 8}); }), "");
}

TEST(ViewSide, SeversALimbWhoseRodIsCut) {
  for (const Method method : {Method::automatic, Method::direct}) {
    Scene figure;
    test::add_figure(figure, {0, 2, 0});
    Exhibit exhibit({"figure", figure, {{"one", {.method = method, .substeps = 2}}}});
    run(exhibit, 10);
    const Side& side = exhibit.sides()[0];
    const Scene before = side.scene();
    const auto& limb = before.bodies.back().particles;
    const auto is_of_limb = [&](std::uint32_t particle) {
      return std::count(limb.begin(), limb.end(), particle) > 0;
    };
    const auto rod = std::find_if(before.rods.begin(), before.rods.end(),
                                  [&](const Rod& each) { return is_of_limb(each.a) && is_of_limb(each.b); });
    const auto number = static_cast<std::uint32_t>(rod - before.rods.begin());
    exhibit.take({.verb = Verb::cut, .number = number});
    EXPECT_LT(side.scene().pins.size(), before.pins.size());
    EXPECT_FALSE(side.is_gone(number));
    run(exhibit, 60);
    EXPECT_TRUE(is_sound(exhibit));
    EXPECT_NE(refusal([&] { exhibit.take({.verb = Verb::cut, .number = number}); }).find("no joint holds"),
              std::string::npos);
  }
}

TEST(ViewSide, MethodsFollowEachOther) {
  for (const char* scene : {"chain:links=8", "net:width=5,height=5"}) {
    Exhibit exhibit(start_of(scene, {{.substeps = 4}}));
    for (const MethodInfo& method : all_methods()) {
      const std::string why = refusal([&] { exhibit.take(set("method", std::string(method.name))); });
      if (why.empty()) {
        EXPECT_EQ(to_string(exhibit.sides()[0].settings().method), method.name);
      }
      run(exhibit, 5);
      EXPECT_TRUE(is_sound(exhibit)) << scene << " " << method.name;
    }
  }
}

TEST(ViewSide, CutsFixesAndFrees) {
  Exhibit exhibit(start_of("chain:links=10", {{.method = Method::direct, .substeps = 4}}));
  exhibit.take({.verb = Verb::cut, .number = 5});
  run(exhibit, 30);
  const Side& side = exhibit.sides()[0];
  // What is cut off falls freely: g t²/2, to first order in a substep of 1/240 s.
  const double fallen = side.scene().particles[8].position.y - side.positions()[8].y;
  EXPECT_NEAR(fallen, 0.5 * 9.81 * 0.25, 0.02);
  exhibit.take({.verb = Verb::fix, .number = 3});
  const Vec3 held = side.positions()[3];
  run(exhibit, 10);
  EXPECT_EQ(side.positions()[3], held);
  exhibit.take({.verb = Verb::free, .number = 3});
  run(exhibit, 10);
  EXPECT_NE(side.positions()[3], held);
  exhibit.take({.verb = Verb::free, .number = 0});
  run(exhibit, 60);
  EXPECT_LT(side.positions()[0].y, side.scene().particles[0].position.y - 1);
}

/// Pulls a particle by 0.3 m for two seconds, and expects it near where it is pulled: the spring gives by a
/// hundredth of the diagonal under the weight, and twice that is given room for what still swings.
void expect_pulled(const char* scene, const Settings& settings, std::uint32_t particle) {
  SCOPED_TRACE(scene);
  Exhibit exhibit(start_of(scene, {settings}));
  run(exhibit, 10);
  const Vec3 from = exhibit.sides()[0].positions()[particle];
  const Vec3 to = from + Vec3{-0.1, 0.3, 0.1};
  for (int i = 0; i < 120; ++i) {
    exhibit.take(
        {.verb = Verb::pull, .number = particle, .at = from + std::min(1.0, i / 60.0) * (to - from)});
    exhibit.step();
  }
  EXPECT_LE(norm(exhibit.sides()[0].positions()[particle] - to),
            0.03 * bounding_diagonal(exhibit.start().scene));
  // Where a new world goes on, the hand goes on, too.
  exhibit.take(set("drag", "0.1"));
  run(exhibit, 20);
  EXPECT_LE(norm(exhibit.sides()[0].positions()[particle] - to),
            0.03 * bounding_diagonal(exhibit.start().scene));
  exhibit.take({.verb = Verb::release});
  run(exhibit, 30);
  EXPECT_TRUE(is_sound(exhibit));
}

TEST(ViewSide, PullsParticlesAndAnchors) {
  expect_pulled("chain:links=10,end_mass=100", {.method = Method::direct, .substeps = 4}, 10);
  expect_pulled("chain:links=10,end_mass=100",
                {.method = Method::relax, .substeps = 4, .stop = {.sweeps = 50}}, 10);
  expect_pulled("net:width=6,height=6", {.method = Method::direct, .substeps = 4}, 30);
  expect_pulled("chain:links=10", {.method = Method::direct, .substeps = 4}, 0);
}

// A relaxed body stands as its pose says but for what sweeps leave, and goes on so in a new world.
TEST(ViewSide, ThrowsOneBallAfterTheOtherAtRelaxedBodies) {
  for (const char* scene : {"boxes", "humanoid:body=medium"}) {
    SCOPED_TRACE(scene);
    Exhibit exhibit(start_of(scene, {{.method = Method::relax}}));
    const std::size_t particles = exhibit.sides()[0].scene().particles.size();
    for (std::size_t ball = 1; ball <= 4; ++ball) {
      run(exhibit, 40);
      const Vec3 at = exhibit.sides()[0].positions().front() + Vec3{0, 1, 0};
      EXPECT_EQ(refusal([&] {
                  exhibit.take({.verb = Verb::throw_ball, .value = "0.05", .at = at, .velocity = {0, -5, 0}});
                }),
                "");
      EXPECT_EQ(exhibit.sides()[0].scene().particles.size(), particles + ball);
    }
    run(exhibit, 40);
    EXPECT_TRUE(is_sound(exhibit));
  }
}

TEST(ViewSide, PullsCutsAndThrowsWhereBodiesTouch) {
  for (const char* scene : {"humanoid", "pile", "rope"}) {
    SCOPED_TRACE(scene);
    Exhibit exhibit(start_of(scene, {{.substeps = 2}}));
    run(exhibit, 10);
    const std::size_t particles = exhibit.sides()[0].scene().particles.size();
    const Vec3 at = exhibit.sides()[0].positions().back();
    const auto last = static_cast<std::uint32_t>(particles - 1);
    EXPECT_EQ(refusal([&] {
                exhibit.take({.verb = Verb::pull, .number = last, .at = at + Vec3{0, 0.5, 0}});
              }),
              "");
    run(exhibit, 30);
    EXPECT_GT(exhibit.sides()[0].positions().back().y, at.y) << "it is lifted";
    exhibit.take({.verb = Verb::release});
    const std::string why = refusal([&] {
      exhibit.take(
          {.verb = Verb::throw_ball, .value = "0.1", .at = at + Vec3{0, 3, 0}, .velocity = {0, -2, 0}});
    });
    const bool has_shapes = !exhibit.start().scene.capsules.empty() || !exhibit.start().scene.hulls.empty();
    EXPECT_EQ(why.empty(), has_shapes) << why;
    EXPECT_EQ(exhibit.sides()[0].scene().particles.size(), particles + (has_shapes ? 1 : 0));
    for (std::uint32_t rod = 0; rod < exhibit.sides()[0].scene().rods.size() && rod < 4; rod += 2) {
      // A limb whose rod is all of its mass cannot lose it.
      const std::string cut = refusal([&] { exhibit.take({.verb = Verb::cut, .number = rod}); });
      EXPECT_TRUE(cut.empty() || cut.find("has no mass") != std::string::npos) << cut;
      EXPECT_EQ(exhibit.sides()[0].is_gone(rod), cut.empty());
    }
    run(exhibit, 40);
    EXPECT_TRUE(is_sound(exhibit));
  }
}

TEST(ViewSide, ReelsAndStops) {
  Exhibit exhibit(start_of("winch", {{.method = Method::direct, .substeps = 4}}));
  const double length = exhibit.sides()[0].scene().rods[0].length;
  exhibit.take({.verb = Verb::reel, .name = "rod", .value = "-0.3"});
  run(exhibit, 10);
  // A sixth of a second at 0.3 m/s, but not below a twentieth of a metre; sums of ten terms round.
  EXPECT_NEAR(exhibit.sides()[0].scene().rods[0].length, std::max(0.05, length - 0.05), 1e-12);
  exhibit.take({.verb = Verb::reel, .name = "rod", .value = "0.6"});
  run(exhibit, 10);
  const double out = exhibit.sides()[0].scene().rods[0].length;
  EXPECT_GT(out, length);
  exhibit.take({.verb = Verb::reel, .name = "rod", .value = "0"});
  run(exhibit, 10);
  EXPECT_EQ(exhibit.sides()[0].scene().rods[0].length, out);
  exhibit.take({.verb = Verb::reel, .name = "rod", .value = "-5"});
  run(exhibit, 60);
  EXPECT_GE(exhibit.sides()[0].scene().rods[0].length, 0.05);
  EXPECT_TRUE(is_sound(exhibit));
}

TEST(ViewSide, EndsOfSlidersWorkOrAreRefused) {
  for (const char* scene : {"chain:links=8", "net:width=5,height=5", "humanoid"})
    for (const Method method : {Method::automatic, Method::relax, Method::direct}) {
      Exhibit exhibit(start_of(scene, {{.method = method, .substeps = 2}}));
      for (const Request& request :
           {set("end_mass", "0.1"),  set("end_mass", "1000"),  set("end_mass", "0"),
            set("gravity", "0"),     set("gravity", "20"),     set("gravity", "1e300"),
            set("gravity", "9.81"),  set("drag", "5"),         set("drag", "1e300"),
            set("drag", "0"),        set("substeps", "0"),     set("substeps", "1"),
            set("substeps", "128"),  set("substeps", "2"),     set("sweeps", "0"),
            set("sweeps", "1"),      set("sweeps", "1000"),    set("tolerance", "0"),
            set("tolerance", "0.1"), set("tolerance", "1e-8"), set("tolerance", "off"),
            set("accuracy", "0"),    set("accuracy", "0.1"),   set("accuracy", "1e-4"),
            set("accuracy", "off"),  set("gradient", "old"),   set("gradient", "new"),
            set("gradient", "mid"),  set("gradient", "auto")}) {
        const State before = state_of(exhibit.sides()[0]);
        if (!refusal([&] { exhibit.take(request); }).empty()) {
          EXPECT_EQ(largest_change(before.positions, state_of(exhibit.sides()[0]).positions), 0);
        }
        run(exhibit, 1);
        EXPECT_TRUE(is_sound(exhibit)) << scene << " " << request.name << " " << request.value;
      }
    }
}

TEST(ViewSide, KnowsTheTimeOfEveryStageThatTheKernelNames) {
  const Scene scene = scenes::load_scene("rope:links=4");
  World world(scene, {.events = true});
  std::vector<std::string> named;
  world.set_zones([&](std::string_view stage, bool begins) {
    if (begins) named.emplace_back(stage);
  });
  world.step(frame_length);
  ASSERT_FALSE(named.empty());
  for (const std::string& stage : named)
    EXPECT_NE(std::find(stage_names.begin(), stage_names.end(), stage), stage_names.end()) << stage;
  Side side({"one", {}}, scene);
  side.set("method", "relax");  // a new world is timed, too
  side.step(frame_length);
  double sum = 0;
  for (const double us : side.stage_us()) sum += us;
  EXPECT_GT(sum, 0);
  EXPECT_LE(sum, side.step_us());
}

}  // namespace
}  // namespace plumb::view::PLUMB_TEST_FILE
