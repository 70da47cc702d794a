#pragma once

#include <Eigen/Core>
#include <span>

#include "plumb/layouts/memory.hpp"
#include "reference/multipliers/weighted_sum.hpp"

namespace plumb::detail {

/// Knows how the springs, torsions and drives of an island pull, as forces that follow from where its
/// particles are and how they move. Its movable particles come first.
class JointForces {
 public:
  JointForces(const Scene& island, std::uint32_t movable);

  /// Adds the forces (N) at positions x (m) and velocities v (m/s) to those of movable particles.
  void add(std::span<const Vec3> x, std::span<const Vec3> v, Eigen::VectorXd& f) const;
  /// Counts the turns of torsions up to positions that are less than half a turn from the last.
  void follow(std::span<const Vec3> x);

 private:
  struct Tie {
    WeightedSum apart;
    Spring law;
  };
  struct Turning {
    WeightedSum axis, u, v;
    Torsion law;
    double angle = 0;  ///< rad, as last followed
  };
  struct Driven {
    WeightedSum u, v;
    AngleControl law;
  };

  void push(const WeightedSum& at, Vec3 force, Eigen::VectorXd& f) const;
  void pull(const Tie& tie, std::span<const Vec3> x, std::span<const Vec3> v, Eigen::VectorXd& f) const;
  void turn(const Turning& torsion, std::span<const Vec3> x, std::span<const Vec3> v,
            Eigen::VectorXd& f) const;
  void drive(const Driven& angle, std::span<const Vec3> x, std::span<const Vec3> v, Eigen::VectorXd& f) const;

  std::uint32_t movable_;
  Array<Tie> ties_;
  Array<Turning> torsions_;
  Array<Driven> drives_;
};

}  // namespace plumb::detail
