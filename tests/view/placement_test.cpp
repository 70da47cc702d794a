// Colours and lanes that the page shows are those that worlds report.
#include "view/exhibit/placement.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <utility>

#include "plumb/layouts/aligned_buffer.hpp"
#include "plumb/world.hpp"
#include "scenes/spec.hpp"

namespace plumb::view::PLUMB_TEST_FILE {
namespace {

std::uint32_t count(const std::vector<std::uint32_t>& places) {
  std::uint32_t out = 0;
  for (const std::uint32_t place : places)
    if (place != no_place) out = std::max(out, place + 1);
  return out;
}

TEST(ViewPlacement, HasTheColoursOfTheWorld) {
  for (const char* name : {"chain:links=20", "net:width=24,height=24", "ensemble:chains=40,links=6",
                           "ring:links=9", "graph:particles=60", "truss:bays=4"}) {
    const Scene scene = scenes::load_scene(name);
    const Placement placement = place_rods(scene);
    const World world(scene, {.method = Method::relax});
    std::uint32_t colors = 0;
    for (const BlockInfo& block : world.info().blocks) colors = std::max(colors, block.colors);
    EXPECT_EQ(count(placement.color_of_rod), colors) << name;
    EXPECT_LE(count(placement.lane_of_rod), layouts::lane_width<float>) << name;
    EXPECT_GT(count(placement.lane_of_rod), 1U) << name;
  }
}

TEST(ViewPlacement, RodsOfOneColourShareNoMovableParticle) {
  const Scene scene = scenes::load_scene("net:width=24,height=24");
  const Placement placement = place_rods(scene);
  std::set<std::pair<std::uint32_t, std::uint32_t>> seen;
  for (std::size_t i = 0; i < scene.rods.size(); ++i)
    for (const std::uint32_t end : {scene.rods[i].a, scene.rods[i].b}) {
      if (!scene.particles[end].fixed) {
        EXPECT_TRUE(seen.insert({end, placement.color_of_rod[i]}).second) << "rod " << i;
      }
    }
}

TEST(ViewPlacement, EqualIslandsLieSideBySide) {
  const Scene scene = scenes::load_scene("ensemble:chains=32,links=6");
  const Placement placement = place_rods(scene);
  for (std::size_t rod = 0; rod < scene.rods.size(); ++rod)
    EXPECT_EQ(placement.lane_of_rod[rod], rod / 6 % layouts::lane_width<float>) << rod;
}

TEST(ViewPlacement, RodsBetweenAnchorsHaveNone) {
  Scene scene = scenes::load_scene("chain:links=4");
  scene.particles[1].fixed = true;
  const Placement placement = place_rods(scene);
  EXPECT_EQ(placement.color_of_rod[0], no_place);
  EXPECT_EQ(placement.lane_of_rod[0], no_place);
  EXPECT_NE(placement.color_of_rod[1], no_place);
}

}  // namespace
}  // namespace plumb::view::PLUMB_TEST_FILE
