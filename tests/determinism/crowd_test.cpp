// Figures that touch: the same bits whoever's threads do the work, and again with the same.

#include <gtest/gtest.h>

#include <cstdint>

#include "scenes/spec.hpp"
#include "support/bodies.hpp"
#include "support/executors.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

/// After five seconds in which 16 of 64 figures are struck, fall and, some of them, fall asleep.
std::uint64_t crowd_after_300_frames(unsigned threads, Executor* executor = nullptr) {
  Settings settings = test::body_settings(1, true);
  settings.threads = threads;
  settings.executor = executor;
  World world(scenes::load_scene("crowd:humanoids=64,hit=16"), settings);
  EXPECT_EQ(world.info().threads, threads);
  const StepReport report = test::run(world, test::frame, 300);
  EXPECT_GT(report.contact_points, 4u) << "in one cluster at once";
  return world.state_hash();
}

TEST(Crowd, HasTheSameBitsWithEveryExecutor) {
  const std::uint64_t alone = crowd_after_300_frames(1);
  EXPECT_EQ(crowd_after_300_frames(1), alone) << "again";
  EXPECT_EQ(crowd_after_300_frames(2), alone) << "built-in";
  for (const unsigned threads : {2u, 3u}) {
    test::SerialExecutor reversed(threads, true);
    EXPECT_EQ(crowd_after_300_frames(threads, &reversed), alone) << "reversed, " << threads;
    test::ThreadExecutor together(threads, test::ThreadExecutor::Start::together);
    EXPECT_EQ(crowd_after_300_frames(threads, &together), alone) << "threads, " << threads;
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
