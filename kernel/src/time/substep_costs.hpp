#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace plumb::detail {

/// Learns what steps of so many substeps take, and says how many fit into a time.
///
/// A step takes what it does once, and what grows with its substeps. Where it touches, the first can be all
/// of it: what is cut or relaxed anyway is not cut less by fewer substeps, or is harder. How much grows is
/// seen where the number changes. Where it does not change for long, another one is tried once.
class SubstepCosts {
 public:
  /// Returns how many of so many substeps fit into a time (us). The first step guesses what one takes (us).
  /// If none fit, it is as many as take hardly more than one.
  std::uint32_t fit(std::uint32_t asked, double us, double guess) {
    if (asked != asked_) *this = {};
    asked_ = asked;
    const double all = count_ == 0 ? guess * asked : second_largest();
    const double some = std::max(us / all, worth * relative(1));
    const std::uint32_t most = most_within(some);
    is_trial_ = count_ > 0 && asked > 1 && (most < asked || all > us) && ++calm_ > patience_;
    if (!is_trial_) return most;
    // To take more tells about what seems to grow, and to take fewer about what does not seem to.
    return most < asked ? most + 1 : asked / 2;
  }
  /// Takes note of what a step of so many substeps took, us. One that was cut short would have taken longer.
  void took(std::uint32_t substeps, double us, bool was_cut) {
    const Cost& last = costs_[(count_ + costs_.size() - 1) % costs_.size()];
    if (count_ > 0 && last.substeps != substeps && last.us > 0 && us > 0) {
      const double before = share_;
      share_ += learns * (share_between(last, {us, substeps, was_cut}) - share_);
      if (std::abs(share_ - before) >= noticed)
        patience_ = least_patience;
      else if (is_trial_)
        patience_ = std::min(2 * patience_, most_patience);
      calm_ = 0;
    }
    if (is_trial_) calm_ = 0;
    is_trial_ = false;
    costs_[count_ % costs_.size()] = {us, substeps, was_cut};
    ++count_;
  }
  /// Returns what a step of so many substeps takes relative to one of all that are asked for.
  double relative(std::uint32_t substeps) const { return 1 - share_ * (1 - part(substeps)); }

 private:
  struct Cost {
    double us;
    std::uint32_t substeps;
    bool was_cut;
  };

  /// More substeps than fit are taken where they take no more than so many times what one takes.
  static constexpr double worth = 1.1;
  /// The share follows what one change of the number tells to this part, since a step may be long for other
  /// reasons.
  static constexpr double learns = 0.5;
  /// Another number is tried after so many steps without a change, and ever more rarely where the share moves
  /// by less than this.
  static constexpr double noticed = 0.1;
  static constexpr std::uint32_t least_patience = 16, most_patience = 1024;

  double part(std::uint32_t substeps) const { return double{1} * substeps / asked_; }

  std::uint32_t most_within(double some) const {
    constexpr double rounding = 1e-9;
    if (!(some < 1)) return asked_;
    const double most = asked_ * (1 - (1 - some) / share_) + rounding;
    return std::max(1u, static_cast<std::uint32_t>(std::max(most, 0.0)));
  }
  /// Returns the share of all substeps' cost that grows with them, as far as two costs tell it. Of one that
  /// was cut short a bound of it is known.
  double share_between(const Cost& one, const Cost& other) const {
    const Cost &few = one.substeps < other.substeps ? one : other, &more = &few == &one ? other : one;
    const double dearer = more.us / few.us;
    const double found = (dearer - 1) / (dearer * (1 - part(few.substeps)) - (1 - part(more.substeps)));
    const double share = dearer > 1 ? std::clamp(found, 0.0, 1.0) : 0;
    return std::clamp(share, more.was_cut ? share_ : 0, few.was_cut ? share_ : 1);
  }
  /// Leaves out the largest, since one step may be long because the machine did something else, if there are
  /// two. It is what all substeps take, us.
  double second_largest() const {
    std::array<double, 4> all{};
    const std::size_t known = std::min(count_, costs_.size());
    for (std::size_t i = 0; i < known; ++i) all[i] = costs_[i].us / relative(costs_[i].substeps);
    const auto end = all.begin() + static_cast<std::ptrdiff_t>(known);
    std::sort(all.begin(), end);
    return known == 1 ? all.front() : *(end - 2);
  }

  std::array<Cost, 4> costs_{};  ///< of the last steps
  std::size_t count_ = 0;
  std::uint32_t asked_ = 0;
  double share_ = 1;        ///< of what all substeps take: so much grows with their number
  std::uint32_t calm_ = 0;  ///< steps since their number changed
  std::uint32_t patience_ = least_patience;
  bool is_trial_ = false;
};

}  // namespace plumb::detail
