#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <memory>

#include "plumb/layouts/memory.hpp"
#include "reference/mechanical_system.hpp"
#include "reference/springs/implicit_euler.hpp"

namespace plumb::detail {

/// Holds particles and rods together by stiff springs (thesis §3.3). What moves are bodies, each with a
/// diagonal mass matrix. A body is a point with 3 unknowns, or a slender rod with 6: its velocity and angular
/// velocity, both in the world's axes.
class SpringSystem : public MechanicalSystem {
 public:
  void accelerations(const MechanicalState& state, const Drive& drive, double t, Eigen::VectorXd& out) final;
  void advance(MechanicalState& state, const Drive& drive, double h) final;
  void report(const MechanicalState& state, const Drive& drive, StepReport& out) override;

  /// Gives the mass (kg) or moment of inertia (kg m²) that belongs to every velocity.
  const Eigen::VectorXd& masses() const { return masses_; }
  double drag() const { return scene_.drag; }
  /// Gives the number of velocities of one body, 3 or 6.
  virtual Eigen::Index body_size() const = 0;
  /// Gives the force (N) or torque (N m) on every velocity: springs, gravity, drag and what acts from
  /// outside.
  virtual void find_forces(const MechanicalState& state, const Drive& drive, double t,
                           Eigen::VectorXd& out) = 0;
  /// Lists the springs near where they are now, always the same ones in the same order.
  virtual void linearize(const MechanicalState& state, const Drive& drive, double t, Linearization& out) = 0;
  /// Gives kinetic energy, that of weight and that of springs, in J, of the bodies as they are, joints open.
  virtual double energy(const MechanicalState& state, const Drive& drive) const = 0;

 protected:
  SpringSystem(const Scene& island, const Settings& settings);
  const Scene& scene() const { return scene_; }
  const Settings& settings() const { return settings_; }

  Eigen::VectorXd masses_;

 private:
  void advance_adaptively(MechanicalState& state, const Drive& drive, double h);
  double rms_difference(const MechanicalState& a, const MechanicalState& b) const;

  Scene scene_;
  Settings settings_;
  Array<std::uint32_t> movable_;  ///< Numbers of movable particles.
  ImplicitEuler implicit_;
  MechanicalState whole_, halves_;
  Drive trial_drive_;
  double next_step_ =
      std::numeric_limits<double>::infinity();   ///< Guess for the next step that the last one left, in s.
  std::uint64_t repeated_ = 0, inaccurate_ = 0;  ///< Counts since the last report.
};

/// Returns the damping of a spring in N s/m. It is Settings::springs' share of what damps two masses (kg)
/// critically. An anchor has infinite mass.
double spring_damping(const SpringSettings& springs, double mass_a, double mass_b);

std::unique_ptr<SpringSystem> make_springs(const Scene& island, const Settings& settings);
/// Makes the system of SpringModel::particles.
std::unique_ptr<SpringSystem> make_spring_particles(const Scene& island, const Settings& settings);
/// Makes the system of SpringModel::rigid_rods.
std::unique_ptr<SpringSystem> make_spring_rods(const Scene& island, const Settings& settings);

/// Refuses a rod whose body has its mass in one point, and so no inertia to turn by in
/// SpringModel::rigid_rods. Throws InputError with the number of the rod.
void require_spring_bodies(const Scene& scene, const Settings& settings);

}  // namespace plumb::detail
