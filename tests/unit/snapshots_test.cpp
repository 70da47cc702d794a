// What snapshots hold, and which are refused.

#include "support/snapshots.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <numeric>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "interface/archive.hpp"
#include "math/byte_sum.hpp"
#include "scenes/spec.hpp"
#include "step/snapshot/fingerprint.hpp"
#include "step/world_impl.hpp"
#include "support/breaking.hpp"
#include "support/refusals.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using detail::Archive;
using detail::fingerprint_of;
using detail::sum_of;
using testing::Test;

enum class Shade : std::uint8_t { light, dark };
struct Everything {
  double number = 0;
  bool flag = false;
  Shade shade = Shade::light;
  Vec3 place{};
  std::vector<float> floats{};
  std::vector<std::pair<std::uint32_t, bool>> pairs{};
  std::array<std::int16_t, 3> shorts{};
  std::optional<double> none{}, some{};
  layouts::AlignedBuffer<double> buffer{};
};
void visit_members(Archive& archive, Everything& of) {
  auto& [number, flag, shade, place, floats, pairs, shorts, none, some, buffer] = of;
  archive(number, flag, shade, place, floats, pairs, shorts, none, some, buffer);
}

Everything sample() {
  Everything out{.number = -0.0,
                 .flag = true,
                 .shade = Shade::dark,
                 .place = {1, 2, 3},
                 .floats = {1.5f, 2.5f},
                 .pairs = {{7, true}, {8, false}},
                 .shorts = {-1, 0, 1},
                 .some = 4.0,
                 .buffer = layouts::AlignedBuffer<double>(2)};
  out.buffer[1] = 9;
  return out;
}

std::vector<std::byte> written(Everything& of) {
  Archive measure = Archive::measure();
  measure(of);
  std::vector<std::byte> bytes(measure.size());
  Archive save = Archive::save(bytes);
  save(of);
  EXPECT_EQ(save.size(), bytes.size());
  return bytes;
}

TEST(Archive, ReadsWhatItWrote) {
  Everything from = sample(), to;
  to.none = 3;
  to.floats.resize(17);
  const auto bytes = written(from);
  // A double, two bytes, three doubles, two floats behind a count, and so on.
  EXPECT_EQ(bytes.size(), 8 + 1 + 1 + 24 + (8 + 2 * 4) + (8 + 2 * 5) + 3 * 2 + 1 + (1 + 8) + (8 + 2 * 8));
  Archive restore = Archive::restore(bytes);
  restore(to);
  EXPECT_EQ(restore.size(), bytes.size());
  EXPECT_TRUE(written(to) == bytes);
  EXPECT_EQ(to.pairs, from.pairs);
  EXPECT_EQ(to.none, std::nullopt);
  EXPECT_EQ(to.some, 4.0);
  EXPECT_EQ(to.buffer[1], 9);
}

TEST(Archive, NeverReadsOrWritesBeyondItsEnd) {
  Everything from = sample();
  const auto bytes = written(from);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    Everything to;
    Archive restore = Archive::restore(std::span(bytes).first(size));
    EXPECT_NE(test::refusal([&] { restore(to); }), "") << size;
    std::vector<std::byte> room(size);
    Archive save = Archive::save(room);
    EXPECT_NE(test::refusal([&] { save(from); }), "") << size;
  }
}

TEST(Archive, TellsWhichFlagsChange) {
  Array<std::uint8_t> flags{0, 1, 1};
  std::vector<std::byte> bytes(8 + 3);
  EXPECT_FALSE(Archive::save(bytes).changes(flags));
  EXPECT_FALSE(Archive::restore(bytes).changes(flags));
  for (Array<std::uint8_t> other : {Array<std::uint8_t>{0, 0, 1}, {}, {0, 1, 1, 0}}) {
    EXPECT_TRUE(Archive::restore(bytes).changes(other));
    EXPECT_EQ(other, flags);
  }
}

std::vector<std::byte> random_bytes(std::size_t size) {
  std::mt19937 random(3);
  std::vector<std::byte> out(size);
  for (std::byte& each : out) each = static_cast<std::byte>(random());
  return out;
}

// Every bit counts, in whole blocks of the sum and behind them.
TEST(ByteSum, ChangesWithEveryBit) {
  for (const std::size_t size : {1u, 7u, 8u, 31u, 32u, 33u, 75u, 256u, 3u * 256 + 77}) {
    std::vector<std::byte> bytes = random_bytes(size);
    const std::uint64_t sum = sum_of(bytes, {});
    for (std::size_t i = 0; i < 8 * size; ++i) {
      bytes[i / 8] ^= std::byte(1 << i % 8);
      ASSERT_NE(sum_of(bytes, {}), sum) << size << ", " << i;
      bytes[i / 8] ^= std::byte(1 << i % 8);
    }
  }
  EXPECT_NE(sum_of(std::vector<std::byte>(8), {}), sum_of(std::vector<std::byte>(16), {}));
}

