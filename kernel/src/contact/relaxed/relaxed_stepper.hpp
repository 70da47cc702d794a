#pragma once

#include "contact/cluster_mover.hpp"
#include "contact/platforms/ground_now.hpp"
#include "contact/relaxed/blows/crowd_blows.hpp"
#include "contact/relaxed/bodies/crowd_bodies.hpp"
#include "contact/relaxed/crowd.hpp"
#include "contact/relaxed/crowd_contacts.hpp"
#include "contact/relaxed/crowd_joints.hpp"
#include "plumb/layouts/packing.hpp"

namespace plumb::detail {

/// Moves islands that touch, or may within a step, through that step by weighted relaxation (thesis eq. 4.7).
///
/// In every sweep rods come first, colour after colour, then joints, then bodies that are inside out, then
/// contacts, so that what a sweep leaves is in rods and not in the ground. After all sweeps ground has the
/// last word over what islands press into it, or heavy things would push light ones through. While something
/// may touch, a substep is of gradient new: its velocities are those that it took, so that what lands comes
/// to rest. So it is where something is elastic.
///
/// What is fast is swept against ground and others, and kept off the planes in which it touches first. Blows
/// are swept on until rods fit, or else in halves of the substep, so that nothing is torn open.
template <class T>
class RelaxedStepper final : public ClusterMover {
 public:
  /// The settings are scaled already (scaled()).
  RelaxedStepper(Isa isa, const ContactSettings& settings, const CrowdRules& rules)
      : kernels_(&simd::kernels<T>(isa)),
        settings_(settings),
        rules_(rules),
        crowd_(simd::kernels<T>(isa)),
        contacts_(settings, simd::kernels<T>(isa)) {}

  void step(std::span<LinkageState* const> cluster, const Surroundings& surroundings,
            const ClusterRules& rules, double dt, Tally& report) override;
  bool set_stop_rule(const StopRule& rule) override {
    rules_.stop = rule;
    return true;
  }
  bool set_weights(Weights weights) override {
    rules_.weights = weights;
    crowd_.forget();
    return true;
  }
  void forget() override { crowd_.forget(); }

 private:
  /// A time to move through: when it begins, how long it is, and how much of the step is left then, s.
  struct Span {
    double start, h, left;
  };
  /// What a substep begins with: energy (J) as if nothing held the cluster, and what elastics hold.
  struct Energies {
    double moving = 0, elastic = 0;
  };
  void advance(std::span<LinkageState* const> cluster, const Surroundings& surroundings, const Span& span,
               std::uint32_t cuts, Tally& report);
  double unhurried_substep(std::span<LinkageState* const> cluster) const;
  void follow_lengths(std::span<LinkageState* const> cluster, double t);
  void count_pulls(std::span<LinkageState* const> cluster, Gradient gradient, double h);
  bool substep(std::span<LinkageState* const> cluster, const Surroundings& surroundings, const Span& span,
               bool may_halve, Tally& report);
  Gradient predict(std::span<LinkageState* const> cluster, double h);
  bool is_crushed();
  bool is_struck() const;
  double most_violated() const;
  std::uint32_t sweep_on(Gradient gradient);
  double driving_energy(std::span<LinkageState* const> cluster, const Surroundings& surroundings) const;
  double elastic_energy(std::span<LinkageState* const> cluster) const;
  void guard_energy(std::span<LinkageState* const> cluster, const Energies& before, double h, bool bounces,
                    Tally& report);
  void scatter(std::span<LinkageState* const> cluster);
  void gather(std::span<LinkageState* const> cluster, const Surroundings& surroundings, double dt);
  void begin_rows(std::span<LinkageState* const> cluster, double h);
  void freeze_broken(std::span<LinkageState* const> cluster, Tally& report);
  /// Lets bodies begin as rigid ones, with what pulls them. As rigid ones they give way to a stiff pull less
  /// than their points do, which it may then take up again: four rounds find most of it.
  void begin_rigidly() {
    constexpr int rounds = 4;
    bool may_grow = true;
    for (int i = 0; i < rounds && may_grow; ++i) {
      may_grow = joints_.pull_bodies(crowd_);
      bodies_.begin_rigidly(crowd_);
      contacts_.begin_rigidly(crowd_);
    }
  }
  bool begin_momentum();
  void sweep_held(Gradient gradient);
  void solve(Gradient gradient, Tally& report);
  void brake_joints(std::span<LinkageState* const> cluster, double h);

  /// Returns the loops over rods where they lie now.
  const simd::AccessKernels<T>& rod_kernels() const {
    return kernels_->access[static_cast<int>(crowd_.places().access())];
  }

  const simd::Kernels<T>* kernels_;
  ContactSettings settings_;
  CrowdRules rules_;
  Crowd<T> crowd_;
  GroundNow ground_;  ///< as the substep starts
  CrowdContacts<T> contacts_;
  CrowdJoints<T> joints_;
  CrowdBodies<T> bodies_;
  CrowdBlows<T> blows_;
  Array<Vec3> rigid_;
  SweepMomentum<T> momentum_;
  Array<SweptNumbers<T>> swept_;
  std::uint32_t most_sweeps_ = 1;  ///< of a substep
  double recovery_rate_ = 0;
  double step_ = 0, driving_energy_ = 0;  ///< s, J, of the step
  double nominal_ = 0;                    ///< s, of substeps that are not cut
  Team* team_ = nullptr;                  ///< that may help
  bool is_hit_ = false;                   ///< hulls move fast near what they may touch
  bool is_pressed_ = false;               ///< rods are off their lengths since ground is in their way
  double most_crushed_ = 0;               ///< the share up to which a blow to hulls may violate rods
  bool is_in_ground_ = false;             ///< sweeps have left the middle of something there
  bool counts_ = false;                   ///< some island's pulls count
  bool leaves_ = false;                   ///< what sweeps leave is kept in shorter substeps
};

extern template class RelaxedStepper<float>;
extern template class RelaxedStepper<double>;

}  // namespace plumb::detail
