#pragma once

#include <barrier>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include "plumb/executor.hpp"
#include "support/sanitizers.hpp"
#include "threads/sharing.hpp"

/// Executors that keep the contract of Executor in every way it allows.
namespace plumb::test {

/// False where the thread sanitizer would take the hand-overs of oneTBB, which is not instrumented, for
/// races.
inline constexpr bool can_watch_default_executor = !(thread_sanitizer && PLUMB_TEST_TBB);

/// Sizes from which the tests' executors share work: a part of the usual ones, as threads are tested on
/// scenes that are too small for them to win.
inline constexpr detail::SharingThresholds early{.projections = detail::SharingThresholds{}.projections / 10,
                                                 .rods = detail::SharingThresholds{}.rods / 4};

/// One task after the other on the calling thread, first to last or last to first.
class SerialExecutor final : public Executor {
 public:
  explicit SerialExecutor(unsigned concurrency, bool reversed = false)
      : concurrency_(concurrency), reversed_(reversed) {}
  unsigned concurrency() const override { return concurrency_; }
  void run(unsigned n, Task task, void* context) override {
    for (unsigned i = 0; i < n; ++i) task(context, reversed_ ? n - 1 - i : i);
  }

 private:
  unsigned concurrency_;
  bool reversed_;
};

/// A new thread per task.
class ThreadExecutor final : public Executor {
 public:
  enum class Start { at_will, together, staggered };

  /// together: no task begins before all have threads. staggered: each begins a little later than the one
  /// before, so that it finds others at work or already gone.
  explicit ThreadExecutor(unsigned concurrency, Start start = Start::at_will)
      : concurrency_(concurrency), start_(start) {}
  unsigned concurrency() const override { return concurrency_; }
  void run(unsigned n, Task task, void* context) override {
    std::barrier all_here(n);
    std::vector<std::thread> threads;
    for (unsigned i = 0; i < n; ++i)
      threads.emplace_back([&, i] {
        if (start_ == Start::together) all_here.arrive_and_wait();
        if (start_ == Start::staggered) std::this_thread::sleep_for(std::chrono::microseconds(100 * i));
        task(context, i);
      });
    for (std::thread& thread : threads) thread.join();
  }

 private:
  unsigned concurrency_;
  Start start_;
};

/// Threads that wait for work between runs, as those of an engine do. `run` allocates nothing.
class PoolExecutor final : public Executor {
 public:
  explicit PoolExecutor(unsigned concurrency) : concurrency_(concurrency) {
    for (unsigned i = 1; i < concurrency; ++i) threads_.emplace_back([this] { work(); });
  }
  ~PoolExecutor() override {
    {
      const std::lock_guard lock(mutex_);
      closing_ = true;
    }
    changed_.notify_all();
    for (std::thread& thread : threads_) thread.join();
  }
  unsigned concurrency() const override { return concurrency_; }

  void run(unsigned n, Task task, void* context) override {
    std::unique_lock lock(mutex_);
    task_ = task;
    context_ = context;
    next_ = 0;
    count_ = left_ = n;
    changed_.notify_all();
    take_tasks(lock);
    changed_.wait(lock, [&] { return left_ == 0; });
    count_ = 0;
  }

 private:
  void work() {
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, [&] { return closing_ || next_ < count_; });
      if (closing_) return;
      take_tasks(lock);
    }
  }
  void take_tasks(std::unique_lock<std::mutex>& lock) {
    while (next_ < count_) {
      const unsigned index = next_++;
      lock.unlock();
      task_(context_, index);
      lock.lock();
      if (--left_ == 0) changed_.notify_all();
    }
  }

  unsigned concurrency_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool closing_ = false;
  Task task_ = nullptr;
  void* context_ = nullptr;
  unsigned next_ = 0, count_ = 0, left_ = 0;
  std::vector<std::thread> threads_;
};

}  // namespace plumb::test
