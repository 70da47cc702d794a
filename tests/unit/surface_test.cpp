// What shapes feel like and may touch, and what carries ground: as files and as what is refused.

#include "plumb/shapes/surface.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "scenes/files/scene_file.hpp"
#include "support/bodies.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

// As engines have it: the category of each is in the mask of the other, or a common group decides.
TEST(Filter, LetsTouchWhatBothAllow) {
  constexpr Filter usual, ghost{.category = 0}, red{.category = 2, .mask = 4}, blue{.category = 4, .mask = 6};
  EXPECT_TRUE(may_touch(usual, usual));
  EXPECT_FALSE(may_touch(usual, ghost));
  EXPECT_TRUE(may_touch(red, blue));
  EXPECT_TRUE(may_touch(blue, red));
  EXPECT_TRUE(may_touch(blue, blue));
  EXPECT_FALSE(may_touch(red, red));
  EXPECT_FALSE(may_touch(red, usual)) << "red does not touch category 1";
  EXPECT_FALSE(may_touch(usual, red));
}

TEST(Filter, OfACommonGroupDecidesAlone) {
  EXPECT_FALSE(may_touch({.group = -3}, {.group = -3}));
  EXPECT_TRUE(may_touch({.category = 0, .mask = 0, .group = 3}, {.category = 0, .mask = 0, .group = 3}));
  EXPECT_TRUE(may_touch({.group = -3}, {.group = 3}));
  EXPECT_FALSE(may_touch({.category = 0, .group = 3}, {.group = 2}));
}

Scene scene_with_all() {
  Scene scene;
  scene.particles.push_back(test::movable({0, 1, 0}, 1));
  scene.capsules = {
      {.a = point_at(0),
       .b = point_at(0),
       .radius = 0.1,
       .surface = {.rolling = 0.1 / 3, .spinning = 0.2 / 3},
       .filter = {.category = 0x80000000, .mask = 0, .group = -2147483647, .own_island = true}}};
  scene.planes = {{.surface = {.rolling = 0.5}, .motion = {.platform = 1, .belt = {1.0 / 3, 0, -1}}}};
  scene.boxes = {{.half_size = {1, 1, 1}, .filter = {.mask = 6}, .motion = {.platform = 0}}};
  scene.platforms = {{}, {.position = {1, 2, 1.0 / 3}, .orientation = {0.6, 0, 0.8, 0}}};
  return scene;
}

TEST(SceneFile, KeepsFiltersResistancesAndWhatMoves) {
  const Scene scene = scene_with_all();
  const std::string text = scenes::format_scene(scene);
  const Scene back = scenes::parse_scene(text, "f");
  EXPECT_EQ(scenes::format_scene(back), text);
  EXPECT_EQ(back.capsules[0].filter, scene.capsules[0].filter);
  EXPECT_EQ(back.capsules[0].surface.rolling, scene.capsules[0].surface.rolling);
  EXPECT_EQ(back.capsules[0].surface.spinning, scene.capsules[0].surface.spinning);
  EXPECT_EQ(back.planes[0].surface.rolling, 0.5);
  EXPECT_EQ(back.planes[0].filter, Filter{});
  EXPECT_EQ(back.planes[0].motion.platform, 1u);
  EXPECT_EQ(back.planes[0].motion.belt, scene.planes[0].motion.belt);
  EXPECT_EQ(back.boxes[0].filter, scene.boxes[0].filter);
  EXPECT_EQ(back.boxes[0].motion.platform, 0u);
  EXPECT_EQ(back.boxes[0].motion.belt, Vec3{});
  EXPECT_EQ(back.platforms, scene.platforms);
}

std::string message_of_plane(const std::string& rest) {
  try {
    scenes::parse_scene(
        R"({"plumb": 1, "particles": [], "rods": [], "planes": [{"normal": [0, 1, 0], )" + rest + "}]}", "f");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(SceneFile, RefusesNumbersThatAreNotWhole) {
  EXPECT_EQ(message_of_plane(R"("mask": 0.5)"),
            "f: planes[0].mask must be a whole number from 0 to 4294967295");
  EXPECT_EQ(message_of_plane(R"("category": -1)"),
            "f: planes[0].category must be a whole number from 0 to 4294967295");
  EXPECT_EQ(message_of_plane(R"("group": 3e9)"),
            "f: planes[0].group must be a whole number from -2147483648 to 2147483647");
  EXPECT_EQ(message_of_plane(R"("platform": 0)"),
            "f: plane 0: platform 0 does not exist (the scene has 0 platforms)");
}

std::string refusal_after(const std::function<void(Scene&)>& change) {
  Scene scene = scene_with_all();
  change(scene);
  try {
    validate(scene);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Validate, RefusesWhatNoSurfaceAndNoPlatformHas) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(refusal_after([](Scene&) {}), "");
  EXPECT_EQ(refusal_after([](Scene& s) { s.capsules[0].surface.rolling = -1; }),
            "capsule 0: rolling must be finite and not negative, got -1 m");
  EXPECT_EQ(refusal_after([](Scene& s) { s.boxes[0].surface.spinning = infinity; }),
            "box 0: spinning must be finite and not negative, got inf m");
  EXPECT_EQ(refusal_after([](Scene& s) { s.boxes[0].motion.platform = 2; }),
            "box 0: platform 2 does not exist (the scene has 2 platforms)");
  EXPECT_EQ(refusal_after([](Scene& s) { s.planes[0].motion.belt.x = infinity; }),
            "plane 0: belt is not finite");
  EXPECT_EQ(refusal_after([](Scene& s) { s.platforms[0].position.y = infinity; }),
            "platform 0: position is not finite");
  EXPECT_EQ(refusal_after([](Scene& s) {
              s.platforms[1].orientation = {2, 0, 0, 0};
            }),
            "platform 1: orientation must be a quaternion of length 1, not 2");
}

TEST(World, RefusesToMoveAPlatformWhereNoneCanBe) {
  World world(scene_with_all(), test::body_settings());
  EXPECT_THROW(world.move_platform(2, {}), InputError);
  EXPECT_THROW(static_cast<void>(world.platform(2)), InputError);
  EXPECT_THROW(world.move_platform(0, {.orientation = {}}), InputError);
  EXPECT_EQ(world.platform(1), scene_with_all().platforms[1]);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
