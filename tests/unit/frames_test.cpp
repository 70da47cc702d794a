// Positions between steps, in layouts of the caller's, and which of them moved.

#include "plumb/embedding/frames.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "plumb/plumb.hpp"
#include "scenes/spec.hpp"
#include "support/refusals.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::refusal;

/// A vertex as a program has it.
struct Vertex {
  float u = 7, x = 0, y = 0, z = 0, v = 8;
};

TEST(Frames, AreThoseOfTheLastTwoSteps) {
  World world(scenes::load_scene("ensemble:chains=7,links=5"));
  Frames frames;
  frames.update(world);
  std::vector<Vec3> first(world.particle_count()), second(first.size());
  world.copy_positions(first);
  EXPECT_EQ(frames.moved().size(), 1u);
  EXPECT_EQ(frames.moved()[0], (ParticleRange{0, world.particle_count()}));
  world.step(1.0 / 60);
  world.copy_positions(second);
  frames.update(world);

  std::vector<Vertex> vertices(first.size());
  const StridedVectors<float> out{&vertices[0].x, vertices.size(), sizeof(Vertex)};
  std::vector<double> numbers(3 * first.size());
  const StridedVectors<double> dense{numbers.data(), first.size()};
  for (const double share : {0.0, 0.25, 1.0, 1.5}) {
    frames.copy(out, share);
    frames.copy(dense, share);
    for (std::size_t i = 0; i < first.size(); ++i) {
      const Vec3 wanted = share == 0   ? first[i]
                          : share == 1 ? second[i]
                                       : first[i] + share * (second[i] - first[i]);
      // Rounding of two products and sums of numbers below 10; none at the ends.
      const double tolerance = share == 0 || share == 1 ? 0 : 1e-14;
      EXPECT_NEAR(numbers[3 * i + 1], wanted.y, tolerance);
      EXPECT_EQ(vertices[i].x, static_cast<float>(numbers[3 * i]));
      EXPECT_EQ(vertices[i].y, static_cast<float>(numbers[3 * i + 1]));
      EXPECT_EQ(vertices[i].z, static_cast<float>(numbers[3 * i + 2]));
      EXPECT_EQ(vertices[i].u, 7);
      EXPECT_EQ(vertices[i].v, 8);
    }
  }
}

TEST(Frames, ListWhatMovedAndWriteNothingElse) {
  Scene scene =
      scenes::load_scene("ensemble:chains=3,links=4");  // 5 particles each, the first of which is fixed
  for (const std::uint32_t i : {0u, 1u, 2u, 3u, 4u, 10u, 11u, 12u, 13u, 14u})
    scene.particles[i].asleep = true;
  World world(scene);
  Frames frames;
  frames.update(world);
  world.step(1.0 / 60);
  frames.update(world);
  ASSERT_EQ(frames.moved().size(), 1u);
  EXPECT_EQ(frames.moved()[0], (ParticleRange{6, 4}));
  std::vector<double> numbers(3 * 15, -5);
  frames.copy_moved(StridedVectors<double>{numbers.data(), 15});
  for (std::uint32_t i = 0; i < 15; ++i)
    EXPECT_EQ(numbers[3 * i], i >= 6 && i < 10 ? world.position(i).x : -5) << i;
  frames.update(world);
  EXPECT_TRUE(frames.moved().empty());
}

TEST(Frames, TakeNewParticles) {
  World world(scenes::load_scene("chain:links=3"));
  Frames frames;
  frames.update(world);
  frames.update(world);
  world.add(scenes::load_scene("chain:links=3"));
  frames.update(world);
  ASSERT_EQ(frames.moved().size(), 1u);
  EXPECT_EQ(frames.moved()[0], (ParticleRange{4, 4}));
  EXPECT_EQ(frames.before()[6], world.position(6));
}

/// Returns a scene 20 m aside.
Scene moved_aside(Scene scene) {
  for (Particle& particle : scene.particles) particle.position += {20, 0, 0};
  return scene;
}

void go_on(World& world, Frames& frames) {
  world.step(1.0 / 60);
  frames.update(world);
}

// A number that another particle had leads from nowhere else to where the new one is.
TEST(Frames, TakeParticlesThatGetTheNumbersOfOthers) {
  const Scene scene = scenes::load_scene("chain:links=3");
  Scene other = moved_aside(scene);
  for (const int steps_between : {0, 1, 3}) {
    World world(scene);
    world.add(other);
    Frames frames;
    const auto step = [&] { go_on(world, frames); };
    step();
    world.remove(2);
    for (int i = 0; i < steps_between; ++i) {
      step();
      EXPECT_EQ(frames.before()[2], Vec3{}) << "what is gone was where it is";
    }
    other.particles[1].position.y += 1e-3;
    ASSERT_EQ(world.add(other).particle, 0u);
    step();
    for (std::uint32_t i = 0; i < 4; ++i) EXPECT_EQ(frames.before()[i], world.position(i)) << i;
    EXPECT_EQ(frames.moved()[0].first, 0u);
    EXPECT_NE(frames.before()[6], world.position(6)) << "others keep what they had";
  }
}

// What is teleported is nowhere on the way. It goes along lines again from then on.
TEST(Frames, LetWhatIsTeleportedJump) {
  const Scene scene = scenes::load_scene("chain:links=3");
  World world(scene);
  world.add(moved_aside(scene));
  Frames frames;
  const auto step = [&] { go_on(world, frames); };
  step();
  step();
  const std::vector<std::uint32_t> particles{4, 5, 6, 7};
  std::vector<Vec3> to, velocities(4);
  for (const std::uint32_t particle : particles) to.push_back(world.position(particle) + Vec3{0, 3, 0});
  world.teleport(particles, to, velocities);
  step();
  for (const std::uint32_t particle : particles)
    EXPECT_EQ(frames.before()[particle], world.position(particle));
  EXPECT_NE(frames.before()[2], world.position(2)) << "others keep what they had";
  EXPECT_EQ(frames.moved().back(), (ParticleRange{1, 7}));
  const std::vector<Vec3> jumped(frames.positions().begin(), frames.positions().end());
  step();
  for (const std::uint32_t particle : particles) EXPECT_EQ(frames.before()[particle], jumped[particle]);
  EXPECT_NE(frames.before()[7], world.position(7));
}

TEST(Frames, RefuseWhatDoesNotFit) {
  World world(scenes::load_scene("chain:links=3"));
  Frames frames;
  frames.update(world);
  std::vector<float> numbers(12, 3);
  EXPECT_NE(refusal([&] { frames.copy(StridedVectors<float>{numbers.data(), 3}); }), "");
  EXPECT_NE(refusal([&] { frames.copy(StridedVectors<float>{numbers.data(), 4, 8}); }), "");
  EXPECT_NE(refusal([&] { frames.copy(StridedVectors<float>{numbers.data(), 4, 13}); }), "");
  EXPECT_NE(refusal([&] { frames.copy(StridedVectors<float>{numbers.data(), 4}, std::nan("")); }), "");
  EXPECT_EQ(numbers, std::vector<float>(12, 3));
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
