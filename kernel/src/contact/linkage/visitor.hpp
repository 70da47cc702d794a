#pragma once

#include <memory>
#include <span>

#include "contact/linkage/linkage_state.hpp"
#include "interface/solver.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// Says by which gradient contact moves islands where it solves them.
struct IslandGradients {
  explicit IslandGradients(const Settings& settings);
  /// Nets are damped at home, and while they visit gradient old moves them.
  Gradient of(const Linkage& kind, bool has_home) const {
    if (!has_home) return homeless;
    return kind.has_loops() ? Gradient::old : visiting;
  }

  Gradient homeless;  ///< that of islands without a home
  Gradient visiting;  ///< that of others, while nothing pushes them
};

/// Ground holds a place of an island: no closer to it along a unit vector than so many m.
struct Hold {
  Combination at;
  Vec3 along;
  double least;
};

/// Holds numbers that projections need. They are kept, so that steps allocate nothing.
struct ProjectionWork {
  Array<Vec3> before, momentum;
  Array<simd::Quad> unknowns;
  Array<Hold> holds;           ///< by which positions are pushed out of ground
  Array<Hold> walls{};         ///< which they may not pass
  Array<std::uint8_t> acts{};  ///< by elastic, whether it is a rigid rod that holds, as cables do when taut
  bool is_new = false;         ///< Some act that did not before.
};

/// An island of particles and rods that has a solver of its own, its home, and visits the contact solver
/// while it may touch something. Lanes, precision, gradient and accuracy are those of its home until then.
class Visitor {
 public:
  Visitor() = default;
  /// `slots` are those of the island's movable particles at home, in the island's order.
  Visitor(Solver& home, std::uint32_t number, Array<Slot> slots)
      : home_(&home), number_(number), slots_(std::move(slots)) {}

  bool has_home() const { return home_ != nullptr; }
  bool is_at_home() const { return home_ != nullptr && !is_visiting_; }

  /// Reads the positions of an island at home. Returns about the speed of the fastest particle, m/s,
  /// anchors that move in this step among them.
  double look(LinkageState& state) const;
  /// Takes the island from its home: reads positions and velocities. With `work` it makes them fit the rods,
  /// which a home may leave stretched; velocities do not change by that.
  void come(LinkageState& state, ProjectionWork* work);
  /// Goes on visiting as an island that was cut out of one that did.
  void stay() {
    home_->set_away(slots_.front(), true);
    is_visiting_ = true;
  }
  /// Ends the visit of an island that its home ends next. There it counts as moved elsewhere no more.
  void end() {
    if (has_home() && is_visiting_) home_->set_away(slots_.front(), false);
    *this = {};
  }
  /// Gives positions and velocities back.
  void leave(const LinkageState& state);
  /// The number of the home among the world's solvers, and a slot there: they tell the island's piece.
  std::uint32_t number() const { return number_; }
  Slot first_slot() const { return slots_.front(); }

  template <class Archive>
  void archive(Archive& archive) {
    auto& [home, number, slots, is_visiting] = *this;
    archive(is_visiting);
  }

 private:
  Solver* home_ = nullptr;
  std::uint32_t number_ = 0;
  Array<Slot> slots_;
  bool is_visiting_ = false;
};

/// Rods fit that projection leaves with no more than this strain, since sweeps do. Those of nets
/// that it leaves with more than the second do not fit.
inline constexpr double most_left = 1e-2, noticed = 1e-6;
/// Moves an island's particles, by mass, so that its constraints hold, and places that ground holds are where
/// it lets them be: Newton's method without velocities.
/// Where that does not converge nothing moves, and the largest violation is returned; else 0.
double project_positions(LinkageState& state, ProjectionWork& work);
/// Takes from the velocities what constraints forbid. Returns the largest change, m/s, or 0 where that cannot
/// be found and nothing changes.
double project_velocities(LinkageState& state, ProjectionWork& work);

}  // namespace plumb::detail
