// Tackles: what is refused, how a scene file keeps them, their law, and where they lie in Newton's matrix.

#include "scene/tackles/tackles.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "direct/loops/loop_elements.hpp"
#include "direct/tackles/cords.hpp"
#include "direct/tackles/loop_pulleys.hpp"
#include "direct/tackles/loop_tackle.hpp"
#include "direct/tackles/loop_tackles.hpp"
#include "direct/tackles/tackle_law.hpp"
#include "plumb/plumb.hpp"
#include "scene/tackles/validate_law.hpp"
#include "scenes/files/scene_file.hpp"
#include "support/refusals.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using detail::TackleFactors;
using detail::TackleIterate;
using detail::TackleLaw;
using detail::TackleRow;
using test::fixed;
using test::movable;
using test::refusal;

/// A block that hangs from a cord between two anchors, 4 m long.
Scene hung_block() {
  Scene scene;
  scene.particles = {fixed({-1, 0, 0}), movable({0, -std::sqrt(3.0), 0}), fixed({1, 0, 0})};
  scene.tackles = {{.particles = {0, 1, 2}}};
  return scene;
}

std::string refused(const Tackle& tackle) {
  Scene scene = hung_block();
  scene.tackles = {{.particles = {0, 1, 2}}, tackle};
  return refusal([&] { validate(scene); });
}

TEST(Tackles, BadOnesAreRefusedWithTheirNumber) {
  EXPECT_EQ(refused({.particles = {1}}), "tackle 1: needs two particles at least, got 1");
  EXPECT_EQ(refused({.particles = {0, 1, 7}}),
            "tackle 1: particle 7 does not exist (the scene has 3 particles)");
  EXPECT_EQ(refused({.particles = {0, 1, 1, 2}}), "tackle 1: runs from particle 1 to itself");
  EXPECT_EQ(refused({.particles = {0, 2, 0}}), "tackle 1: all of its particles are fixed");
  EXPECT_EQ(refused({.particles = {0, 1}, .length = -1}),
            "tackle 1: length must be positive and finite, got -1 m");
  EXPECT_EQ(refused({.particles = {0, 1}, .law = {.stiffness = 1, .strength = 5}}),
            "tackle 1: has a strength, but cords do not break");
  EXPECT_EQ(refused({.particles = {0, 1}, .law = {.stiffness = -1}}),
            "tackle 1: stiffness must be 0 or more, got -1 N/m");
  EXPECT_EQ(refused({.particles = {0, 1}, .friction = -0.1}),
            "tackle 1: friction must be finite and not negative, got -0.1");
  EXPECT_EQ(refused({.particles = {0, 1}, .friction = std::numeric_limits<double>::infinity()}),
            "tackle 1: friction must be finite and not negative, got inf");
  EXPECT_EQ(refused({.particles = {0, 1}, .friction = std::numeric_limits<double>::quiet_NaN()}),
            "tackle 1: friction must be finite and not negative, got nan");
  EXPECT_EQ(refused({.particles = {0, 1, 0, 1, 2}}), "");
}

TEST(Tackles, MethodsThatDoNotMoveThemRefuseThem) {
  const Scene scene = hung_block();
  const auto with = [&](const Settings& settings) { return refusal([&] { World world(scene, settings); }); };
  for (const Method method : {Method::relax, Method::springs, Method::multipliers, Method::featherstone})
    EXPECT_EQ(with({.method = method}),
              "tackle 0: method " + std::string(to_string(method)) + " moves no tackles; direct and auto do");
  EXPECT_EQ(with({.method = Method::direct, .gradient = Gradient::old}),
            "tackle 0: gradient old moves no tackles; mid and new do");
  Scene solid = scene;
  solid.capsules = {{.a = point_at(1), .b = point_at(1), .radius = 0.1}};
  EXPECT_EQ(refusal([&] { World world(solid); }),
            "tackle 0: its island has joints or shapes, which nothing moves together with it yet");
}

TEST(Tackles, AWorldRefusesUnknownOnesAndBadLengths) {
  World world(hung_block());
  EXPECT_EQ(refusal([&] { world.set_tackle_length(1, 3); }), "tackle 1: unknown, the world has 1 tackle");
  EXPECT_EQ(refusal([&] { world.set_tackle_length(0, 0); }),
            "tackle 0: a length must be positive and finite, got 0 m");
  EXPECT_EQ(refusal([&] { (void)world.tackle_tension(0); }),
            "tensions are not known: Settings::tensions asks for them");
  World asked(hung_block(), {.tensions = true});
  EXPECT_EQ(refusal([&] { (void)asked.tackle_tension(2); }), "tackle 2: unknown, the world has 1 tackle");
  EXPECT_EQ(refusal([&] { (void)asked.tackle_tension(0, 2); }), "tackle 0: segment 2 is unknown, it has 2");
  EXPECT_TRUE(std::isnan(asked.tackle_tension(0)));
  EXPECT_TRUE(std::isnan(asked.tackle_tension(0, 1)));
}

