// What is drawn of a world, where, and in which colour, by a canvas that remembers it.

#include "plumb/embedding/drawing.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "plumb/plumb.hpp"
#include "scenes/spec.hpp"
#include "support/refusals.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::refusal;

class Recording : public Canvas {
 public:
  struct Line {
    Vec3 from, to;
    Color color;
  };
  struct Mark {
    Vec3 at;
    Color color;
    std::string text{};
  };
  void line(Vec3 from, Vec3 to, Color color) override { lines.push_back({from, to, color}); }
  void point(Vec3 at, Color color) override { points.push_back({at, color}); }
  void text(Vec3 at, std::string_view text, Color color) override {
    texts.push_back({at, color, std::string(text)});
  }
  std::size_t lines_in(Color color) const {
    return static_cast<std::size_t>(
        std::count_if(lines.begin(), lines.end(), [&](const Line& line) { return line.color == color; }));
  }

  std::vector<Line> lines;
  std::vector<Mark> points, texts;
};

constexpr Palette colors{};
/// Nothing but what a test switches on.
constexpr DrawChoice nothing{
    .rods = false, .anchors = false, .contacts = false, .grabs = false, .joints = false, .bodies = false};

Recording drawn(const World& world, const DrawChoice& choice) {
  Recording out;
  Drawing().draw(world, out, choice);
  return out;
}

/// Hangs a weight of `mass` (kg) from an elastic rod of 1 m and 1000 N/m, at rest where it is stretched by
/// `stretch` (m).
Scene hanging(double mass, double stretch) {
  Scene scene;
  scene.particles = {{.fixed = true}, {.position = {0, -1 - stretch, 0}, .mass = mass}};
  scene.rods = {{.a = 0, .b = 1, .length = 1, .law = {.stiffness = 1000}}};
  return scene;
}

TEST(Drawing, ShowsStrainByColour) {
  const auto color = [](double stretch) {
    return drawn(World(hanging(1, stretch)), {.full = 0.1}).lines.at(0).color;
  };
  EXPECT_EQ(color(0.1), colors.stretched);
  EXPECT_EQ(color(0.5), colors.stretched);
  EXPECT_EQ(color(-0.2), colors.pressed);
  EXPECT_EQ(color(0), colors.rod);
  const Color half = color(0.05);  // Half way between 200, 200, 200 and 230, 60, 40, to the nearest.
  EXPECT_EQ(half, (Color{215, 130, 120}));
}

TEST(Drawing, ShowsPullByColour) {
  World world(hanging(1, 0.00981), {.tensions = true});
  const DrawChoice choice{.tone = RodTone::tension, .full = 9.8};
  EXPECT_EQ(drawn(world, choice).lines.at(0).color, colors.rod);  // It is not known before the first step.
  world.step(1.0 / 60);
  EXPECT_EQ(drawn(world, choice).lines.at(0).color, colors.stretched);
  EXPECT_NE(refusal([&] { drawn(World(hanging(1, 0)), choice); }), "");
}

TEST(Drawing, ShowsRodsWhereTheyAreAndNotThoseThatAreOut) {
  Scene scene = scenes::load_scene("chain:links=5");
  World world(scene);
  world.step(1.0 / 60);
  DrawChoice choice = nothing;
  choice.rods = choice.numbers = choice.anchors = true;
  const Recording all = drawn(world, choice);
  ASSERT_EQ(all.lines.size(), 5u);
  for (std::uint32_t i = 0; i < 5; ++i) {
    EXPECT_EQ(all.lines[i].from, world.position(scene.rods[i].a));
    EXPECT_EQ(all.lines[i].to, world.position(scene.rods[i].b));
    EXPECT_EQ(all.texts[i].text, std::to_string(i));
  }
  ASSERT_EQ(all.points.size(), 1u);
  EXPECT_EQ(all.points[0].at, world.position(0));
  EXPECT_EQ(all.points[0].color, colors.anchor);

  world.cut(2);
  world.step(1.0 / 60);
  EXPECT_EQ(drawn(world, choice).lines.size(), 4u);
  world.add(scene);
  EXPECT_EQ(drawn(world, choice).lines.size(), 9u);
  world.remove(1);  // With the anchor and the two rods that still hang from it.
  EXPECT_EQ(drawn(world, choice).lines.size(), 7u);
  EXPECT_EQ(drawn(world, choice).points.size(), 1u);
}

TEST(Drawing, DimsWhatSleeps) {
  Scene scene = scenes::load_scene("chain:links=3");
  for (Particle& particle : scene.particles) particle.asleep = true;
  const World world(scene);
  const Color dim{118, 118, 118};  // 200, three quarters of the way to 90, to the nearest.
  EXPECT_EQ(drawn(world, {}).lines_in(dim), 3u);
  EXPECT_EQ(drawn(world, {.asleep = false}).lines_in(colors.rod), 3u);
}