// What two changes do hardly ever is the same. Signs are what a plain sum of words takes for nothing.
TEST(ByteSum, ChangesWithTwoSignsAndWithWordsThatChangePlaces) {
  std::vector<std::byte> bytes = random_bytes(8 * 200);
  const std::uint64_t sum = sum_of(bytes, {});
  const auto turn = [&](std::size_t word) { bytes[8 * word + 7] ^= std::byte{0x80}; };
  const auto swap = [&](std::size_t a, std::size_t b) {
    std::swap_ranges(&bytes[8 * a], &bytes[8 * a] + 8, &bytes[8 * b]);
  };
  for (std::size_t a = 0; a < 200; ++a)
    for (std::size_t b = 0; b < a; ++b) {
      turn(a), turn(b);
      ASSERT_NE(sum_of(bytes, {}), sum) << a << ' ' << b;
      turn(a), turn(b);
      swap(a, b);
      ASSERT_NE(sum_of(bytes, {}), sum) << a << ' ' << b;
      swap(a, b);
    }
}

// What is summed up as it is written has the sum of what was written, however it comes.
TEST(ByteSum, IsTheSameInPartsAsOfAll) {
  std::mt19937 random(5);
  for (int round = 0; round < 50; ++round) {
    std::vector<std::vector<std::uint8_t>> parts(1 + random() % 9);
    for (auto& part : parts) {
      part.resize(random() % (random() % 2 == 0 ? 30 : 3000));
      for (std::uint8_t& each : part) each = static_cast<std::uint8_t>(random());
    }
    Archive measure = Archive::measure();
    for (auto& part : parts) measure(part);
    std::vector<std::byte> bytes(measure.size());
    Archive save = Archive::save(bytes);
    for (auto& part : parts) save(part);
    const std::vector<std::byte> others = random_bytes(random() % 20);
    EXPECT_EQ(save.sum_with(others), sum_of(bytes, others));
    auto now = parts;
    for (auto& part : now) std::fill(part.begin(), part.end(), std::uint8_t{0});
    Archive restore = Archive::restore(bytes);
    for (auto& part : now) restore(part);
    EXPECT_EQ(now, parts);
  }
}

/// Returns the sum, word by word.
std::uint64_t sum_by_words(std::span<const std::byte> bytes) {
  constexpr std::size_t lanes = detail::ByteSum::lanes;
  const auto word_at = [&](std::size_t at) {
    std::uint64_t word = 0;
    std::memcpy(&word, &bytes[at], std::min<std::size_t>(8, bytes.size() - at));
    return word;
  };
  std::array<std::uint64_t, lanes> sums;
  std::iota(sums.begin(), sums.end(), std::uint64_t{1});
  std::size_t at = 0;
  for (bool swaps = false; at < bytes.size() / detail::ByteSum::block * detail::ByteSum::block;
       swaps = !swaps)
    for (std::uint64_t& each : sums) {
      each += word_at(at);
      each = swaps ? each << 32 | each >> 32 : each ^ each >> 3;
      at += 8;
    }
  std::uint64_t out = bytes.size();
  for (const std::uint64_t each : sums) out = detail::mixed(out, each);
  for (; at < bytes.size(); at += 8) out = detail::mixed(out, word_at(at));
  return out;
}

TEST(ByteSum, IsTheSameByVectorsAsByWords) {
  for (const std::size_t size : {0u, 5u, 255u, 256u, 257u, 5000u}) {
    const std::vector<std::byte> bytes = random_bytes(size);
    EXPECT_EQ(sum_of(bytes, {}), sum_by_words(bytes)) << size;
  }
}

// Snapshots travel between processors, so that this must be the same on all of them.
TEST(ByteSum, IsThatOfTheFormat) {
  std::vector<std::byte> bytes(600);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>(i * i);
  EXPECT_EQ(sum_of(bytes, std::span(bytes).first(32)), 0x68f99c650b0d9153u);
}

