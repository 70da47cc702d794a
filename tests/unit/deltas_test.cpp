// Deltas lead from a base to a snapshot bit for bit, are small where worlds sleep, and are refused with a
// reason.

#include "plumb/embedding/deltas.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "plumb/plumb.hpp"
#include "scenes/spec.hpp"
#include "step/snapshot/fingerprint.hpp"
#include "step/snapshot/header.hpp"
#include "support/refusals.hpp"
#include "support/snapshots.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::refusal;
using Bytes = std::vector<std::byte>;

constexpr std::size_t header_size = 64;

Bytes saved(const World& world) {
  Bytes out(world.snapshot_size());
  world.save(out);
  return out;
}

Bytes delta_between(const Bytes& base, const Bytes& now) {
  Bytes out(most_delta_size(now.size()));
  const std::size_t size = save_delta(base, now, out);
  EXPECT_EQ(size, delta_size(base, now));
  EXPECT_LE(size, out.size());
  out.resize(size);
  return out;
}

Bytes restored(const Bytes& base, const Bytes& delta) {
  Bytes out(restored_size(delta));
  EXPECT_EQ(restore_delta(base, delta, out), out.size());
  return out;
}

/// Makes a snapshot of bytes without meaning, which nothing but deltas can read.
Bytes snapshot_of(Bytes body) {
  Bytes out(sizeof(detail::Header) + body.size());
  std::copy(body.begin(), body.end(), out.begin() + sizeof(detail::Header));
  detail::write_header(detail::Header{.size = out.size()}, out, [&](std::span<const std::byte> own) {
    return detail::sum_of(std::span(out).subspan(sizeof(detail::Header)), own);
  });
  return out;
}

TEST(Deltas, LeadToTheSameSnapshotAndTheSameFuture) {
  for (const char* const name : {"chain:links=20,end_mass=10", "ensemble:chains=20,links=8", "rope",
                                 "heap:ropes=3,links=6", "crowd:humanoids=2,hit=1"}) {
    World world(scenes::load_scene(name), {.contacts = true, .events = true, .threads = 1});
    const Bytes base = saved(world);
    for (int frame = 0; frame < 30; ++frame) {
      world.step(1.0 / 60);
      const Bytes now = saved(world), delta = delta_between(base, now);
      ASSERT_EQ(restored(base, delta), now) << name << ' ' << frame;
    }
    const Bytes delta = delta_between(base, saved(world));
    world.step(1.0 / 60);
    const std::uint64_t hash = world.state_hash();
    for (int frame = 0; frame < 5; ++frame) world.step(1.0 / 60);
    world.restore(restored(base, delta));
    world.step(1.0 / 60);
    EXPECT_EQ(world.state_hash(), hash) << name;
  }
}

// As netcode does it: a whole snapshot every eight frames and deltas in between, and each goes on as the
// world did.
TEST(Deltas, RollBackAsSnapshotsDo) {
  for (const char* const name :
       {"ensemble:chains=6,links=8", "crowd:humanoids=2,hit=1", "net:width=5,height=4"}) {
    const Scene scene = scenes::load_scene(name);
    const test::Player player(scene, 7);
    World world(scene, {.threads = 1});
    Bytes base;
    std::vector<Bytes> deltas;
    std::vector<std::uint64_t> hashes;
    const auto play = [&](std::uint32_t frame) {
      player.act(world, frame);
      world.step(1.0 / 60);
      return world.state_hash();
    };
    for (std::uint32_t frame = 0; frame < 24; ++frame) {
      if (frame % 8 == 0) {
        base = saved(world);
        deltas.clear();
        hashes.clear();
      }
      deltas.push_back(delta_between(base, saved(world)));
      hashes.push_back(play(frame));
      const std::size_t back = frame % 3 % deltas.size(), from = deltas.size() - 1 - back;
      world.restore(restored(base, deltas[from]));
      for (std::size_t k = from; k < deltas.size(); ++k)
        ASSERT_EQ(play(frame - static_cast<std::uint32_t>(deltas.size() - 1 - k)), hashes[k])
            << name << ' ' << frame;
    }
  }
}

TEST(Deltas, OfWhatSleepsTakeNextToNothing) {
  Scene scene = scenes::load_scene("ensemble:chains=200,links=8");
  for (std::uint32_t i = 9; i < scene.particles.size(); ++i) scene.particles[i].asleep = true;
  World world(scene);
  world.step(1.0 / 60);
  const Bytes base = saved(world);
  for (int frame = 0; frame < 10; ++frame) world.step(1.0 / 60);
  const Bytes now = saved(world);
  EXPECT_NE(now, base);
  // One of 200 ropes moves.
  EXPECT_LT(delta_between(base, now).size(), now.size() / 40);
  EXPECT_EQ(delta_between(now, now).size(), header_size + 8 + now.size() % 8);
}

