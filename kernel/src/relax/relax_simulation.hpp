#pragma once

#include <memory>
#include <vector>

#include "relax/block.hpp"
#include "relax/relax.hpp"
#include "relax/schedule.hpp"
#include "step/places.hpp"
#include "step/simulation.hpp"
#include "threads/sharing.hpp"
#include "threads/workers.hpp"
#include "time/verlet.hpp"

namespace plumb::detail {

/// Mass-weighted relaxation of all rods of a scene, in numbers of type T.
template <class T>
class RelaxSimulation final : public Simulation {
 public:
  RelaxSimulation(const Scene& scene, const Settings& settings);

  StepReport step(double dt) override;
  void set_stop_rule(const StopRule& rule) override;
  void set_weights(Weights weights) override;
  void set_force(std::uint32_t particle, Vec3 force) override;
  void move_anchor(std::uint32_t particle, Vec3 target) override;
  Vec3 position(std::uint32_t particle) const override;
  Vec3 velocity(std::uint32_t particle) const override;
  std::uint64_t state_hash() const override;
  const WorldInfo& info() const override { return info_; }

 private:
  struct Anchor {
    std::uint32_t particle;
    Vec3 target;
  };

  void make_blocks(const Scene& scene);
  void fill_info(const Scene& scene);
  void describe_blocks();

  void start_step(double h);
  void start_displacements(double h);
  void change_step(double h);
  void write_kicks();
  void start_anchors();
  void run_blocks(RelaxCounters& counters);
  void finish_anchors();

  bool uses_threads() const;
  bool is_movable(std::uint32_t particle) const { return constants_.inverse_mass[particle] > 0; }
  Vec3 acceleration(std::uint32_t particle) const;

  /// f(block, slot, particle) for every place but those of frozen islands.
  template <class F>
  void for_slots(F&& f);
  /// f(block, slot) for every place of a particle.
  template <class F>
  void for_places(std::uint32_t particle, F&& f);

  Settings settings_;
  Verlet verlet_;
  SharingThresholds thresholds_ = sharing_thresholds;
  Vec3 gravity_;
  Constants constants_;
  Workers workers_;
  const simd::Kernels<T>& kernels_;
  std::vector<Vec3> initial_velocities_;

  std::vector<Block<T>> blocks_;
  Places places_;
  Schedule schedule_;

  double h_ = 0;  ///< s, of the last substep
  bool starts_off_length_ = false;
  bool time_advanced_ = false;
  bool kicks_stale_ = true;
  std::vector<Vec3> forces_;
  std::vector<Anchor> anchors_;           ///< to be moved in the next step
  std::vector<std::uint32_t> anchor_of_;  ///< per particle: where in anchors_, or none; empty until one moves
  WorldInfo info_;
};

extern template class RelaxSimulation<float>;
extern template class RelaxSimulation<double>;

}  // namespace plumb::detail
