// A team runs a straight program on whatever executor it is given: every part of every phase once, phases one
// after the other, nobody waiting for a task that has not started.

#include "threads/team.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <barrier>
#include <memory>
#include <new>
#include <vector>

#include "support/executors.hpp"
#include "support/sanitizers.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

using test::SerialExecutor;
using test::ThreadExecutor;

struct Named {
  const char* name;
  std::unique_ptr<Executor> executor;
};

std::vector<Named> executors(unsigned threads) {
  std::vector<Named> list;
  list.push_back({"none", nullptr});
  list.push_back({"serial", std::make_unique<SerialExecutor>(threads)});
  list.push_back({"reversed", std::make_unique<SerialExecutor>(threads, true)});
  list.push_back({"threads", std::make_unique<ThreadExecutor>(threads)});
  list.push_back({"together", std::make_unique<ThreadExecutor>(threads, ThreadExecutor::Start::together)});
  list.push_back({"staggered", std::make_unique<ThreadExecutor>(threads, ThreadExecutor::Start::staggered)});
  list.push_back({"pool", std::make_unique<test::PoolExecutor>(threads)});
  if (test::can_watch_default_executor && threads <= 2)
    list.push_back({"default", make_default_executor(threads)});
  return list;
}

TEST(Team, RunsEveryPartOfEveryPhaseOnceAndInTurn) {
  for (const unsigned threads : {1u, 2u, 3u, 5u})
    for (const Named& named : executors(threads)) {
      Team team(threads);
      for (int run = 0; run < 3; ++run) {  // a team is used again and again
        int phases = 0;
        team.lead(named.executor.get(), [&] {
          // Written by one phase and read by the next without any lock: phases must follow each other.
          std::vector<int> at(team.parts(), 0);
          for (; phases < 100; ++phases) {
            const std::vector<int> before = at;
            team.for_parts([&](unsigned part) {
              for (const int count : before) EXPECT_EQ(count, phases) << named.name;
              ++at[part];
            });
          }
          for (const int count : at) EXPECT_EQ(count, 100) << named.name;
        });
        EXPECT_EQ(phases, 100) << named.name << ": the program runs once";
      }
    }
}

TEST(Team, RunsEachOfManyItemsOnce) {
  for (const unsigned threads : {1u, 2u, 4u})
    for (const Named& named : executors(threads))
      for (const std::uint32_t n : {0u, 1u, 3u, 1000u}) {
        Team team(threads);
        std::vector<int> times(n, 0);
        team.lead(named.executor.get(), [&] {
          team.for_each(n, [&](std::uint32_t i, unsigned) { ++times[i]; });
          team.for_each(n, [&](std::uint32_t i, unsigned) { ++times[i]; });
        });
        for (std::uint32_t i = 0; i < n; ++i)
          EXPECT_EQ(times[i], 2) << named.name << ", item " << i << " of " << n;
      }
}

// Every part waits for all others to begin: it ends only if they really run side by side.
TEST(Team, RunsPartsAtOnceOnRealThreads) {
  for (const unsigned threads : {2u, 4u}) {
    ThreadExecutor executor(threads, ThreadExecutor::Start::together);
    Team team(threads);
    std::barrier all_begun(threads);
    std::atomic<unsigned> ended{0};
    team.lead(&executor, [&] {
      ASSERT_EQ(team.parts(), threads);
      for (int phase = 0; phase < 10; ++phase)
        team.for_parts([&](unsigned) {
          all_begun.arrive_and_wait();
          ++ended;
        });
    });
    EXPECT_EQ(ended, 10 * threads);
  }
}

// Memory may run out on any thread. Nobody waits for a part that has thrown, and the team goes on after that.
TEST(Team, ThrowsWhatAPartOrTheProgramThrew) {
  for (const unsigned threads : {1u, 2u, 3u})
    for (const Named& named : executors(threads)) {
      SCOPED_TRACE(named.name);
      Team team(threads);
      for (unsigned thrower = 0; thrower < threads; ++thrower) {
        std::atomic<int> parts{0};
        const auto run = [&] {
          team.lead(named.executor.get(), [&] {
            team.for_parts([&](unsigned part) {
              ++parts;
              if (part == thrower % team.parts()) throw std::bad_alloc();
            });
            ADD_FAILURE() << "the program goes on";
          });
        };
        EXPECT_THROW(run(), std::bad_alloc);
        EXPECT_EQ(parts, named.executor && threads > 1 ? static_cast<int>(threads) : 1);
      }
      EXPECT_THROW(team.lead(named.executor.get(), [] { throw std::bad_alloc(); }), std::bad_alloc);
      std::atomic<int> ended{0};
      team.lead(named.executor.get(), [&] { team.for_parts([&](unsigned) { ++ended; }); });
      EXPECT_EQ(ended, named.executor && threads > 1 ? static_cast<int>(threads) : 1);
    }
}

TEST(Team, CutsItemsIntoRangesThatMeet) {
  for (const unsigned count : {1u, 2u, 3u, 7u})
    for (const std::uint32_t n : {0u, 1u, 5u, 100u, 4294967295u}) {
      EXPECT_EQ(Team::begin_of(n, 0, count), 0u);
      EXPECT_EQ(Team::begin_of(n, count, count), n);
      for (unsigned part = 0; part < count; ++part) {
        const std::uint32_t size = Team::begin_of(n, part + 1, count) - Team::begin_of(n, part, count);
        EXPECT_GE(size, n / count);
        EXPECT_LE(size, std::uint64_t{n} / count + 1);
      }
    }
}

TEST(DefaultExecutor, KeepsTheContract) {
  if (!test::can_watch_default_executor)
    GTEST_SKIP() << "oneTBB is not instrumented for the thread sanitizer";
  for (const unsigned threads : {1u, 2u}) {
    const std::unique_ptr<Executor> executor = make_default_executor(threads);
    EXPECT_EQ(executor->concurrency(), threads);
    for (const unsigned n : {0u, 1u, 2u, 100u}) {
      std::vector<std::atomic<int>> times(n);
      executor->run(
          n, [](void* context, unsigned i) { ++(*static_cast<std::vector<std::atomic<int>>*>(context))[i]; },
          &times);
      for (unsigned i = 0; i < n; ++i) EXPECT_EQ(times[i], 1);
    }
  }
  EXPECT_GE(make_default_executor()->concurrency(), 1u);
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
