#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include "plumb/plumb.hpp"
#include "support/worlds.hpp"

/// What tests of snapshots ask for.
namespace plumb::test {

using Snapshot = std::vector<std::byte>;

inline Snapshot snapshot_of(const World& world) {
  Snapshot out(world.snapshot_size());
  out.resize(world.save(out));
  return out;
}

/// What a player does before a frame: everything that a scene lets a program do, by numbers that the frame
/// and a seed alone decide.
class Player {
 public:
  Player(const Scene& scene, std::uint32_t seed) : scene_(scene), seed_(seed) {}

  void act(World& world, std::uint32_t frames) const {
    try {
      if (edits_) edit(world, frames);
      if (adds_) add_or_remove(world, frames);
      play(world, frames);
      if (scene_.reels.empty()) pull(world, frames);
    } catch (const InputError&) {
      if (!edits_ && !adds_)
        throw;  // else it is of a particle that was fixed, freed or removed, for every world alike
    }
  }

  Player& with_winch(std::uint32_t rod) {
    winch_ = rod;
    return *this;
  }
  Player& with_rules() {
    changes_rules_ = true;
    return *this;
  }
  Player& with_edits() {
    edits_ = true;
    return *this;
  }

  /// Ropes come and go, too.
  Player& with_additions() {
    adds_ = true;
    return *this;
  }

 private:
  /// Grabs a particle now and then, moves what is grabbed, and lets all go. Which grabs there are the world
  /// alone knows, so that a player who goes back needs no memory.
  void pull(World& world, std::uint32_t frames) const {
    std::vector<Handle<Grab>> grabs;
    constexpr std::uint32_t most_grabs = 3, latest = 99;
    for (std::uint32_t number = 0; number < most_grabs; ++number)
      for (std::uint32_t generation = 1; generation <= latest; generation += 2)
        if (const Handle<Grab> grab{number, generation}; world.has(grab)) grabs.push_back(grab);
    std::seed_seq seeds{seed_, frames, 3u};
    std::mt19937 random(seeds);
    const auto particle = static_cast<std::uint32_t>(random() % scene_.particles.size());
    const double stiffness = std::array{1e2, 1e3, 1e4}[random() % 3];
    const Vec3 way{0.01 * (random() % 5), 0.01 * (random() % 5), 0.01};
    if (frames % 13 == 9)
      for (const Handle<Grab> grab : grabs) world.release(grab);
    if (frames % 4 == 2 && grabs.size() < most_grabs && frames % 13 != 9 && !scene_.particles[particle].fixed)
      world.grab(Grab::particle(particle, world.position(particle), stiffness, 0.01 * stiffness));
    if (frames % 13 < 7)
      for (const Handle<Grab> grab : grabs) world.move_grab(grab, world.position(particle) + way);
  }

  void add_or_remove(World& world, std::uint32_t frames) const {
    std::seed_seq seeds{seed_, frames, 2u};
    std::mt19937 random(seeds);
    const auto pick = [&](std::size_t count) { return static_cast<std::uint32_t>(random() % count); };
    if (frames % 3 != 2) {
      Scene rope;
      const std::uint32_t rods = 2 + pick(4);
      rope.particles.push_back({.position = {0.1 * pick(20), 3, 0}, .fixed = true});
      for (std::uint32_t i = 0; i < rods; ++i) {
        const Vec3 way{0.06, -0.08, 0};
        rope.particles.push_back({.position = rope.particles.back().position + way, .mass = 1.0 + pick(3)});
        rope.rods.push_back({.a = i, .b = i + 1, .law = {.strength = 60.0 + pick(60)}});
      }
      world.add(rope);
    }
    for (int i = 0; i < 2; ++i)
      if (const std::uint32_t particle = pick(world.particle_count()); world.handle<Particle>(particle))
        world.remove(particle);
  }

  void edit(World& world, std::uint32_t frames) const {
    std::seed_seq seeds{seed_, frames, 1u};
    std::mt19937 random(seeds);
    const auto pick = [&](std::size_t count) { return static_cast<std::uint32_t>(random() % count); };
    if (frames % 3 == 0) world.cut(pick(scene_.rods.size()));
    if (frames % 7 == 3)
      world.join(
          {.a = pick(scene_.particles.size()), .b = pick(scene_.particles.size()), .law = {.strength = 90}});
    if (frames % 5 == 1) world.set_mass(pick(scene_.particles.size()), 0.5 + 0.1 * pick(10));
    if (frames % 9 == 2) world.set_gravity({0.1 * pick(10), -9.0 - 0.1 * pick(10), 0});
    if (!scene_.bends.empty()) return;
    if (frames % 4 == 1) world.fix(pick(scene_.particles.size()));
    if (frames % 4 == 3) world.free(pick(scene_.particles.size()));
    if (frames % 6 != 4) return;
    const std::uint32_t particle = pick(scene_.particles.size());
    const Vec3 x = world.position(particle), v = 0.5 * world.velocity(particle);
    world.teleport({&particle, 1}, {&x, 1}, {&v, 1});
  }

  void play(World& world, std::uint32_t frames) const {
    std::seed_seq seeds{seed_, frames};
    std::mt19937 random(seeds);
    const auto number = [&] { return static_cast<double>(random()) / 4294967296.0 - 0.5; };
    const auto vector = [&] { return Vec3{number(), number(), number()}; };
    const auto pick = [&](std::size_t count) { return static_cast<std::uint32_t>(random() % count); };
    const bool is_quiet = frames % 16 >= 12;
    const auto particle = pick(scene_.particles.size());
    const Vec3 way = vector();
    if (is_quiet) return;
    const Particle& of = scene_.particles[particle];
    if (of.fixed)
      world.move_anchor(particle, of.position + 0.05 * way);
    else if (frames % 4 == 0)
      world.set_force(particle, frames % 8 == 0 ? 4 * way : Vec3{});
    if (!scene_.platforms.empty()) {
      const auto platform = pick(scene_.platforms.size());
      Pose pose = world.platform(platform);
      pose.position += 0.02 * vector();
      world.move_platform(platform, pose);
    }
    if (!scene_.reels.empty()) world.set_reel(0, world.reel_out(0) * (0.99 + 0.02 * number()));
    if (!scene_.tackles.empty()) world.set_tackle_length(0, tackle_length(scene_, 0) * (1 + 0.02 * number()));
    if (!scene_.twists.empty()) world.set_twist(0, 2 * number());
    if (!scene_.springs.empty()) {
      const auto i = pick(scene_.springs.size());
      Spring spring = scene_.springs[i];
      if (spring.length > 0) spring.length *= 1 + 0.2 * number();
      world.set_spring(i, spring);
    }
    if (!scene_.torsions.empty()) {
      Torsion torsion = scene_.torsions[0];
      torsion.angle += number();
      world.set_torsion(0, torsion);
    }
    if (!scene_.angles.empty()) {
      const auto i = pick(scene_.angles.size());
      AngleControl angle = scene_.angles[i];
      angle.friction += 0.1 + 0.1 * number();
      world.set_angle(i, angle);
    }
    if (winch_) world.set_length(*winch_, rod_length(scene_, *winch_) * (1 + 0.1 * number()));
    if (changes_rules_ && frames % 8 == 1) {
      world.set_stop_rule({.sweeps = 5 + pick(20)});
      world.set_weights(pick(2) == 0 ? Weights::equal : Weights::mass);
    }
  }

  const Scene& scene_;
  std::uint32_t seed_;
  std::optional<std::uint32_t> winch_{};
  bool changes_rules_ = false, edits_ = false, adds_ = false;
};

}  // namespace plumb::test
