// Whoever's threads do the work, and however many: the same bits.

#include "support/executors.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "determinism/scenes.hpp"
#include "support/sanitizers.hpp"
#include "support/worlds.hpp"

namespace plumb {
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
  void expect_same(Executor* executor, unsigned threads, const char* name) const {
    Settings with = settings();
    with.threads = threads;
    with.executor = executor;
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
    expect_same(&serial, threads, "serial");
    expect_same(&reversed, threads, "reversed");
    expect_same(&at_will, threads, "threads");
    expect_same(&together, threads, "threads together");
    expect_same(&staggered, threads, "threads one after the other");
  }
}

TEST_P(Executors, BuiltInGivesTheSameBits) {
  if (!test::can_watch_default_executor)
    GTEST_SKIP() << "oneTBB is not instrumented for the thread sanitizer";
  expect_same(nullptr, 2, "built in");
}

// Worlds may share an executor, stepping in turn.
TEST_P(Executors, AreSharedByWorlds) {
  test::PoolExecutor pool(2);
  Settings with = settings();
  with.executor = &pool;
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
  World small(scenes::make_chain(20), {.method = Method::relax, .executor = &counting});
  EXPECT_FALSE(small.info().parallel);
  small.step(1.0 / 60);
  EXPECT_EQ(counting.runs, 0);
  World large(scenes::make_chain(5000), {.method = Method::relax, .executor = &counting});
  EXPECT_TRUE(large.info().parallel);
  large.step(1.0 / 60);
  EXPECT_EQ(counting.runs, 1);
}

}  // namespace
}  // namespace plumb
