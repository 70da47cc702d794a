#pragma once

#include <cstdint>

#include "plumb/executor.hpp"

namespace plumb::detail {

/// Holds the sizes from which threads win. Below them, handing work over costs more than it saves.
///
/// bench_threads measured the defaults, step after step and after pauses in which helpers fall asleep, as
/// between the frames of a program. Lower values use threads in smaller scenes.
struct SharingThresholds {
  double projections = 100000;  ///< rod projections per step from which threads are used at all
  std::uint32_t rods = 8192;    ///< rods in a block from which several threads work on it together
};

/// This is an executor with other sizes from which work is handed over than the default ones. Benchmarks and
/// tests wrap an executor in it, to share scenes that are too small for threads to win.
class EagerExecutor final : public Executor {
 public:
  /// Wraps `inner`, which runs the tasks and must outlive this object.
  EagerExecutor(Executor& inner, SharingThresholds thresholds) : inner_(&inner), thresholds_(thresholds) {}

  unsigned concurrency() const override { return inner_->concurrency(); }
  void run(unsigned n, Task task, void* context) override { inner_->run(n, task, context); }
  const SharingThresholds& thresholds() const { return thresholds_; }

 private:
  Executor* inner_;
  SharingThresholds thresholds_;
};

/// Returns the thresholds of an executor; a null one is the built-in executor.
inline SharingThresholds thresholds_of(const Executor* executor) {
  const auto* eager = dynamic_cast<const EagerExecutor*>(executor);
  return eager ? eager->thresholds() : SharingThresholds{};
}

}  // namespace plumb::detail
