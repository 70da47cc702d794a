#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>

#include "plumb/layouts/memory.hpp"
#include "plumb/scene.hpp"
#include "plumb/settings.hpp"
#include "plumb/world.hpp"

namespace plumb::detail {

/// Holds coordinates and velocities of a mechanical system, in coordinates of its own.
struct MechanicalState {
  Eigen::VectorXd q;
  Eigen::VectorXd v;

  bool finite() const { return q.allFinite() && v.allFinite(); }
};

/// Says what acts on an island from outside, by the island's particles. Anchors are its fixed particles.
/// Within a substep they move in straight lines.
struct Drive {
  Array<Vec3> forces;             ///< Forces on movable particles, in N.
  Array<Vec3> anchors;            ///< Positions of anchors at the start of the substep, in m.
  Array<Vec3> anchor_velocities;  ///< Their velocities, in m/s.
  double scene_diagonal = 0;      ///< Diagonal of the scene, in m: an accuracy is relative to it.

  Vec3 anchor(std::uint32_t particle, double t) const {
    return anchors[particle] + t * anchor_velocities[particle];
  }
};

/// Holds the rates of coordinates and velocities at one instant.
struct MechanicalSlope {
  Eigen::VectorXd q, v;
};

/// Holds the equations of motion of one island by one of the thesis's other methods, in double precision.
class MechanicalSystem {
 public:
  virtual ~MechanicalSystem() = default;

  /// Gives the state that the scene starts with.
  virtual MechanicalState initial_state(const Drive& drive) const = 0;
  /// Gives the rates of the velocities, `t` seconds into the substep.
  virtual void accelerations(const MechanicalState& state, const Drive& drive, double t,
                             Eigen::VectorXd& out) = 0;
  /// Gives the rates of the coordinates, which are the velocities unless a system says otherwise.
  virtual void rates(const MechanicalState& state, Eigen::VectorXd& out) const { out = state.v; }
  /// Puts back what rounding or the method itself lets drift, at the end of a substep, `t` seconds after its
  /// start.
  virtual void settle(MechanicalState&, const Drive&, double /*t*/) {}
  /// Takes one substep of h seconds, by integrate() unless the system has a way of its own.
  virtual void advance(MechanicalState& state, const Drive& drive, double h);

  /// Adds what has happened since the last report, and what the state is like: gaps of joints.
  virtual void report(const MechanicalState&, const Drive&, StepReport&) {}

  /// Prepares the answers about particles, from the state after a step and the drive as it is then. It is not
  /// called for a state that is not finite.
  virtual void place(const MechanicalState&, const Drive&) {}
  /// Gives position (m) and velocity (m/s) of a movable particle.
  virtual Vec3 position(const MechanicalState& state, std::uint32_t particle) const = 0;
  virtual Vec3 velocity(const MechanicalState& state, std::uint32_t particle) const = 0;

 protected:
  explicit MechanicalSystem(Integrator integrator) : integrator_(integrator) {}
  Integrator integrator() const { return integrator_; }

 private:
  friend void integrate(Integrator integrator, MechanicalSystem& system, MechanicalState& state,
                        const Drive& drive, double h);

  Integrator integrator_;
  MechanicalSlope slopes_[4];  ///< These slopes of integrate() are kept, so that a substep allocates nothing.
  MechanicalState stage_;
};

/// Takes one substep of h seconds by an explicit integrator. Throws std::logic_error on an implicit one.
void integrate(Integrator integrator, MechanicalSystem& system, MechanicalState& state, const Drive& drive,
               double h);

/// Holds the scene's numbers of an island's particles and rods, to name them to the user.
struct IslandNames {
  std::span<const std::uint32_t> particles, rods;
};

/// Makes the system of one island, by the settings' method: springs, multipliers or featherstone. Throws
/// InputError if the method cannot move it (loops under featherstone).
std::unique_ptr<MechanicalSystem> make_system(const Scene& island, const Settings& settings,
                                              const IslandNames& names);

}  // namespace plumb::detail