TEST(Drawing, ShowsWhatFroze) {
  Scene scene = scenes::load_scene("ensemble:chains=2,links=3");
  scene.particles[3].mass = 1e-8;
  World world(scene, {.method = Method::relax});
  world.set_force(3, {1e308, 0, 0});
  ASSERT_EQ(world.step(1.0 / 60).frozen_islands, 1u);
  EXPECT_EQ(drawn(world, {}).lines_in(colors.frozen), 3u);
}

TEST(Drawing, ShowsContactsWithNormals) {
  Scene scene;
  scene.particles = {{.position = {0.5, 0.1, 0}, .mass = 1}, {.position = {1.5, 0.1, 0}, .mass = 1}};
  scene.rods = {{.a = 0, .b = 1}};
  scene.capsules = {{.a = point_at(0), .b = point_at(1), .radius = 0.1}};
  scene.planes = {{}};
  DrawChoice choice = nothing;
  choice.contacts = true;
  World world(scene, {.contacts = true});
  for (int i = 0; i < 5; ++i) world.step(1.0 / 60);
  const Recording all = drawn(world, choice);
  ASSERT_EQ(all.points.size(), 1u);
  ASSERT_EQ(all.lines.size(), 1u);
  EXPECT_EQ(all.points[0].at, world.contacts()[0].point);
  EXPECT_NEAR(norm(all.lines[0].to - all.lines[0].from), choice.length, 1e-12);
  EXPECT_NEAR(std::abs(all.lines[0].to.y - all.lines[0].from.y), choice.length, 1e-9);
  EXPECT_TRUE(drawn(World(scene), choice).points.empty());  // Nothing lists them.
}

TEST(Drawing, ShowsGrabs) {
  World world(scenes::load_scene("chain:links=3"));
  DrawChoice choice = nothing;
  choice.grabs = true;
  const Handle<Grab> grab = world.grab(Grab::particle(2, {1, 2, 3}, 100));
  const Recording all = drawn(world, choice);
  ASSERT_EQ(all.lines.size(), 1u);
  EXPECT_EQ(all.lines[0].from, world.position(2));
  EXPECT_EQ(all.lines[0].to, (Vec3{1, 2, 3}));
  world.release(grab);
  EXPECT_TRUE(drawn(world, choice).lines.empty());
}

TEST(Drawing, BoundsEachIsland) {
  DrawChoice choice = nothing;
  choice.bounds = true;
  for (const Method method : {Method::relax, Method::direct}) {
    World world(scenes::load_scene("ensemble:chains=40,links=4"), {.method = method});
    const Recording all = drawn(world, choice);
    EXPECT_EQ(all.lines.size(), 40u * 12);
    // The first box is of four particles, and holds them.
    for (std::uint32_t i = 1; i <= 4; ++i)
      EXPECT_TRUE(std::any_of(all.lines.begin(), all.lines.begin() + 12, [&](const Recording::Line& line) {
        return line.from.x == world.position(i).x || line.to.x == world.position(i).x ||
               (line.from.x < world.position(i).x && world.position(i).x < line.to.x);
      }));
  }
}

TEST(Drawing, ShowsBodiesAndJoints) {
  Scene scene;
  const std::uint32_t a = add_body(scene, solid_box(1, {0.2, 0.2, 0.2}));
  const std::uint32_t b =
      add_body(scene, {.mass = 1, .center = {0.4, 0, 0}, .inertia = {.xx = 0.01, .yy = 0.01, .zz = 0.01}});
  add_revolute(scene, a, b, {0.2, 0, 0}, {0, 0, 1});
  const World world(scene);
  DrawChoice choice = nothing;
  choice.bodies = true;
  const Recording bodies = drawn(world, choice);
  ASSERT_EQ(bodies.lines.size(), 6u);
  EXPECT_NEAR(norm(bodies.lines[3].from - Vec3{0.4, 0, 0}), 0, 1e-12);
  EXPECT_NEAR(norm(bodies.lines[3].to - Vec3{0.5, 0, 0}), 0, 1e-12);
  choice = nothing;
  choice.joints = true;
  const Recording joints = drawn(world, choice);
  ASSERT_EQ(joints.points.size(), 1u);
  EXPECT_NEAR(norm(joints.points[0].at - Vec3{0.2, 0, 0}), 0, 1e-12);
  EXPECT_EQ(joints.lines.size(), 4u);  // Two alignments of two directions each.
}

TEST(Drawing, RefusesWhatMakesNoSenseAndChangesNothing) {
  World world(scenes::load_scene("chain:links=3"));
  EXPECT_NE(refusal([&] { drawn(world, {.full = 0}); }), "");
  EXPECT_NE(refusal([&] { drawn(world, {.length = std::nan("")}); }), "");
  World alone(scenes::load_scene("chain:links=3"));
  for (int i = 0; i < 20; ++i) {
    world.step(1.0 / 60);
    alone.step(1.0 / 60);
    drawn(world, {.bounds = true});
  }
  EXPECT_EQ(world.state_hash(), alone.state_hash());
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
