#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "plumb/plumb.hpp"
#include "scenes/generators/generators.hpp"
#include "step/state/step_log.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr double frame = 1.0 / 60;

/// Lines that a world told, warnings with a mark.
struct Lines {
  std::vector<std::string> all;
  Log log() {
    return [this](LogLevel level, std::string_view line) {
      all.push_back((level == LogLevel::warning ? "! " : "") + std::string(line));
    };
  }
  bool has(const std::string& what) const {
    for (const std::string& line : all)
      if (line.find(what) != std::string::npos) return true;
    return false;
  }
};

TEST(WorldLog, SaysHowASceneWasCompiled) {
  World world(scenes::make_chain(20), {.threads = 1});
  Lines lines;
  world.set_log(lines.log());
  ASSERT_EQ(lines.all.size(), 1u);
  EXPECT_TRUE(lines.has("particles: 21, rods: 20 (relaxed: 0, solved: 20), islands: 1")) << lines.all[0];
  test::run(world, frame, 10);
  EXPECT_EQ(lines.all.size(), 1u);  // nothing went wrong
}

// An anchor goes farther than the chain is long, and comes back. Rods give in between.
TEST(WorldLog, SaysWhenTroublesBeginAndEnd) {
  Scene scene = scenes::make_chain(4);
  scene.particles.back().fixed = true;
  World world(scene, {.threads = 1});
  Lines lines;
  world.set_log(lines.log());
  const Vec3 home = world.position(4);
  world.move_anchor(4, home + Vec3{0.1, 0, 0});
  test::run(world, frame, 10);
  EXPECT_TRUE(lines.has("! 0.0")) << testing::PrintToString(lines.all);
  EXPECT_TRUE(lines.has("rods at their lengths, which give (particle 1)"))
      << testing::PrintToString(lines.all);
  EXPECT_EQ(lines.all.size(), 2u);  // once, not in every step
  world.move_anchor(4, home - Vec3{0.1, 0, 0});
  test::run(world, frame, 10);
  EXPECT_TRUE(lines.has("rods keep their lengths again")) << testing::PrintToString(lines.all);
  EXPECT_EQ(lines.all.size(), 3u);
  world.set_log({});
  world.move_anchor(4, home + Vec3{0.1, 0, 0});
  test::run(world, frame, 10);
  EXPECT_EQ(lines.all.size(), 3u);
}

TEST(WorldLog, SaysThatRodsBroke) {
  Scene scene = scenes::make_chain(4);
  for (Rod& rod : scene.rods) rod.law.strength = 1;
  World world(scene, {.threads = 1});
  Lines lines;
  world.set_log(lines.log());
  test::run(world, frame, 30);
  EXPECT_TRUE(lines.has("broke")) << testing::PrintToString(lines.all);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
