#pragma once

#include <cstdint>

#include "plumb/executor.hpp"

namespace plumb::detail {

/// Sizes from which threads win; below, handing work over costs more than it saves. The defaults were
/// measured by bench_threads, step after step and after pauses in which helpers fall asleep, as between the
/// frames of a program.
struct SharingThresholds {
  double projections = 100000;  ///< rod projections per step, for any threads at all
  std::uint32_t rods = 8192;    ///< in a block, for several threads to work on it together
};

/// An executor to which work is handed over from other sizes on than the default ones. Benchmarks and tests
/// wrap an executor in it, to share scenes that are too small for threads to win.
class EagerExecutor final : public Executor {
 public:
  /// `inner` runs the tasks and must outlive this.
  EagerExecutor(Executor& inner, SharingThresholds thresholds) : inner_(&inner), thresholds_(thresholds) {}

  unsigned concurrency() const override { return inner_->concurrency(); }
  void run(unsigned n, Task task, void* context) override { inner_->run(n, task, context); }
  const SharingThresholds& thresholds() const { return thresholds_; }

 private:
  Executor* inner_;
  SharingThresholds thresholds_;
};

/// The thresholds of an executor; none is the built-in one.
inline SharingThresholds thresholds_of(const Executor* executor) {
  const auto* eager = dynamic_cast<const EagerExecutor*>(executor);
  return eager ? eager->thresholds() : SharingThresholds{};
}

}  // namespace plumb::detail
