#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <span>
#include <utility>

#include "linear/sparse_cholesky.hpp"
#include "plumb/layouts/memory.hpp"
#include "reference/multipliers/refinement.hpp"
#include "reference/multipliers/weighted_sum.hpp"

namespace plumb::detail {

/// Holds the equations of an island with bodies and joints, whose movable particles come first. M is the mass
/// matrix of particles, rods and bodies. Constraints are products u·v that keep their value, of ways between
/// places: rods (u = v), alignments, and pins (u one of the axes of space).
class JointEquations {
 public:
  JointEquations(const Scene& island, MassModel model);

  std::uint32_t movable() const { return movable_; }
  Eigen::Index rows() const { return static_cast<Eigen::Index>(constraints_.size()); }

  /// Writes J and M down at positions x (m) of all particles.
  void set_positions(std::span<const Vec3> x);
  /// Writes by how much constraints are violated at x. Returns the largest, in m.
  double violations(std::span<const Vec3> x, Eigen::VectorXd& out) const;
  /// Adds `by` times J v, with v (m/s) of all particles.
  void add_rates(std::span<const Vec3> x, std::span<const Vec3> v, double by, Eigen::VectorXd& out) const;
  /// Adds `by` times what second derivatives of constraints have from velocities alone.
  void add_bends(std::span<const Vec3> v, double by, Eigen::VectorXd& out) const;
  /// Adds `by` times M v of movable particles, with v of all.
  void add_momenta(std::span<const Vec3> v, double by, Eigen::VectorXd& out) const;
  /// Adds the weight under `gravity` (m/s²).
  void add_weights(Vec3 gravity, Eigen::VectorXd& out) const;

  Eigen::VectorXd f, c;  ///< Right-hand sides, which the caller sets.
  /// Solves M a - Jᵀ lambda = f, J a = c. Rows give way by 1e-8 of what they would alone, so that redundant
  /// ones do no harm, and refinement takes the error of that out again.
  const Eigen::VectorXd& solve();
  /// Returns the largest share of an equation's terms that solutions have missed it by since the last call.
  double take_largest_miss() { return std::exchange(largest_miss_, 0.0); }
  /// Lets that be `before`, whatever came since.
  void forget_misses(double before) { largest_miss_ = before; }

 private:
  struct Constraint {
    WeightedSum u, v;  ///< u is empty where it is the axis
    Vec3 axis{};
    double value = 0;
  };
  struct Coupling {
    std::uint32_t a, b;
    double mass;
  };

  void add_masses(const Scene& island, MassModel model);
  void add_constraints(const Scene& island);
  void find_flat_rows(const Scene& island);
  double residuals();

  std::uint32_t movable_ = 0;
  Array<Coupling> couplings_;  ///< all entries of M with a movable first particle
  Array<double> masses_;       ///< kg, its diagonal, or a quarter of a flat body if that is more
  Array<Constraint> constraints_;
  Array<Eigen::Triplet<double>> entries_;
  Eigen::SparseMatrix<double> mass_, jacobian_, matrix_;
  Eigen::SparseMatrix<double> regular_mass_;  ///< M + Jᵀ rho J, which is regular where bodies are flat
  Eigen::VectorXd rho_;                       ///< of rows, kg/m²; none if no body is flat
  SparseCholesky factor_;
  bool is_analyzed_ = false;
  double largest_miss_ = 0;
  Eigen::VectorXd scale_, right_, solved_, x_, lambda_, left_f_, left_c_;
  Refinement refinement_;
};

}  // namespace plumb::detail
