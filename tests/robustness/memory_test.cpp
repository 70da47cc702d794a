#include "plumb/embedding/memory.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <mutex>
#include <new>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "plumb/plumb.hpp"
#include "scenes/generators/generators.hpp"
#include "scenes/spec.hpp"
#include "step/memory/small_blocks.hpp"
#include "step/memory/world_memory.hpp"
#include "support/snapshots.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr double frame = 1.0 / 60;

/// Counts what is out, and has none any more after so many allocations.
class CountingResource : public std::pmr::memory_resource {
 public:
  explicit CountingResource(std::uint64_t most = UINT64_MAX) : left_(most) {}

  std::size_t held() const { return held_; }
  std::uint64_t allocations() const { return allocations_; }

 private:
  void* do_allocate(std::size_t bytes, std::size_t alignment) override {
    const std::lock_guard lock(mutex_);
    if (left_-- == 0) {
      left_ = 0;
      throw std::bad_alloc();
    }
    ++allocations_;
    held_ += bytes;
    return std::pmr::new_delete_resource()->allocate(bytes, alignment);
  }
  void do_deallocate(void* at, std::size_t bytes, std::size_t alignment) override {
    const std::lock_guard lock(mutex_);
    held_ -= bytes;
    std::pmr::new_delete_resource()->deallocate(at, bytes, alignment);
  }
  bool do_is_equal(const std::pmr::memory_resource& other) const noexcept override { return this == &other; }

  std::mutex mutex_;
  std::uint64_t left_, allocations_ = 0;
  std::size_t held_ = 0;
};

struct Case {
  const char* name;
  Scene scene;
  Settings settings;
};

Scene heap_on_a_floor() {
  return scenes::load_scene("heap:links=10,ropes=4");
}

std::vector<Case> cases() {
  return {{"relaxed net", scenes::make_net({.width = 12, .height = 9}), {.method = Method::relax}},
          {"net", scenes::make_net({.width = 12, .height = 9}), {.method = Method::direct}},
          {"chain", scenes::make_chain(50), {}},
          {"springs", scenes::make_chain(5), {.method = Method::springs}},
          {"ropes on two threads", scenes::make_ensemble({.chains = 200, .links = 30}), {.threads = 2}},
          {"heap", heap_on_a_floor(), {.tensions = true, .contacts = true, .events = true, .threads = 2}},
          {"relaxed heap", heap_on_a_floor(), {.method = Method::relax, .precision = Precision::single}}};
}

TEST(WorldMemory, ComesFromTheResourceAndGoesBackThere) {
  for (Case& each : cases()) {
    SCOPED_TRACE(each.name);
    const World plain(each.scene, each.settings);
    CountingResource resource;
    each.settings.memory = &resource;
    {
      World world(each.scene, each.settings);
      EXPECT_EQ(world.info().memory, resource.held());
      EXPECT_EQ(world.info().memory, plain.info().memory);
      EXPECT_GT(resource.held(), 8 * 6 * each.scene.particles.size() / 2);  // state alone, in floats
      test::run(world, frame, 20);
      World moved = std::move(world);
      test::run(moved, frame, 5);
      EXPECT_EQ(moved.info().memory, resource.held());
    }
    EXPECT_EQ(resource.held(), 0u);
  }
}

TEST(WorldMemory, ChangesNoBitAndServesEditsSnapshotsAndSettings) {
  CountingResource resource;
  const Scene scene = heap_on_a_floor();
  Settings settings{.threads = 1};
  World plain(scene, settings);
  settings.memory = &resource;
  {
    World world(scene, settings);
    const auto both = [&](auto&& change) {
      change(plain);
      change(world);
      ASSERT_EQ(test::run(plain, frame, 10).unsolved, test::run(world, frame, 10).unsolved);
      ASSERT_EQ(plain.state_hash(), world.state_hash());
    };
    both([](World&) {});
    both([](World& of) { of.cut(3); });
    both([&](World& of) { of.add(scenes::make_chain(20)); });
    std::vector<std::byte> saved(world.snapshot_size());
    world.save(saved);
    both([](World& of) { of.remove(of.particle_count() - 1); });
    plain.restore(saved);
    both([&](World& of) { of.restore(saved); });
    both([](World& of) {
      Settings to = of.settings();
      to.substeps = 3;
      to.gradient = Gradient::old;
      of.set_settings(to);
    });
    both([](World& of) { of.pack(); });
    EXPECT_EQ(world.info().memory, resource.held());
    Settings other = world.settings();
    other.memory = nullptr;
    EXPECT_THROW(world.set_settings(other), InputError);
  }
  EXPECT_EQ(resource.held(), 0u);
}