TEST(Fingerprints, TellScenesAndSettingsApart) {
  const Scene scene = scenes::load_scene("crowd:humanoids=2,hit=1");
  const Settings settings;
  const detail::Fingerprint own = fingerprint_of(scene, settings);
  EXPECT_EQ(fingerprint_of(scene, {.stop = {.sweeps = 3}, .isa = Isa::scalar, .threads = 3}), own);
  const std::function<void(Scene&)> changes[] = {
      [](Scene& s) { s.particles.back().position.z += 1e-12; },
      [](Scene& s) { s.particles[0].asleep = !s.particles[0].asleep; },
      [](Scene& s) { s.gravity.x = 1; },
      [](Scene& s) { s.pins.emplace_back(); },
      [](Scene& s) { s.capsules[1].filter.group = 3; },
      [](Scene& s) { s.platforms.push_back({}); }};
  for (std::size_t i = 0; i < std::size(changes); ++i) {
    Scene other = scene;
    changes[i](other);
    EXPECT_NE(fingerprint_of(other, settings).scene, own.scene) << i;
    EXPECT_EQ(fingerprint_of(other, settings).settings, own.settings) << i;
  }
  const Settings others[] = {{.method = Method::relax},
                             {.precision = Precision::single},
                             {.gradient = Gradient::mid},
                             {.substeps = 2},
                             {.accuracy = 1e-3},
                             {.sleep = false},
                             {.tensions = true},
                             {.contacts = true},
                             {.contact = {.margin = 1e-3}},
                             {.layout = LayoutChoice::soa}};
  for (std::size_t i = 0; i < std::size(others); ++i)
    EXPECT_NE(fingerprint_of(scene, others[i]).settings, own.settings) << i;
}

constexpr double dt = 1.0 / 60;

/// A world in the middle of something, and its snapshot.
struct Saved {
  explicit Saved(Settings with = {}) : settings(with), world(scene, settings) {
    test::run(world, dt, 12);
    bytes = test::snapshot_of(world);
    test::run(world, dt, 3);
    later = test::snapshot_of(world);
  }
  /// Says why bytes are refused, and expects that the world stays as it is.
  std::string refusal(const test::Snapshot& from) {
    const std::string out = test::refusal([&] { world.restore(from); });
    EXPECT_TRUE(test::snapshot_of(world) == later);
    return out;
  }

  Scene scene = scenes::load_scene("rope:links=4");
  Settings settings;
  World world;
  test::Snapshot bytes, later;
};

TEST(Snapshot, KeepsItsSizeAndLeavesTheRestOfTheMemory) {
  Saved saved;
  const std::size_t size = saved.world.snapshot_size();
  test::Snapshot large(size + 100, std::byte{0x77});
  EXPECT_EQ(saved.world.save(large), size);
  for (std::size_t i = size; i < large.size(); ++i) ASSERT_EQ(large[i], std::byte{0x77});
  EXPECT_EQ(saved.refusal(large), "");
  for (const std::size_t room : {size - 1, std::size_t{48}, std::size_t{0}}) {
    test::Snapshot small(room);
    EXPECT_NE(test::refusal([&] { saved.world.save(small); }).find("does not fit"), std::string::npos)
        << room;
  }
}

