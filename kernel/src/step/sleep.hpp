#pragma once

#include <cstdint>
#include <optional>

#include "interface/problems.hpp"
#include "interface/solver.hpp"
#include "plumb/layouts/memory.hpp"
#include "step/places.hpp"

namespace plumb::detail {

/// Names a piece of a solver, which one thread takes through a step.
struct Task {
  std::uint32_t solver, piece;
  double still_time = 0;  ///< s, for how long it has moved by rounding only
  bool is_still = false;  ///< after this step
  bool asleep = false;
  bool has_broken = false;  ///< a rod broke in this step, so that what hangs from it is about to move
  Troubles troubles = 0;    ///< what went wrong in the last step
  double dt = 0;            ///< s, of the last step that it took awake
};

/// Says what became of the solver of a number: it stays, another one took its place, or nothing needs it.
enum class Seat : std::uint8_t { kept, taken, free };

/// Decides which pieces stand still. A piece sleeps once its particles have moved by rounding only for
/// Settings::sleep_time. Its velocities are then zero, and a step would lead back to where it is, so it is
/// not computed. A force, an anchor that moves, or a new rule wake it.
///
/// Islands that may touch sleep by speed, as their solver decides (contact/clusters.hpp).
class Sleep {
 public:
  void start(std::span<const std::unique_ptr<Solver>> solvers, const Settings& settings);

  /// Goes on with other solvers. Those that took a place start awake.
  void exchange(std::span<const std::unique_ptr<Solver>> solvers, std::span<const Seat> seats);

  /// Puts a task to rest whose particles stand still.
  void put_to_rest(std::span<const std::unique_ptr<Solver>> solvers, std::size_t task);

  std::span<Task> tasks() { return tasks_; }
  std::span<const Task> tasks() const { return tasks_; }
  /// Returns the number of the task that has a place, if its solver's pieces do not change.
  std::optional<std::size_t> task_of(std::span<const std::unique_ptr<Solver>> solvers, Place place) const {
    const Solver& solver = *solvers[place.solver];
    if (solver.has_changing_pieces()) return {};
    return first_task_[place.solver] + solver.piece_of(place.slot);
  }
  bool all_asleep() const { return awake_ == 0; }
  /// Counts how often a piece fell asleep or woke, for whoever keeps an eye on it.
  std::uint64_t changes() const { return changes_; }

  /// Returns the speed (m/s) below which a piece's motion is rounding.
  double rounding_speed(const Solver& solver, std::uint32_t piece) const {
    return relative_speed_ * solver.size(piece);
  }
  bool is_asleep(std::span<const std::unique_ptr<Solver>> solvers, Place place) const {
    return tasks_[*task_of(solvers, place)].asleep;
  }

  template <class Archive>
  void archive(Archive& archive) {
    awake_ = 0;
    for (Task& task : tasks_) {
      auto& [solver, piece, still_time, is_still, asleep, has_broken, troubles, dt] = task;
      archive(still_time, is_still, asleep, has_broken, troubles, dt);
      if (!asleep) ++awake_;
    }
  }

  void wake(std::span<const std::unique_ptr<Solver>> solvers, Place place);
  void wake_all(std::span<const std::unique_ptr<Solver>> solvers);
  /// Ends a step of dt (s): puts to rest what stood still for long enough. Returns how many islands that
  /// were.
  std::uint32_t settle(std::span<const std::unique_ptr<Solver>> solvers, double dt);

 private:
  void wake(std::span<const std::unique_ptr<Solver>> solvers, Task& task);

  Array<Task> tasks_, before_;       ///< The latter is room for an exchange.
  Array<std::uint32_t> first_task_;  ///< by solver
  std::uint32_t awake_ = 0;
  std::uint64_t changes_ = 0;
  double relative_speed_ = 0;  ///< 1/s: a piece's speed of rounding per metre of its size
  double sleep_time_ = 0;      ///< time (s) of standing still before a piece sleeps
};

}  // namespace plumb::detail
