// Kinds of islands keep what they are made of: named in a scene that is shared, or as edits made it.

#include "contact/edits/kept_part.hpp"

#include <gtest/gtest.h>

#include <memory>

#include "contact/linkage/scene_parts.hpp"
#include "scene/lists/digest.hpp"
#include "scenes/spec.hpp"
#include "support/worlds.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

std::uint64_t digest_of(const Scene& part) {
  Digest digest;
  for_lists([&](std::size_t, const auto& list) { digest(list); }, part);
  return digest.value();
}

/// Two figures and a rope, of which the particles are told in another order than they lie in.
std::shared_ptr<const Scene> crowd() {
  Scene scene = scenes::load_scene("crowd:humanoids=2,hit=1");
  const auto first = static_cast<std::uint32_t>(scene.particles.size());
  scene.particles.push_back(test::movable({0, 5, 0}));
  scene.particles.push_back(test::fixed({2, 5, 0}));
  scene.particles.push_back(test::movable({1, 5, 0}));
  scene.rods.push_back({.a = first + 1, .b = first + 2, .mass = 2});
  scene.rods.push_back({.a = first + 2, .b = first, .mass = 1});
  scene.bends.push_back({.a = first + 1, .b = first + 2, .c = first, .stiffness = 1});
  return std::make_shared<const Scene>(std::move(scene));
}

// Every part that is named is the one that was cut out, to the last bit, whoever keeps the scene.
TEST(KeptPart, IsThatOfTheSceneThatItNames) {
  std::shared_ptr<const Scene> scene = crowd();
  const SceneParts parts(*scene);
  ASSERT_GE(parts.count(), 3u);
  for (std::uint32_t p = 0; p < parts.count(); ++p) {
    const KeptPart named(scene, parts.names(p), false), own(parts.part(p));
    EXPECT_EQ(digest_of(named.scene()), digest_of(parts.part(p)));
    EXPECT_EQ(digest_of(own.scene()), digest_of(parts.part(p)));
    EXPECT_TRUE(named.stands_like(parts.part(p)));
    for (std::uint32_t i = 0; i < parts.part(p).rods.size(); ++i) {
      EXPECT_EQ(named.rod_length(i), own.rod_length(i));
      EXPECT_EQ(named.rod(i).law, own.rod(i).law);
      EXPECT_EQ(named.is_of_body(i), own.is_of_body(i));
      EXPECT_EQ(named.bends(i), own.bends(i));
    }
  }
}

// The ends of rods have their mass where it is lumped, as in the part that the kind was made of.
TEST(KeptPart, LumpsMassesAsItsKindDid) {
  const std::shared_ptr<const Scene> scene = crowd();
  const SceneParts parts(*scene);
  Scene rope = parts.part(parts.count() - 1);
  const KeptPart kept(scene, parts.names(parts.count() - 1), true);
  EXPECT_NE(digest_of(kept.scene()), digest_of(rope));
  lump_masses(rope);
  EXPECT_EQ(digest_of(kept.scene()), digest_of(rope));
  EXPECT_TRUE(kept.bends(0) && kept.bends(1));
  EXPECT_FALSE(kept.is_of_body(0));
  rope.particles[0].position.x += 1e-12;
  EXPECT_FALSE(kept.stands_like(rope));
}

// Slots of places that nobody reads may hold anything.
TEST(KeptPart, ReadsNoSlotWithoutAWeight) {
  Scene scene;
  scene.particles = {test::movable({0, 0, 0}), test::movable({1, 0, 0})};
  scene.rods = {{.a = 0, .b = 1}};
  scene.capsules = {
      {.a = {{1, 0xffffffff, 7, 0}, {1, 0, 0, 0}}, .b = {{0, 1, 1, 1}, {1, 0, 0, 0}}, .radius = 0.1}};
  const Scene part = SceneParts(scene).part(0);
  EXPECT_EQ(part.capsules[0].a.particles[0], 1u);
  EXPECT_EQ(part.capsules[0].b.particles[0], 0u);
  for (const std::uint32_t particle : part.capsules[0].a.particles) EXPECT_LT(particle, 2u);
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