TEST(Snapshot, IsRefusedWhereItIsCutOrChanged) {
  Saved saved;
  for (std::size_t size = 0; size < saved.bytes.size(); size += size < 64 ? 1 : 17) {
    const test::Snapshot cut(saved.bytes.begin(), saved.bytes.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_NE(saved.refusal(cut), "") << size;
  }
  for (std::size_t i = 0; i < saved.bytes.size(); ++i) {
    test::Snapshot damaged = saved.bytes;
    damaged[i] ^= std::byte(1 << i % 8);
    const std::string why = test::refusal([&] { saved.world.restore(damaged); });
    EXPECT_NE(why, "") << i;
    EXPECT_TRUE(i < 48 || why.find("damaged") != std::string::npos) << why;
  }
  EXPECT_TRUE(test::snapshot_of(saved.world) == saved.later);
}

TEST(Snapshot, IsRefusedWithTheReason) {
  Saved saved;
  const auto has = [&](const test::Snapshot& from, const char* reason) {
    const std::string why = saved.refusal(from);
    EXPECT_NE(why.find(reason), std::string::npos) << why;
  };
  test::Snapshot other = saved.bytes;
  other[0] = std::byte{'P'};
  has(other, "does not begin as one");
  other = saved.bytes;
  other[16] = std::byte{99};
  has(other, "format 99");
  Scene moved = saved.scene;
  moved.particles[0].position.x += 1;
  has(test::snapshot_of(World(moved)), "another scene");
  has(test::snapshot_of(World(saved.scene, {.sleep = false})), "other settings");
  has(test::snapshot_of(World(saved.scene, {.precision = Precision::single})), "other settings");
}

TEST(Snapshot, IsKeptByRelaxationAndDirectSolvesAlone) {
  for (const Method method : {Method::springs, Method::multipliers, Method::featherstone}) {
    World world(scenes::load_scene("chain:links=3"), {.method = method});
    test::Snapshot room(1 << 16);
    EXPECT_NE(test::refusal([&] { (void)world.snapshot_size(); }).find("keep none"), std::string::npos);
    EXPECT_NE(test::refusal([&] { world.save(room); }), "");
  }
}

// A load is the program's. Where one was set since, it acts after a restore; where it was taken away, it does
// not come back.
TEST(Snapshot, LeavesTheLoadToTheWorld) {
  const Scene scene = test::hanging_chain({});
  const Load pulls = [](const LoadState&, std::span<Vec3> forces) { forces[3] = {1, 0, 0}; };
  World with(scene), without(scene), late(scene);
  with.set_load(pulls);
  test::run(with, dt, 3);
  const test::Snapshot loaded = test::snapshot_of(with);
  late.restore(loaded);
  late.set_load(pulls);
  test::run(without, dt, 3);
  const test::Snapshot free = test::snapshot_of(without);
  without.set_load(pulls);
  EXPECT_EQ(test::snapshot_of(without), free);
  without.set_load({});
  EXPECT_EQ(test::snapshot_of(without), free);
  with.restore(free);
  test::run(with, dt, 2);
  EXPECT_TRUE(test::all_finite(with));
  EXPECT_GT(with.position(3).x, 0);
  test::run(without, dt, 2);
  EXPECT_EQ(without.position(3).x, 0);
}

// Rods that broke make other islands, other solvers and other sizes. They are whole again where a world goes
// back to before that, and broken where a fresh one goes on to after it.
TEST(Snapshot, GoesBackAndForthOverBrokenRods) {
  for (const RodLaw& law : test::breaking_laws) {
    World world(test::hanging_chain(law)), fresh(test::hanging_chain(law));
    test::run(world, dt, 5);
    const test::Snapshot before = test::snapshot_of(world);
    world.set_force(6, {0, -100, 0});
    test::run(world, dt, 30);
    ASSERT_TRUE(world.is_broken(2));
    ASSERT_EQ(world.info().islands, 2u);
    const test::Snapshot after = test::snapshot_of(world);
    world.restore(before);
    EXPECT_FALSE(world.is_broken(2));
    EXPECT_EQ(world.info().islands, 1u);
    fresh.restore(after);
    EXPECT_TRUE(fresh.is_broken(2));
    EXPECT_EQ(fresh.info().islands, 2u);
    test::run(world, dt, 5);
    world.restore(after);
    test::run(world, dt, 5);
    test::run(fresh, dt, 5);
    EXPECT_TRUE(test::snapshot_of(world) == test::snapshot_of(fresh));
  }
}

// Velocities of gradient old are found from displacements and where anchors are. What is read after an anchor
// was put at its target, to the digit, is what a restored world reads.
TEST(Snapshot, HasTheVelocitiesBesideAnAnchorThatMoved) {
  Scene rope;
  rope.planes.push_back({.normal = {0, 1, 0}, .offset = 0});
  for (std::uint32_t i = 0; i <= 2; ++i)
    rope.particles.push_back({.position = {1.4, 1.8, 0.1 * i}, .mass = 0.1, .fixed = i == 0});
  for (std::uint32_t i = 0; i < 2; ++i) {
    rope.rods.push_back({.a = i, .b = i + 1, .length = 0.1, .mass = 0.1});
    rope.capsules.push_back({.a = point_at(i), .b = point_at(i + 1), .radius = 0.02});
  }
  Scene loop = rope;
  loop.particles.push_back({.position = {1.5, 1.8, 0.1}, .mass = 0.1});
  for (const std::uint32_t k : {0u, 2u}) loop.rods.push_back({.a = k, .b = 3, .length = 0.1 * std::sqrt(2)});
  for (const Scene& scene : {rope, loop}) {
    World world(scene, {.method = Method::direct, .tensions = true, .contacts = true, .events = true});
    world.step(dt);
    Settings settings = world.settings();
    settings.gradient = Gradient::old;
    settings.substeps = 2;
    world.set_settings(settings);
    World late(scene, settings);
    for (int i = 0; i < 40; ++i) {
      if (i % 4 == 2) world.move_anchor(0, world.position(0) + Vec3{0.003, 0.007, 0.001 * i});
      world.step(dt);
      late.restore(test::snapshot_of(world));
      for (std::uint32_t k = 1; k <= 2; ++k) EXPECT_EQ(late.velocity(k), world.velocity(k)) << i;
    }
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