TEST(WorldMemory, GivesSmallBlocksThatLieApart) {
  CountingResource resource;
  {
    detail::WorldMemory memory(&resource);
    struct Given {
      std::byte* at;
      std::size_t bytes, alignment;
      std::byte mark;
    };
    const auto use = [&](std::uint32_t seed) {
      std::mt19937 random(seed);
      std::vector<Given> given;
      for (int i = 0; i < 20'000; ++i) {
        if (given.size() > 200 || (!given.empty() && random() % 2 == 0)) {
          std::swap(given[random() % given.size()], given.back());
          const Given& last = given.back();
          for (std::size_t k = 0; k < last.bytes; ++k) ASSERT_EQ(last.at[k], last.mark);
          memory.deallocate(last.at, last.bytes, last.alignment);
          given.pop_back();
        } else {
          const std::size_t bytes = 1 + random() % (random() % 8 == 0 ? 10'000 : 300);
          const std::size_t alignment = std::size_t{1} << random() % 8;
          auto* const at = static_cast<std::byte*>(memory.allocate(bytes, alignment));
          ASSERT_EQ(reinterpret_cast<std::uintptr_t>(at) % alignment, 0u);
          given.push_back({at, bytes, alignment, static_cast<std::byte>(random())});
          std::fill_n(at, bytes, given.back().mark);
        }
      }
      for (const Given& each : given) memory.deallocate(each.at, each.bytes, each.alignment);
    };
    std::thread other(use, 1);
    use(2);
    other.join();
    EXPECT_EQ(memory.held(), resource.held());
  }
  EXPECT_EQ(resource.held(), 0u);
}

TEST(WorldMemory, UsesSmallBlocksAgain) {
  CountingResource resource;
  detail::WorldMemory memory(&resource);
  const auto take_and_give_back = [&] {
    std::array<void*, 50> blocks;
    for (std::size_t i = 0; i < blocks.size(); ++i) blocks[i] = memory.allocate(50 * (i + 1), 16);
    for (std::size_t i = 0; i < blocks.size(); ++i) memory.deallocate(blocks[i], 50 * (i + 1), 16);
  };
  take_and_give_back();
  const std::uint64_t first = resource.allocations();
  for (int i = 0; i < 100; ++i) take_and_give_back();
  if (detail::SmallBlocks::most > 0) {  // else a sanitizer watches each
    EXPECT_EQ(resource.allocations(), first);
  }
}

TEST(WorldMemory, RunsOutWithoutLeavingAnything) {
  for (Case& each : cases()) {
    SCOPED_TRACE(each.name);
    CountingResource all;
    each.settings.memory = &all;
    { const World world(each.scene, each.settings); }
    for (std::uint64_t most = 0; most < all.allocations(); most += 1 + most / 6) {
      CountingResource few(most);
      each.settings.memory = &few;
      EXPECT_THROW(World(each.scene, each.settings), std::bad_alloc) << most;
      EXPECT_EQ(few.held(), 0u) << most;
    }
  }
}

TEST(WorldMemory, IsBoundedWhereASceneIsTooLarge) {
  for (Case& each : cases()) {
    SCOPED_TRACE(each.name);
    CountingResource resource;
    each.settings.memory = &resource;
    const std::size_t needed = World(each.scene, each.settings).info().memory;
    each.settings.most_memory = needed / 2;
    try {
      const World world(each.scene, each.settings);
      ADD_FAILURE() << "was not refused";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(std::to_string(needed / 2) + " bytes"), std::string::npos)
          << error.what();
    }
    EXPECT_EQ(resource.held(), 0u);
    each.settings.most_memory = 2 * needed;  // some is given back before the end
    World world(each.scene, each.settings);
    world.step(frame);  // what a step takes is not bounded
  }
}

TEST(WorldMemory, IsEstimatedBeforeAWorldIsMade) {
  for (const char* const spec :
       {"chain:links=5", "chain:links=3000", "ensemble:chains=300,links=32", "net:width=40,height=40",
        "humanoid", "heap:ropes=40", "drape:size=16", "drape:size=48", "terrain", "boxes",
        "crowd:humanoids=120", "wire", "tree", "truss", "graph", "ring"})
    for (const Method method : {Method::automatic, Method::relax}) {
      const Scene scene = scenes::load_scene(spec);
      if (method == Method::relax && !scene.bends.empty()) continue;  // which it does not move
      const Settings settings{.method = method, .threads = 1};
      const double estimate = static_cast<double>(estimate_memory(scene, settings));
      const double needed = static_cast<double>(World(scene, settings).info().memory);
      EXPECT_LE(needed, estimate) << spec;
      EXPECT_GE(needed, estimate / 5) << spec;
    }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
