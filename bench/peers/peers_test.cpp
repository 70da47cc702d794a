#include "frontier/peers.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <set>
#include <string>

#include "links.hpp"
#include "peer.hpp"
#include "plumb/error.hpp"

namespace plumb::bench {
namespace {

/// Makes a fixed particle with a chain of three, the last of which has a branch. Rods are drawn either way
/// round.
Scene branched() {
  Scene scene;
  scene.particles = {{.position = {2, 0, 0}, .mass = 3},
                     {.position = {0, 0, 0}, .fixed = true},
                     {.position = {1, 0, 0}, .mass = 2},
                     {.position = {2, 1, 0}, .mass = 4}};
  scene.rods = {{.a = 2, .b = 0}, {.a = 1, .b = 2}, {.a = 3, .b = 2}};
  return scene;
}

TEST(Links, ComeParentsFirst) {
  const std::vector<Link> links = find_links(branched());
  ASSERT_EQ(links.size(), 3u);
  EXPECT_EQ(links[0].particle, 2u);
  EXPECT_EQ(links[0].from, 1u);
  EXPECT_EQ(links[0].parent, Link::none);
  for (const std::size_t i : {1u, 2u}) {
    EXPECT_EQ(links[i].from, 2u);
    EXPECT_EQ(links[i].parent, 0);
    EXPECT_EQ(links[i].root, 1u);
  }
  EXPECT_EQ(links[1].particle, 0u);
  EXPECT_EQ(links[1].mass, 3);
  EXPECT_EQ(links[2].offset.y, 1);
}

TEST(Links, AreRefusedWhereTheModelsWouldBeOthers) {
  EXPECT_TRUE(has_links(branched()));
  Scene loop = branched();
  loop.rods.push_back({.a = 0, .b = 3});
  EXPECT_FALSE(has_links(loop));
  Scene held_twice = branched();
  held_twice.particles[3].fixed = true;
  EXPECT_FALSE(has_links(held_twice));
  Scene heavy = branched();
  heavy.rods[0].mass = 1;
  EXPECT_FALSE(has_links(heavy));
  Scene afloat = branched();
  afloat.particles[1] = {.mass = 1};
  EXPECT_FALSE(has_links(afloat));
  Scene moving = branched();
  moving.particles[0].velocity = {0, 0, 1};
  EXPECT_FALSE(has_links(moving));
  Scene dragged = branched();
  dragged.drag = 1;
  EXPECT_FALSE(has_links(dragged));
  Scene given_length = branched();
  given_length.rods[0].length = 2;
  EXPECT_THROW(find_links(given_length), InputError);
}

/// A tree tries what a chain does not: bodies in another order than the scene's particles. All libraries
/// start where the scene does, and their centres of mass accelerate alike. After a hundredth of a second of
/// steps of first order and more, positions agree to much less than the 0.5 mm they have fallen.
TEST(Peers, MoveATreeAlike) {
  const Scene scene = branched();
  const std::vector<Link> links = find_links(scene);
  const Model model{.scene = scene, .links = links, .duration = 1.0 / frames_per_second};
  std::vector<std::pair<std::string, Frame>> ends;
  for (const PeerFamily& family : all_peers()) {
    Frame frame;
    for (const Particle& particle : scene.particles) frame.positions.push_back(particle.position);
    frame.velocities.resize(scene.particles.size());
    // Steps are fine here. The accuracies of the last path are fine at half its levels.
    const PeerPath& path = family.paths.back();
    const auto peer = path.make(model, 9);
    peer->copy_state(frame);
    for (std::size_t i = 0; i < scene.particles.size(); ++i)
      EXPECT_LT(norm(frame.positions[i] - scene.particles[i].position), 1e-12) << family.name << " " << i;
    peer->step_frame();
    peer->copy_state(frame);
    ends.emplace_back(family.name, frame);
  }
  for (const auto& [name, frame] : ends)
    for (std::size_t i = 0; i < scene.particles.size(); ++i) {
      EXPECT_LT(norm(frame.positions[i] - ends[0].second.positions[i]), 1e-5) << name << " " << i;
      EXPECT_LT(norm(frame.velocities[i] - ends[0].second.velocities[i]), 1e-3) << name << " " << i;
    }
}

/// The file that bench_peers has written holds every family it was built with, and numbers that can be.
TEST(File, IsReadBack) {
  const char* file = std::getenv("PLUMB_PEERS_CSV");
  if (!file) GTEST_SKIP() << "PLUMB_PEERS_CSV names no file";
  const auto points = frontier::read_points(file);
  std::set<std::string> families;
  for (const auto& [scene, point] : points) {
    EXPECT_EQ(scene, "N5_r1");
    EXPECT_GT(point.ms, 0);
    EXPECT_LE(point.ms, point.median_ms);
    EXPECT_LE(point.stretch, 1);
    families.insert(point.family);
  }
  for (const PeerFamily& family : all_peers()) EXPECT_EQ(families.count(family.name), 1u) << family.name;
}

}  // namespace
}  // namespace plumb::bench
