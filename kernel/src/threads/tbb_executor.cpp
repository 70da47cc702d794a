#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>

#include "plumb/executor.hpp"

namespace plumb {
namespace {

class TbbExecutor final : public Executor {
 public:
  explicit TbbExecutor(unsigned threads)
      : concurrency_(threads ? threads
                             : static_cast<unsigned>(std::max(1, tbb::info::default_concurrency()))),
        arena_(static_cast<int>(concurrency_)) {}

  unsigned concurrency() const override { return concurrency_; }

  void run(unsigned n, Task task, void* context) override {
    arena_.execute([&] {
      tbb::parallel_for(
          0u, n, [&](unsigned i) { task(context, i); }, tbb::simple_partitioner{});
    });
  }

 private:
  unsigned concurrency_;
  tbb::task_arena arena_;
};

}  // namespace

std::unique_ptr<Executor> make_default_executor(unsigned threads) {
  return std::make_unique<TbbExecutor>(threads);
}

}  // namespace plumb
