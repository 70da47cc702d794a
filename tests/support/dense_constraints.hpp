#pragma once

#include <utility>
#include <vector>

#include "plumb/scene.hpp"
#include "support/dense_solves.hpp"

namespace plumb::test {

/// The equations of a configuration written out as one dense matrix from the scene alone, M a - Jᵀ mu = f
/// and J a = c for the movable particles, and solved by complete orthogonal decomposition: where rods are
/// redundant, the least multipliers, and 0 for elastic ones. O(n³); for comparison with what is clever.
class DenseConstraints {
 public:
  using Matrix = DenseMatrix;
  using Vector = DenseVector;

  DenseConstraints(const Scene& scene, MassModel model) : row_(scene.particles.size(), -1) {
    for (std::size_t i = 0; i < row_.size(); ++i) {
      if (!scene.particles[i].fixed) row_[i] = movable_++;
    }
    const Eigen::Index rods = static_cast<Eigen::Index>(scene.rods.size());
    all_ = Matrix::Zero(3 * movable_ + rods, 3 * movable_ + rods);
    const auto add_mass = [&](std::size_t i, std::size_t j, double mass) {
      if (row_[i] < 0 || row_[j] < 0) return;
      for (Eigen::Index k = 0; k < 3; ++k) all_(3 * row_[i] + k, 3 * row_[j] + k) += mass;
    };
    for (std::size_t i = 0; i < row_.size(); ++i) add_mass(i, i, scene.particles[i].mass);
    for (std::size_t r = 0; r < scene.rods.size(); ++r) {
      const Rod& rod = scene.rods[r];
      const RodMass mass = rod_mass(scene, r, model);
      add_mass(rod.a, rod.a, mass.aa);
      add_mass(rod.b, rod.b, mass.bb);
      add_mass(rod.a, rod.b, mass.ab);
      add_mass(rod.b, rod.a, mass.ab);
      const Eigen::Index multiplier = 3 * movable_ + static_cast<Eigen::Index>(r);
      if (rod.law.is_elastic()) {
        all_(multiplier, multiplier) = 1;  // It is no constraint, and its multiplier is 0.
        continue;
      }
      const Vec3 a = scene.particles[rod.a].position, b = scene.particles[rod.b].position;
      const Real d[3] = {Real{b.x} - a.x, Real{b.y} - a.y, Real{b.z} - a.z};
      for (Eigen::Index k = 0; k < 3; ++k) {
        for (const auto& [end, sign] : {std::pair{rod.a, Real{-1}}, std::pair{rod.b, Real{1}}}) {
          if (row_[end] < 0) continue;
          all_(multiplier, 3 * row_[end] + k) = sign * d[k];
          all_(3 * row_[end] + k, multiplier) = -sign * d[k];
        }
      }
    }
  }

  /// The row of a particle's x; below 0 if it is fixed.
  Eigen::Index row(std::size_t particle) const { return row_[particle] < 0 ? -1 : 3 * row_[particle]; }
  Eigen::Index unknowns() const { return 3 * movable_; }
  const Matrix& matrix() const { return all_; }
  Vector solve(const Vector& right) const { return solve_dense(all_, right); }

 private:
  std::vector<Eigen::Index> row_;
  Eigen::Index movable_ = 0;
  Matrix all_;
};

}  // namespace plumb::test
