#pragma once

#include <cstdint>

namespace plumb::detail {

/// Sizes from which threads win; below, handing work over costs more. Measured by bench_threads, step after
/// step and after pauses in which helpers fall asleep, as between the frames of a program. Not part of the
/// interface: benchmarks and tests lower them before they build a World.
struct SharingThresholds {
  double projections = 100000;  ///< rod projections per step, for any threads at all
  std::uint32_t rods = 8192;    ///< in a block, for several threads to work on it together
};
inline SharingThresholds sharing_thresholds;

}  // namespace plumb::detail