TEST(Tackles, JoinTheirParticlesIntoOneIsland) {
  Scene scene = hung_block();
  scene.particles.push_back(movable({1, -1, 0}));
  scene.particles.push_back(movable({5, 0, 0}));
  scene.tackles = {{.particles = {0, 1, 2, 3}}};
  EXPECT_EQ(World(scene).info().islands, 2u);
}

TEST(Tackles, ASceneFileKeepsEveryBitOfThem) {
  Scene scene = hung_block();
  scene.tackles = {{.particles = {0, 1, 2}, .length = 13.0 / 3},
                   {.particles = {0, 1},
                    .law = {.stiffness = 1e3 / 7, .damping = 0.1, .one_sided = true},
                    .friction = 0.1 / 3}};
  const Scene back = scenes::parse_scene(scenes::format_scene(scene), "f.json");
  ASSERT_EQ(back.tackles.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(back.tackles[i].particles, scene.tackles[i].particles);
    EXPECT_EQ(back.tackles[i].length, scene.tackles[i].length);
    EXPECT_EQ(back.tackles[i].law, scene.tackles[i].law);
    EXPECT_EQ(back.tackles[i].friction, scene.tackles[i].friction);
  }
  const auto message = [](const std::string& tackle) {
    return refusal([&] {
      scenes::parse_scene(R"({"plumb": 1, "particles": [{"position": [0, 0, 0], "mass": 1}], "rods": [],
                              "tackles": [)" +
                              tackle + "]}",
                          "f.json");
    });
  };
  EXPECT_EQ(message("{}"), "f.json: tackles[0].particles is missing");
  EXPECT_EQ(message(R"({"particles": [0, "b"]})"),
            "f.json: tackles[0].particles[1] must be the number of a particle, counted from 0, not a string");
  EXPECT_EQ(message(R"({"particles": [0, 0], "length": 0})"),
            "f.json: tackles[0].length must be positive; leave it out for the way through the particles");
}

/// Energy of an elastic cord that is too long by `excess` (m), over the unit of mass.
double energy(const TackleLaw& law, double excess) {
  return law.is_one_sided && excess < 0 ? 0 : 0.5 * law.stiffness * excess * excess;
}

TEST(TackleLaw, TheWorkOfAnElasticCordIsTheChangeOfItsEnergy) {
  const double kick = 0.3;
  for (const bool one_sided : {false, true}) {
    const TackleLaw law{70, 0, false, one_sided};
    for (const double start : {-0.2, -0.01, 0.0, 0.1})
      for (const double end : {-0.3, -0.02, 0.05, 0.2}) {
        // With mu = 0 the row says how far the multiplier is from -kick times the pull.
        const TackleRow row = tackle_row(law, {kick, 100, 0.5}, {start, end, 0});
        const double pull = (row.use != 0 ? row.c / row.soft : row.c) / kick;
        EXPECT_NEAR(pull * (end - start), energy(law, end) - energy(law, start), 1e-15 * law.stiffness)
            << one_sided << " " << start << " " << end;
      }
  }
}

TEST(TackleLaw, RowsHaveTheDerivativeOfTheirEquation) {
  const double step = 1e-6;
  for (const double theta : {0.5, 1.0})
    for (const bool one_sided : {false, true})
      for (const double start : {-0.1, 0.1})
        for (const double end : {-0.2, 0.15}) {
          const TackleLaw law{70, 0.4, false, one_sided};
          const TackleFactors factors{0.3, 100, theta};
          const auto residual = [&](double at) {
            const TackleRow row = tackle_row(law, factors, {start, at, -0.7});
            return row.use != 0 ? row.c / row.soft : row.c;
          };
          const TackleRow row = tackle_row(law, factors, {start, end, -0.7});
          const double slope = (residual(end + step) - residual(end - step)) / (2 * step);
          // The residual is mu + kick pull: its derivative by mu is 1, and by the length 1/soft.
          EXPECT_NEAR(row.use / row.soft, slope, 1e-6 * law.stiffness) << theta << one_sided << start << end;
        }
}

