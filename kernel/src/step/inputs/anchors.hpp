#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <utility>

#include "interface/solver.hpp"
#include "plumb/layouts/memory.hpp"
#include "step/places.hpp"

namespace plumb::detail {

/// Knows where fixed particles are, and where they go in the next step.
class Anchors {
 public:
  Anchors(const Scene& scene, std::size_t solvers);

  std::size_t count() const { return fixed_.size(); }
  bool is_fixed(std::uint32_t particle) const { return fixed_[particle] != 0; }
  /// Calls f(particle) for each fixed one.
  template <class F>
  void for_fixed(F&& f) const {
    for_any_of(f, fixed_, fixed_);
  }
  /// Returns whether it is fixed, or will be from the next step on.
  bool will_be_fixed(std::uint32_t particle) const { return will_be_fixed_[particle] != 0; }
  const Array<std::uint8_t>& will_be_fixed() const { return will_be_fixed_; }
  /// Says so. What is not to be fixed after all forgets where it was to go.
  void order(std::uint32_t particle, bool is_fixed);
  /// Fixes a particle at `position` (m), from where it goes to a target that it may have by now. It came
  /// there at `velocity` (m/s), as an anchor that moved in a step of `dt` (s).
  void fix(std::uint32_t particle, Vec3 position, Vec3 velocity, double dt);
  /// Puts a fixed particle elsewhere, where it stays in the next step, as fast as it was.
  void put(std::uint32_t particle, Vec3 position);
  /// Frees a particle, which forgets where it was to go.
  void free(std::uint32_t particle);
  /// Takes at least so many particles. New ones are as removed ones.
  void grow(std::size_t particles);
  /// Gives a number to a particle that was removed, or is new.
  void add(std::uint32_t particle, bool is_fixed, Vec3 position);
  /// Lets a particle be a fixed one at the origin, which nobody moves.
  void remove(std::uint32_t particle);
  /// Returns the velocity (m/s) of a fixed particle in the last step.
  Vec3 last_velocity(std::uint32_t particle) const;
  Vec3 position(std::uint32_t particle) const { return positions_[particle]; }
  /// Returns the velocity (m/s) of a fixed particle in the next step, of dt (s).
  Vec3 velocity(std::uint32_t particle, double dt) const {
    return (1 / dt) * (targets_[particle] - positions_[particle]);
  }
  /// Returns whether some anchor moves in the next step, or has stopped after the last.
  bool any_paths() const { return !moving_.empty() || !settling_.empty() || !concerned_.empty(); }

  void set_target(std::uint32_t particle, Vec3 target);
  /// Calls f(particle, path) for anchors that moved in the last step, with their paths then.
  template <class F>
  void for_moved(F&& f) const {
    for (const auto& [particle, path] : moved_) f(particle, path);
  }
  /// Lets a solver learn of the next paths, as one that learned of the last.
  void settle(std::uint32_t solver) { settling_.push_back(solver); }
  /// Forgets a solver that is no more.
  void forget(std::uint32_t solver);
  /// Goes on as the same anchors of another world did. All solvers of this one, which are new, are to learn
  /// of the next paths.
  void go_on_from(const Anchors& from);
  /// Takes another number of solvers.
  void resize(std::size_t solvers) {
    is_concerned_.resize(solvers, 0);
    concerned_.reserve(is_concerned_.capacity());
    settling_.reserve(is_concerned_.capacity());
  }

  /// Calls f(place) for every place of an anchor that will leave where it is.
  template <class F>
  void for_moving_places(const Places& places, F&& f) const {
    for (const std::uint32_t particle : moving_)
      if (targets_[particle] != positions_[particle])
        for (const Place place : places.of(particle)) f(place);
  }
  template <class Archive>
  void archive(Archive& archive) {
    auto& [fixed, will_be_fixed, positions, targets, has_target, moving, concerned, settling, moved, dt,
           is_concerned] = *this;
    for (const std::uint32_t particle : moving) has_target[particle] = 0;
    archive(moving, concerned, settling, moved, dt, is_concerned);
    for (const std::uint32_t particle : moving) has_target[particle] = 1;
    for_any_of([&, this](std::uint32_t particle) { archive(positions_[particle], targets_[particle]); },
               fixed, will_be_fixed);
  }
  /// Tells solvers the paths of a step of dt (s). Once it is done, puts the anchors at their targets exactly,
  /// without the rounding of the way.
  void begin_step(double dt, const Places& places, std::span<const std::unique_ptr<Solver>> solvers);
  void end_step(const Places& places, std::span<const std::unique_ptr<Solver>> solvers);

 private:
  void concern(std::uint32_t solver);
  void forget_target(std::uint32_t particle);
  /// Calls f(particle) for each that has a 1 in either of two lists. Most have none, and are passed over by
  /// many at once.
  template <class F>
  static void for_any_of(F&& f, const Array<std::uint8_t>& one, const Array<std::uint8_t>& other) {
    constexpr std::size_t many = 64;
    const auto eight_of = [&](std::size_t first) {
      std::uint64_t a = 0, b = 0;
      std::memcpy(&a, &one[first], sizeof a);
      std::memcpy(&b, &other[first], sizeof b);
      return a | b;
    };
    std::size_t first = 0;
    for (; first + many <= one.size(); first += many) {
      std::uint64_t any = 0;
      for (std::size_t i = 0; i < many; i += 8) any |= eight_of(first + i);
      if (any == 0) continue;
      for (std::size_t i = 0; i < many; i += 8)
        for (std::uint64_t left = eight_of(first + i); left != 0; left &= left - 1)
          f(static_cast<std::uint32_t>(first + i) + static_cast<std::uint32_t>(std::countr_zero(left)) / 8);
    }
    for (; first < one.size(); ++first)
      if (one[first] != 0 || other[first] != 0) f(static_cast<std::uint32_t>(first));
  }

  Array<std::uint8_t> fixed_, will_be_fixed_;  ///< by particle
  Array<Vec3> positions_, targets_;            ///< m, by particle; entries of movable ones are unused
  Array<std::uint8_t> has_target_;
  Array<std::uint32_t> moving_;                        ///< particles with a target of their own
  Array<std::uint32_t> concerned_;                     ///< solvers that learn of paths in this step
  Array<std::uint32_t> settling_;                      ///< solvers that learned of paths in the last step
  Array<std::pair<std::uint32_t, AnchorMove>> moved_;  ///< in the last step
  double dt_ = 0;                                      ///< s, of that step
  Array<std::uint8_t> is_concerned_;
};

template <class Archive>
void visit_members(Archive& archive, AnchorMove& of) {
  auto& [from, to, dt] = of;
  archive(from, to, dt);
}

}  // namespace plumb::detail
