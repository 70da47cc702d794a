#pragma once

#include <memory>
#include <span>

#include "interface/island_sets.hpp"
#include "interface/made_solver.hpp"
#include "plumb/layouts/memory.hpp"
#include "reference/mechanical_system.hpp"

namespace plumb::detail {

/// Moves one island by one of the thesis's other methods. Slots are its particles.
class ReferenceSolver final : public Solver {
 public:
  /// Takes an island and its equations. `diagonal` (m) of the scene is what an accuracy is relative to.
  ReferenceSolver(const Scene& island, std::unique_ptr<MechanicalSystem> system, double diagonal);

  std::uint32_t islands(std::uint32_t) const override { return 1; }
  double advance(std::uint32_t, double h, std::uint32_t count, unsigned, Tally& report) override;

  bool takes_accuracy() const override { return false; }
  double& best_substep(std::uint32_t) override { return best_substep_; }
  void save(std::uint32_t, Saved) override {}
  void restore(std::uint32_t, Saved) override {}
  void mark(std::uint32_t) override {}
  double distance_from_mark(std::uint32_t) const override { return 0; }

  bool can_rest() const override { return false; }
  bool is_slower(std::uint32_t, double) const override { return false; }
  void rest(std::uint32_t) override {}
  double size(std::uint32_t) const override { return 1; }

  Vec3 position(Slot slot) const override;
  Vec3 velocity(Slot slot) const override;
  void add_to_hash(Slot slot, StateHash& hash) const override;
  double read(std::span<const Slot>, std::span<Vec3>) const override { return 0; }
  void set_force(Slot slot, Vec3 newton) override { drive_.forces[slot] = newton; }
  void move_anchor(Slot slot, const AnchorMove& move) override;
  void end_anchors() override;
  void place_anchor(Slot slot, Vec3 target) override { drive_.anchors[slot] = target; }
  void set_motion(Slot, Vec3, Vec3) override {}
  void set_away(Slot, bool) override {}
  void archive(Archive&) override {}
  bool has_archive() const override { return false; }
  bool is_away(std::uint32_t) const override { return frozen_; }
  void describe(WorldInfo&) const override {}

 private:
  std::unique_ptr<MechanicalSystem> system_;
  MechanicalState state_, last_;  ///< the state now, and the last that was finite
  Drive drive_;
  Array<std::uint8_t> fixed_;
  bool frozen_ = false;
  double best_substep_ = 0;
};

/// Makes the solvers of islands by the settings' method: springs, multipliers or featherstone. Throws
/// InputError if the method cannot move one of them.
Array<MadeSolver> make_reference_solvers(const Scene& scene, const IslandSets& sets, const Settings& settings,
                                         StartReport& report);
/// Makes the solver of an island with bodies or joints by multipliers or featherstone. Throws InputError if
/// the method cannot move it.
MadeSolver make_jointed_solver(const Scene& island, std::span<const std::uint32_t> particles,
                               const Settings& settings, StartReport& report);

}  // namespace plumb::detail