TEST(Deltas, FindWhatMovedWithinASnapshot) {
  std::mt19937 random(1);
  Bytes body(20'000);
  for (std::byte& each : body) each = static_cast<std::byte>(random());
  const Bytes base = snapshot_of(body);
  for (const std::size_t more : {1u, 8u, 100u}) {
    Bytes longer = body, shorter = body;
    longer.insert(longer.begin() + 7001, more, std::byte{5});
    shorter.erase(shorter.begin() + 7001, shorter.begin() + 7001 + static_cast<std::ptrdiff_t>(more));
    for (const Bytes& each : {longer, shorter}) {
      const Bytes now = snapshot_of(each), delta = delta_between(base, now);
      EXPECT_EQ(restored(base, delta), now);
      // The two headers, what is new, and words that a cut goes through.
      EXPECT_LT(delta.size(), header_size + sizeof(detail::Header) + more + 64);
    }
  }
}

TEST(Deltas, OfRandomChangesAreRight) {
  std::mt19937 random(2);
  for (int trial = 0; trial < 300; ++trial) {
    Bytes body(random() % 700);
    for (std::byte& each : body) each = static_cast<std::byte>(random() % 3);
    Bytes other = body;
    other.resize(trial % 3 == 0 ? body.size() : random() % 700);
    for (std::size_t changes = random() % 40; changes > 0 && !other.empty(); --changes)
      other[random() % other.size()] = static_cast<std::byte>(random());
    const Bytes base = snapshot_of(body), now = snapshot_of(other);
    ASSERT_EQ(restored(base, delta_between(base, now)), now) << trial;
  }
}

TEST(Deltas, AreRefusedWithTheReasonAndWriteNothing) {
  World world(scenes::load_scene("chain:links=20"));
  const Bytes base = saved(world);
  world.step(1.0 / 60);
  const Bytes now = saved(world), delta = delta_between(base, now);
  const Bytes untouched(now.size(), std::byte{0x5a});
  Bytes out = untouched;
  const auto refused = [&](const Bytes& from, const Bytes& by) {
    const std::string reason = refusal([&] { restore_delta(from, by, out); });
    EXPECT_EQ(out, untouched);
    return reason;
  };
  EXPECT_NE(refused(now, delta).find("another snapshot"), std::string::npos);
  EXPECT_NE(refused(delta, delta).find("does not begin as a snapshot"), std::string::npos);
  EXPECT_NE(refused(base, now).find("does not begin as one"), std::string::npos);
  for (std::size_t size = 0; size < delta.size(); ++size)
    ASSERT_NE(refused(base, Bytes(delta.begin(), delta.begin() + static_cast<std::ptrdiff_t>(size))), "");
  for (std::size_t i = 0; i < delta.size(); ++i) {
    Bytes damaged = delta;
    damaged[i] ^= std::byte{1};
    ASSERT_NE(refused(base, damaged), "") << i;
  }
  out.pop_back();
  EXPECT_NE(refusal([&] { restore_delta(base, delta, out); }).find("do not fit"), std::string::npos);
  Bytes small(delta.size() - 1, std::byte{7});
  EXPECT_NE(refusal([&] { save_delta(base, now, small); }).find("does not fit"), std::string::npos);
  EXPECT_EQ(small, Bytes(delta.size() - 1, std::byte{7}));
}

// A base that was damaged since gives a snapshot whose sum is wrong, which worlds refuse.
TEST(Deltas, OfDamagedBasesLeaveWorldsAsTheyAre) {
  World world(scenes::load_scene("chain:links=20"));
  Bytes base = saved(world);
  world.set_gravity({0, -1, 0});
  const Bytes now = saved(world), delta = delta_between(base, now);
  const std::uint64_t hash = world.state_hash();
  std::size_t refused = 0;
  for (std::size_t i = sizeof(detail::Header); i < base.size(); ++i) {
    base[i] ^= std::byte{1};
    const Bytes then = restored(base, delta);
    base[i] ^= std::byte{1};
    if (then == now) continue;  // The delta holds that place anew.
    EXPECT_NE(refusal([&] { world.restore(then); }).find("damaged"), std::string::npos) << i;
    ++refused;
  }
  EXPECT_GT(refused, base.size() / 2);
  EXPECT_EQ(world.state_hash(), hash);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
