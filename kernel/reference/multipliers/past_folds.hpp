#pragma once

#include <array>
#include <cstdint>
#include <utility>

#include "reference/mechanical_system.hpp"

namespace plumb::detail {

/// Steps past places where constraints are about to be redundant, as where a linkage lies in line. There the
/// equations hardly say how it could fold. A substep with such a stage is taken as two of unequal lengths,
/// whose stages lie elsewhere.
class PastFolds {
 public:
  /// Takes a substep of h seconds by `advance(state, drive, h)`. take_miss() returns the largest share of its
  /// terms by which an equation was missed since it was asked last.
  template <class Advance, class TakeMiss>
  void step(MechanicalState& state, const Drive& drive, double h, Advance&& advance, TakeMiss&& take_miss,
            std::size_t cuts = 0) {
    before_[cuts] = state;
    take_miss();
    advance(state, drive, h);
    const bool is_good = take_miss() <= largest_miss;
    if (is_good) useless_ = 0;
    if (is_good || useless_ >= most_useless) return;
    if (cuts + 1 == before_.size()) {
      ++useless_;
      return;
    }
    std::swap(state, before_[cuts]);
    const double first = first_share * h;
    step(state, drive, first, advance, take_miss, cuts + 1);
    Drive later = drive;
    for (std::uint32_t i = 0; i < later.anchors.size(); ++i) later.anchors[i] = drive.anchor(i, first);
    step(state, later, h - first, advance, take_miss, cuts + 1);
  }

 private:
  /// Solutions that miss an equation by more than this share of its terms are not taken.
  static constexpr double largest_miss = 1e-10;
  static constexpr double first_share = 0.38;
  static constexpr std::uint32_t most_useless = 20;

  std::array<MechanicalState, 5> before_;  ///< by cuts
  std::uint32_t useless_ = 0;              ///< cuts in a row that did not help; where all are, none is made
};

}  // namespace plumb::detail
