#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <limits>
#include <optional>

#include "plumb/world.hpp"

namespace plumb::detail {

/// Counts what a piece does in a step, and bounds it (Settings::most_work).
///
/// A solver whose tally is spent cuts as little as it can. It tries gradient new, lets rods give, and counts
/// what it did.
struct Tally : StepReport {
  std::uint64_t most_work = std::numeric_limits<std::uint64_t>::max();  ///< bound of work()
  /// What is left takes fewer substeps when it is later than this.
  std::optional<std::chrono::steady_clock::time_point> deadline{};
  /// Work is spent then, too, as where tries are taken back. Elsewhere to give up often takes longer.
  bool gives_up_late = false;
  std::uint64_t taken_back = 0;  ///< work of tries that were taken back, Newton steps left out
  bool was_late = false;         ///< Somebody asked after the deadline, and cut short what was left.

  std::uint64_t work() const { return taken_back + newton + block_sweeps + direct_substeps + halvings; }
  bool has_spent_work() const { return work() >= most_work; }
  /// @{
  /// Whoever asks does less if it is late, or if work is spent.
  bool is_late() {
    was_late = was_late || (deadline && std::chrono::steady_clock::now() >= *deadline);
    return was_late;
  }
  bool is_spent() { return (gives_up_late && is_late()) || has_spent_work(); }
  /// @}
  /// Says whether a substep was taken in a way that shorter ones would hardly improve.
  bool has_given_up() const { return unsolved + elastic_substeps > 0; }

  /// Returns a tally of its own for what may be taken back, with the work that is left here.
  Tally begin_try() const {
    Tally tried;
    tried.most_work = most_work - std::min(work(), most_work);
    tried.deadline = deadline;
    tried.gives_up_late = gives_up_late;
    return tried;
  }
  /// Counts only the work of a try that was taken back.
  void take_back(const Tally& tried) {
    newton += tried.newton;
    was_late = was_late || tried.was_late;
    taken_back += tried.work() - tried.newton;
  }
  /// Counts all of a try that holds.
  void keep(const Tally& tried) {
    *this += tried;
    was_late = was_late || tried.was_late;
    taken_back += tried.taken_back;
  }
};

}  // namespace plumb::detail
