#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// Knows which rigid rods of an island change their length, or have. A constraint is (|d|²/M² - s)/2 with M
/// the length of its kind and s = L²/M², which is 1 for all others.
class RodLengths {
 public:
  /// Holds how a rod changes. The length is that at a step's start.
  struct Change {
    std::uint32_t rod;            ///< the island's number
    double made, length;          ///< m; the first is that of the kind
    double rate = 0, went = 0;    ///< m/s, in this step, and in what was done last
    double half_square_rate = 0;  ///< 1/s, half of the rate of s where follow() was called last
    double pulled = 0, work = 0;  ///< N s, see begin_pulls(); J, what the rod did in this step
  };

  /// Lets one of `rods` be `length` (m) long at a step's start, and change it by `rate` (m/s).
  void set(std::uint32_t rod, std::uint32_t rods, double made, double length, double rate) {
    squares_.resize(rods, 1);
    if (!find(rod))
      changes_.insert(changes_.begin() + place_of(rod), {.rod = rod, .made = made, .length = made});
    change(rod, length, rate);
  }
  /// Does so with a rod that has changed before. Returns false if it has not.
  bool change(std::uint32_t rod, double length, double rate) {
    if (!find(rod)) return false;
    Change& of = changes_[static_cast<std::size_t>(place_of(rod))];
    of.length = length;
    of.went = std::exchange(of.rate, rate);
    follow(of, 0);
    return true;
  }
  /// Returns how a rod changes, or null.
  const Change* find(std::uint32_t rod) const {
    const auto at = static_cast<std::size_t>(place_of(rod));
    return at < changes_.size() && changes_[at].rod == rod ? &changes_[at] : nullptr;
  }
  /// Lets rod `rod` of `rods` change as one of another island does, whose kind has it as long.
  void take(const Change& from, std::uint32_t rod, std::uint32_t rods) {
    changes_.insert(changes_.begin() + place_of(rod), from)->rod = rod;
    squares_.resize(rods, 1);
    follow(0);
  }
  /// Finds how long rods are `t` (s) after the step's start.
  void follow(double t) {
    for (Change& each : changes_) follow(each, t);
  }
  /// Lets velocities at the step's start be those of the rates before it.
  void follow_last() {
    follow(0);
    for (Change& each : changes_) each.half_square_rate = each.length * each.went / (each.made * each.made);
  }
  /// Begins to add up work, of a step. Then a substep does, by impulses (N s) of all rods before and after
  /// it. What jumps to another rate does so at the mean of both.
  void begin_step() {
    for (Change& each : changes_) each.work = 0;
  }
  void begin_pulls(std::span<const double> rods) {
    for (Change& each : changes_) each.pulled = rods[each.rod];
  }
  void end_pulls(std::span<const double> rods) {
    for (Change& each : changes_) each.work -= (rods[each.rod] - each.pulled) * (each.rate + each.went) / 2;
  }
  /// Notes that a substep was done at these rates.
  void end_substep() {
    for (Change& each : changes_) each.went = each.rate;
  }

  std::span<const Change> changes() const { return changes_; }
  /// Returns s by rod; none if all are 1.
  std::span<const double> squares() const { return squares_; }
  double square(std::uint32_t rod) const { return squares_.empty() ? 1 : squares_[rod]; }
  bool move() const {
    return std::any_of(changes_.begin(), changes_.end(), [](const Change& each) { return each.rate != 0; });
  }
  /// Returns whether some rate is not that of the last substep.
  bool jump() const {
    return std::any_of(changes_.begin(), changes_.end(),
                       [](const Change& each) { return each.rate != each.went; });
  }
  /// Returns how fast (m/s) they move what hangs from all of them at most.
  double speed() const {
    double sum = 0;
    for (const Change& each : changes_) sum += std::abs(each.rate);
    return sum;
  }

  template <class Archive>
  void archive(Archive& archive) {
    auto& [changes, squares] = *this;
    archive(changes, squares);
  }

 private:
  std::ptrdiff_t place_of(std::uint32_t rod) const {
    return std::partition_point(changes_.begin(), changes_.end(),
                                [&](const Change& each) { return each.rod < rod; }) -
           changes_.begin();
  }
  void follow(Change& of, double t) {
    const double share = (of.length + t * of.rate) / of.made;
    squares_[of.rod] = share * share;
    of.half_square_rate = share * of.rate / of.made;
  }

  Array<Change> changes_;  ///< by rod
  Array<double> squares_;
};

template <class Archive>
void visit_members(Archive& archive, RodLengths::Change& of) {
  auto& [rod, made, length, rate, went, half_square_rate, pulled, work] = of;
  archive(rod, made, length, rate, went, half_square_rate, work);
}

}  // namespace plumb::detail
