// Whoever's threads do the work, and however many: the same bits.

#include "support/executors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "determinism/scenes.hpp"
#include "plumb/executor.hpp"
#include "support/sanitizers.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::SerialExecutor;
using test::SharedScene;
using test::ThreadExecutor;

class Executors : public testing::TestWithParam<SharedScene> {
 protected:
  Scene scene = GetParam().make();
  int steps = test::scaled(60);

  Settings settings() const {
    return {.method = Method::relax, .stop = {.sweeps = GetParam().sweeps}, .threads = 1};
  }
  std::uint64_t alone() const {
    World world(scene, settings());
    test::run(world, 1.0 / 60, steps);
    return world.state_hash();
  }
  void expect_same(Executor& executor, unsigned threads, const char* name) const {
    detail::EagerExecutor eager(executor, test::early);
    Settings with = settings();
    with.threads = threads;
    with.executor = &eager;
    World world(scene, with);
    EXPECT_TRUE(world.info().parallel);
    EXPECT_EQ(world.info().threads, threads);
    test::run(world, 1.0 / 60, steps);
    EXPECT_EQ(world.state_hash(), alone()) << name << ", " << threads << " threads";
  }
};

// Also with more threads than this machine may have cores, and with more than a chain of this length can be
// cut for.
TEST_P(Executors, GiveTheSameBits) {
  for (const unsigned threads : {2u, 3u, 7u}) {
    SerialExecutor serial(threads), reversed(threads, true);
    ThreadExecutor at_will(threads), together(threads, ThreadExecutor::Start::together),
        staggered(threads, ThreadExecutor::Start::staggered);
    expect_same(serial, threads, "serial");
    expect_same(reversed, threads, "reversed");
    expect_same(at_will, threads, "threads");
    expect_same(together, threads, "threads together");
    expect_same(staggered, threads, "threads one after the other");
  }
}

TEST_P(Executors, BuiltInGivesTheSameBits) {
  if (!test::can_watch_default_executor)
    GTEST_SKIP() << "oneTBB is not instrumented for the thread sanitizer";
  expect_same(*make_default_executor(2), 2, "built in");
}

// Without an executor a world makes one, which it uses from the size on where threads win.
TEST_P(Executors, OfAWorldsOwnGiveTheSameBits) {
  if (!test::can_watch_default_executor)
    GTEST_SKIP() << "oneTBB is not instrumented for the thread sanitizer";
  Settings with = settings();
  with.stop.sweeps = static_cast<std::uint32_t>(
      std::ceil(detail::SharingThresholds{}.projections / static_cast<double>(scene.rods.size())));
  World one(scene, with);
  with.threads = 2;
  World two(scene, with);
  EXPECT_FALSE(one.info().parallel);
  ASSERT_TRUE(two.info().parallel);
  test::run(one, 1.0 / 60, test::scaled(10));
  test::run(two, 1.0 / 60, test::scaled(10));
  EXPECT_EQ(one.state_hash(), two.state_hash());
}

// Worlds may share an executor, stepping in turn.
TEST_P(Executors, AreSharedByWorlds) {
  test::PoolExecutor pool(2);
  detail::EagerExecutor eager(pool, test::early);
  Settings with = settings();
  with.executor = &eager;
  with.threads = 0;  // as many as the executor offers
  World one(scene, with), other(scene, with);
  EXPECT_EQ(one.info().threads, 2u);
  for (int i = 0; i < steps; ++i) {
    one.step(1.0 / 60);
    other.step(1.0 / 60);
  }
  EXPECT_EQ(one.state_hash(), other.state_hash());
  EXPECT_EQ(one.state_hash(), alone());
}

INSTANTIATE_TEST_SUITE_P(Every, Executors, testing::ValuesIn(test::shared_scenes()),
                         [](const auto& test) { return std::string(test.param.name); });

// Below the size where threads win, an executor is not asked at all.
TEST(SmallScenes, DoNotUseThreads) {
  class Counting final : public Executor {
   public:
    unsigned concurrency() const override { return 2; }
    void run(unsigned n, Task task, void* context) override {
      ++runs;
      for (unsigned i = 0; i < n; ++i) task(context, i);
    }
    int runs = 0;
  } counting;
  // A step projects rods · sweeps times, and the last size below the threshold is one rod short of it.
  const std::uint32_t sweeps = 100;
  const auto enough =
      static_cast<std::uint32_t>(std::ceil(detail::SharingThresholds{}.projections / double{sweeps}));
  const Settings settings{.method = Method::relax, .stop = {.sweeps = sweeps}, .executor = &counting};
  World small(scenes::make_chain(enough - 1), settings);
  EXPECT_FALSE(small.info().parallel);
  small.step(1.0 / 60);
  EXPECT_EQ(counting.runs, 0);
  World large(scenes::make_chain(enough), settings);
  EXPECT_TRUE(large.info().parallel);
  large.step(1.0 / 60);
  EXPECT_EQ(counting.runs, 1);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