TEST(TackleLaw, ARigidCordHoldsItsLengthAndASlackOneNothing) {
  const TackleLaw rigid{0, 0, true, false}, cable{0, 0, true, true};
  const TackleFactors factors{0.3, 100, 0.5};
  EXPECT_EQ(tackle_row(rigid, factors, {0, -0.1, 0}).c, -0.1);
  EXPECT_EQ(tackle_row(cable, factors, {0, 0.1, 0}).c, 0.1);
  EXPECT_EQ(tackle_row(cable, factors, {0, -0.1, 0}).use, 0);
  EXPECT_EQ(tackle_row(cable, factors, {0, -0.1, -1}).use, 1) << "it pulls still";
  const TackleRow given = giving_tackle_row(rigid, 0.3, 0.25, {0, 0.1, -0.2});
  EXPECT_DOUBLE_EQ(given.c, 0.1 - 0.25 * 0.2);
  const auto [mu, stored] = giving_tackle_pull(rigid, 0.3, 0.25, 0.1);
  EXPECT_DOUBLE_EQ(mu, -0.4);
  EXPECT_DOUBLE_EQ(stored, 0.02);
}

TEST(LoopTackle, NumbersItsValuesInOrder) {
  const detail::LoopTackle tackle{{4, 2, 4}, 0};
  EXPECT_EQ(tackle.segments(), 2u);
  EXPECT_EQ(tackle.at_segments(), 18u);
  EXPECT_EQ(tackle.values(), 18u + 36u + 1u);
  const std::array<double, 18> ends{1, 0, 0, 2, 0, 0, 0, 1, 0, 0, -3, 0, 0, 0, 1, 0, 0, 0};
  EXPECT_EQ(tackle_pivot(tackle, ends.data(), [](std::uint32_t v) { return v == 4 ? 1.0 : 0.5; }), 3.5);
}

TEST(LoopTackle, NumbersTheValuesOfItsPulleysInOrder) {
  const detail::LoopTackle tackle{{4, 2, 4, 3}, 0, true, 0};
  EXPECT_EQ(tackle.pulleys(), 2u);
  EXPECT_EQ(tackle.at_pulley(0), 24u + 54u + 1u);
  EXPECT_EQ(tackle.in_own(0), 6u + 9u) << "its row has the pulley's vertex and the two behind it";
  EXPECT_EQ(tackle.at_pulley(1), tackle.at_pulley(0) + 17u);
  EXPECT_EQ(tackle.values(), tackle.at_pulley(1) + 14u);
  const detail::LoopElements both{.tackles = {tackle, {{0, 1, 2}}, {{0, 1, 2}, 3, true, 2}}};
  EXPECT_EQ(both.pulleys(), 3u);
}

TEST(LoopPulleys, GoThroughABlowAsTheySlide) {
  detail::TackleWorkspace work;
  work.pulleys = {{2, detail::Slide::on}, {2, detail::Slide::sticks}, {2, detail::Slide::back}};
  begin_blow(work);
  EXPECT_EQ(work.pulleys[0].blow, detail::Slide::on);
  EXPECT_EQ(work.pulleys[1].blow, detail::Slide::sticks);
  EXPECT_EQ(work.pulleys[2].blow, detail::Slide::back);
  end_blow(work);
  for (const detail::Pulley& pulley : work.pulleys) EXPECT_EQ(pulley.blow, detail::Slide::even);
}

TEST(Cords, PullAlongTheMeanOfTheirWays) {
  const detail::TackleWorkspace::Segment segment{{2, 0, 0}, 2};
  const detail::Pull pull = detail::pull_along(segment, {0, 1.5, 0}, 0.5);
  EXPECT_NEAR(pull.growth, 0.5, 1e-15);
  EXPECT_NEAR(dot(pull.force, Vec3{0, 1.5, 0}), pull.growth, 1e-15) << "its work is that of the growth";
  EXPECT_NEAR(norm(pull.gradient - Vec3{0.8, 0.6, 0}), 0, 1e-15);
}

TEST(LoopElements, TellApartIslandsThatHaveOthers) {
  const detail::LoopElements none, over_two{.tackles = {{.vertices = {0, 1, 2}}}},
      over_one{.tackles = {{.vertices = {0, 1}}}};
  EXPECT_FALSE(none.any());
  EXPECT_TRUE(over_two.any());
  EXPECT_NE(over_two, over_one);
  EXPECT_LT(none, over_one);
  EXPECT_LT(over_one, over_two);
}

TEST(Tackles, SayTheirLengthAndTheirEnergy) {
  Scene scene = hung_block();
  EXPECT_NEAR(tackle_length(scene, 0), 4, 1e-15);
  scene.tackles[0].length = 3.5;
  scene.tackles[0].law.stiffness = 8;
  std::vector<Vec3> x;
  for (const Particle& particle : scene.particles) x.push_back(particle.position);
  EXPECT_NEAR(detail::tackle_energy(scene, x), 1, 1e-14);  // 8/2 (4 - 3.5)^2
  EXPECT_NEAR(measure_energy(scene, x, std::vector<Vec3>(3)).elastic, 1, 1e-14);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
