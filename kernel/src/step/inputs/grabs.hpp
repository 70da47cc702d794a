#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "interface/solver.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/loads.hpp"
#include "step/breaks/numbers.hpp"
#include "step/places.hpp"

namespace plumb::detail {

/// Knows what is grabbed, where it is pulled, and what that did in the last step.
class Grabs {
 public:
  using Solvers = std::span<const std::unique_ptr<Solver>>;

  const Numbers& numbers() const { return numbers_; }
  bool any() const { return count_ > 0; }

  /// Refuses a grab that no solver of its place can take. Else takes it, and returns its number.
  std::uint32_t add(const Grab& grab, const Places& places, Solvers solvers);
  void end(std::uint32_t number, const Places& places, Solvers solvers);
  void set_target(std::uint32_t number, Vec3 target) {
    entries_[number].goal = target;
    entries_[number].is_sent = true;
  }

  const Point& place(std::uint32_t number) const { return entries_[number].grab.at; }
  Vec3 target(std::uint32_t number) const { return entries_[number].grab.target; }  ///< m, where it is now
  /// Returns the mean force (N) of the last step, and the power (W). They are NaN before the first.
  Vec3 force(std::uint32_t number) const { return entries_[number].force; }
  double power(std::uint32_t number) const { return entries_[number].power; }

  /// Calls f(number) for grabs of which `is_of(particle)` says that a particle is meant.
  template <class IsOf, class F>
  void for_grabs_of(IsOf&& is_of, F&& f) const {
    for (std::uint32_t i = 0; count_ > 0 && i < entries_.size(); ++i) {
      if (!numbers_.has(i)) continue;
      for (std::size_t k = 0; k < 4; ++k)
        if (entries_[i].grab.at.weights[k] != 0 && is_of(entries_[i].grab.at.particles[k])) {
          f(i);
          break;
        }
    }
  }
  /// Calls f(place) in the islands of grabs whose targets move in the next step.
  template <class F>
  void for_moving_places(const Places& places, F&& f) const {
    for (std::uint32_t i = 0; count_ > 0 && i < entries_.size(); ++i)
      if (numbers_.has(i) && entries_[i].is_sent && entries_[i].goal != entries_[i].grab.target)
        for_homes(i, places, f);
  }
  /// Calls f(place) in a grab's island, for every solver that has it.
  template <class F>
  void for_homes(std::uint32_t number, const Places& places, F&& f) const {
    for (const Place place : places.of(leader_of(entries_[number].grab.at, places))) f(place);
  }

  /// Takes a grab from the solvers of its place for a while, or gives it to those that it has now.
  void take_out(std::uint32_t number, const Places& places, Solvers solvers) const;
  void put_in(std::uint32_t number, const Places& places, Solvers solvers) const;

  /// Returns whether the solvers that have its place now can take it.
  bool fits(std::uint32_t number, const Places& places, Solvers solvers) const;

  /// Tells solvers of the targets' ways in a step of `dt` (s), and that they are there. What sleeps, as
  /// is_asleep(particle) says, is pulled as in its last step awake.
  void begin_step(double dt, const Places& places, Solvers solvers);
  template <class IsAsleep>
  void end_step(double dt, const Places& places, Solvers solvers, IsAsleep&& is_asleep) {
    for (std::uint32_t i = 0; count_ > 0 && i < entries_.size(); ++i) {
      if (!numbers_.has(i)) continue;
      if (!is_asleep(leader_of(entries_[i].grab.at, places))) measure(i, dt, places, solvers);
      arrive(i, places, solvers);
    }
  }

  /// Lists who grabs what, before solvers list what they know of it.
  template <class Archive>
  void archive(Archive& archive, const Places& places, Solvers solvers) {
    const auto for_all = [&](auto&& f) {
      for (std::uint32_t i = 0; i < entries_.size(); ++i)
        if (numbers_.has(i)) f(i);
    };
    if (archive.restores()) for_all([&](std::uint32_t i) { take_out(i, places, solvers); });
    archive(numbers_, entries_, count_);
    if (archive.restores()) for_all([&](std::uint32_t i) { put_in(i, places, solvers); });
  }

 private:
  struct Entry {
    Grab grab{};  ///< with its target where the next step starts
    Vec3 goal{};  ///< m, where that is sent
    bool is_sent = false, moves = false;
    Vec3 force{};
    double power = 0;
  };
  template <class Archive>
  friend void visit_members(Archive& archive, Entry& of) {
    auto& [grab, goal, is_sent, moves, force, power] = of;
    archive(grab.at.particles, grab.at.weights, grab.target, grab.stiffness, grab.damping, goal, is_sent,
            moves, force, power);
  }
  template <class F>
  static void for_places(const Entry& entry, const Places& places, F&& f) {
    for (std::size_t k = 0; k < 4; ++k)
      if (entry.grab.at.weights[k] != 0)
        for (const Place place : places.of(entry.grab.at.particles[k])) f(place);
  }
  /// Returns a particle of a place that is in its island alone, as movable ones are.
  static std::uint32_t leader_of(const Point& at, const Places& places);
  static const char* refusal_of(const Entry& entry, const Places& places, Solvers solvers);
  void measure(std::uint32_t number, double dt, const Places& places, Solvers solvers);
  void arrive(std::uint32_t number, const Places& places, Solvers solvers);
  template <class F>
  static void for_shares(const Entry& entry, const Places& places, Solvers solvers, F&& f);

  Numbers numbers_{0};
  Array<Entry> entries_;     ///< by number
  std::uint32_t count_ = 0;  ///< of those that there are
};

}  // namespace plumb::detail
