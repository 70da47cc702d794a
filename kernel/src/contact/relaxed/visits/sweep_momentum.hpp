#pragma once

#include <cstddef>
#include <span>

#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// Names numbers that sweeps change: `count` runs of `width` each, `stride` apart.
template <class T>
struct SweptNumbers {
  T* first = nullptr;
  std::size_t width = 0, stride = 0, count = 0;
};

/// Lets sweeps go on the way they went. Sweeps alone carry a push through a pile in about the square of as
/// many as it has layers, and with momentum in about that many.
///
/// This is Nesterov's method (Soviet Mathematics Doklady 27, 1983, 372) with sweeps for steps of the
/// gradient. Displacements are linear in pushes, so that both still fit to each other where they go on alike.
/// What pulls then, or lies outside of Coulomb's cone, is taken back by the next visit.
template <class T>
class SweepMomentum {
 public:
  /// Takes in where sweeps begin.
  void begin(std::span<const SweptNumbers<T>> swept) {
    sweeps_ = 0;
    before_.clear();
    for_runs(swept,
             [&](const T* run, std::size_t width) { before_.insert(before_.end(), run, run + width); });
  }

  /// Goes on after a sweep of the same numbers.
  void go_on(std::span<const SweptNumbers<T>> swept) {
    const T share = static_cast<T>(sweeps_) / static_cast<T>(sweeps_ + 3);
    ++sweeps_;
    T* before = before_.data();
    for_runs(swept, [&](T* run, std::size_t width) {
      for (std::size_t i = 0; i < width; ++i) {
        const T now = run[i];
        run[i] = now + share * (now - before[i]);
        before[i] = now;
      }
      before += width;
    });
  }

 private:
  /// Calls f(run, width) for all runs, in their order.
  template <class F>
  static void for_runs(std::span<const SweptNumbers<T>> swept, F&& f) {
    for (const SweptNumbers<T>& each : swept)
      for (std::size_t k = 0; k < each.count; ++k) f(each.first + k * each.stride, each.width);
  }

  Array<T> before_;         ///< as the last sweep left them
  std::size_t sweeps_ = 0;  ///< since begin()
};

}  // namespace plumb::detail
