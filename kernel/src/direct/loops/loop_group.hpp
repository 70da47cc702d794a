#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "direct/loops/loop_stepper.hpp"
#include "plumb/layouts/islands.hpp"
#include "time/accuracy_control.hpp"

namespace plumb::detail {

/// The islands with loops of a scene. Particles by their number in the scene.
class LoopGroup {
 public:
  /// `estimates`: whether errors are estimated from accelerations, which islands then keep.
  LoopGroup(const Scene& scene, Gradient gradient, Isa isa, bool estimates = false,
            std::uint32_t time_order = 2);

  /// Takes islands that are `local` all alike.
  void add(const Scene& scene, MassModel model, const layouts::Islands& islands,
           std::span<const std::uint32_t> equal, const layouts::Graph& local);

  /// See LoopStepper.
  void set_line_tolerance(double stretch) { stepper_.set_line_tolerance(stretch); }

  std::uint32_t size() const { return static_cast<std::uint32_t>(islands_.size()); }
  bool holds(std::uint32_t particle) const { return places_[particle].island != nowhere; }
  std::uint32_t island(std::uint32_t particle) const { return places_[particle].island; }

  /// Different islands may be advanced at the same time.
  void advance(std::uint32_t island, double h, std::uint32_t substeps, DirectCounters& counters);
  /// With as many substeps as accuracy wants.
  void advance(std::uint32_t island, double dt, AccuracyControl control, DirectCounters& counters);

  Vec3 position(std::uint32_t particle) const;
  Vec3 displacement(std::uint32_t particle) const;  ///< as it is stored, for a hash
  Vec3 velocity(std::uint32_t particle) const;
  void set_force(std::uint32_t particle, Vec3 newton);

  /// Brings an island's rods to their lengths by one step of `h` (s), too short for loads to move it. False
  /// if that cannot be solved; it stays as it is then.
  bool project_positions(std::uint32_t island, double h);
  /// Initial velocities (m/s), which project_velocities() then makes fit the rods.
  void set_velocity(std::uint32_t particle, Vec3 velocity);
  void project_velocities();

  /// For every fixed particle that moves in the next step its velocity (m/s), and start_anchors(); after that
  /// step where it is now, and finish_anchors().
  void set_anchor_velocity(std::uint32_t particle, Vec3 velocity);
  void start_anchors();
  void set_anchor_position(std::uint32_t particle, Vec3 position);
  void finish_anchors();

 private:
  static constexpr std::uint32_t nowhere = 0xffffffff;
  struct Place {
    std::uint32_t island = nowhere, vertex = 0;
  };
  struct Island {
    LoopState state;
    LoopWorkspace work;
    std::vector<double> velocity;  ///< m/s, 3 per node; at the end of the last step if known
    bool anchors_changed = false, velocity_known = false;
    // With accuracy:
    LoopMotion start{}, stretch{};  ///< at the start of the step, of a stretch
    std::vector<double> coarse{};   ///< m, 3 per vertex: where half as many substeps take it
    double substep = 0;             ///< s, that the last step thought best; 0: none yet
  };

  void begin_step(Island& island) const;
  void find_velocities(Island& island) const;
  /// The largest error estimate of the substeps.
  double advance(Island& island, double h, std::uint32_t substeps, DirectCounters& counters) const;
  AccuracyControl::Attempt advance_and_compare(Island& island, double h, std::uint32_t substeps,
                                               const AccuracyControl& control,
                                               DirectCounters& counters) const;

  Gradient gradient_;
  Isa isa_;
  bool estimates_;
  LoopStepper stepper_;
  mutable std::vector<Island> islands_;
  std::vector<Place> places_;                 ///< of movable particles
  std::vector<std::vector<Place>> fixed_in_;  ///< of fixed ones
};

}  // namespace plumb::detail
