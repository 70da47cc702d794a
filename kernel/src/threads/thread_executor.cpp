#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include "plumb/executor.hpp"

namespace plumb {
namespace {

/// Returns how many threads there are if nobody asks for a number. WebAssembly without threads has one.
unsigned hardware_threads() {
#if defined(__EMSCRIPTEN__) && !defined(__EMSCRIPTEN_PTHREADS__)
  return 1;
#else
  return std::max(1u, std::thread::hardware_concurrency());
#endif
}

/// Keeps threads that sleep between runs. `run` allocates nothing.
class ThreadExecutor final : public Executor {
 public:
  explicit ThreadExecutor(unsigned threads) : concurrency_(threads ? threads : hardware_threads()) {
    threads_.reserve(concurrency_ - 1);
    try {
      for (unsigned i = 1; i < concurrency_; ++i) threads_.emplace_back([this] { work(); });
    } catch (
        ...) {  // The system is out of threads, and those that have started must not outlive this object.
      stop();
      throw;
    }
  }
  ~ThreadExecutor() override { stop(); }
  ThreadExecutor(const ThreadExecutor&) = delete;
  ThreadExecutor& operator=(const ThreadExecutor&) = delete;

  unsigned concurrency() const override { return concurrency_; }

  void run(unsigned n, Task task, void* context) override {
    const std::lock_guard turn(turn_);  // callers that share this executor take turns
    std::unique_lock lock(mutex_);
    task_ = task;
    context_ = context;
    next_ = 0;
    count_ = left_ = n;
    changed_.notify_all();
    take_tasks(lock);
    changed_.wait(lock, [&] { return left_ == 0; });
  }

 private:
  void work() {
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, [&] { return stopping_ || next_ < count_; });
      if (stopping_) return;
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

  void stop() {
    {
      const std::lock_guard lock(mutex_);
      stopping_ = true;
    }
    changed_.notify_all();
    for (std::thread& thread : threads_) thread.join();
  }

  unsigned concurrency_;
  std::mutex turn_;
  std::mutex mutex_;  ///< guards all members that follow
  std::condition_variable changed_;
  bool stopping_ = false;
  Task task_ = nullptr;
  void* context_ = nullptr;
  unsigned next_ = 0, count_ = 0, left_ = 0;
  std::vector<std::thread> threads_;
};

}  // namespace

std::unique_ptr<Executor> make_default_executor(unsigned threads) {
  return std::make_unique<ThreadExecutor>(threads);
}

}  // namespace plumb
