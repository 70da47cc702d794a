#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/SparseCore>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

#include "linear/sparse_cholesky.hpp"
#include "plumb/layouts/memory.hpp"
#include "reference/mechanical_system.hpp"

namespace plumb::detail {

class SpringSystem;

/// This number of a body stands for an anchor.
inline constexpr std::uint32_t no_body = std::numeric_limits<std::uint32_t>::max();

/// Describes a spring near where it is now. Let d be the change of its point on body a minus that on body b.
/// The force on a then changes by -(stiffness d + damping d'), that on b by the opposite.
struct LinearSpring {
  std::uint32_t a = no_body, b = no_body;  ///< Bodies at its ends; a is one, b may be none.
  Eigen::Vector3d arm_a{0, 0, 0},
      arm_b{0, 0, 0};                  ///< From the centre of mass to the end, in m; not used for points.
  Eigen::Matrix3d stiffness, damping;  ///< In N/m and N s/m; symmetric and not negative.
};
/// Lists all springs, and for every body a torque per angle (N m/rad, not negative). Forces at its ends turn
/// the body back by that torque as it turns, as those of a rod under tension do.
struct Linearization {
  Array<LinearSpring> springs;
  Eigen::VectorXd turning;
};

/// Holds a symmetric matrix of square blocks whose pattern is known beforehand, and solves with it.
class BlockMatrix {
 public:
  /// Says where a tile is in the values of the matrix.
  struct Block {
    Eigen::Index first = 0, stride = 0;
  };

  /// Lays out the pattern. `pairs` are the tiles off the diagonal, row above column; duplicates are fine.
  void set_pattern(Eigen::Index blocks, Eigen::Index size,
                   std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs);
  Block find(std::uint32_t row, std::uint32_t column) const;
  /// Sets the matrix to a diagonal one.
  void set_diagonal(const Eigen::VectorXd& diagonal);
  /// Adds to the part of a tile that starts at (row, column) in it.
  void add(Block block, Eigen::Index row, Eigen::Index column, const Eigen::Matrix3d& part);
  /// Solves for `out`. Returns false if the matrix is not positive definite.
  bool solve(const Eigen::VectorXd& right, Eigen::VectorXd& out);

 private:
  Eigen::Index size_ = 0;
  Eigen::SparseMatrix<double> matrix_;  ///< Lower triangle, with the whole of the tiles on the diagonal.
  SparseCholesky factor_;
};

/// Takes steps of backward Euler, linearised (thesis eq. 3.16 to 3.22), for second-order systems. With K and
/// D the derivatives of the forces by positions and velocities, (M - h D - h² K) dv = h (f + h K v). This is
/// eq. 3.22 with the positions eliminated.
///
/// Springs and rods under compression have a K that is not negative sideways. That part is left out, so that
/// the matrix stays positive definite at every step. It costs no order.
class ImplicitEuler {
 public:
  void step(SpringSystem& system, MechanicalState& state, const Drive& drive, double h);

 private:
  struct Places {
    BlockMatrix::Block a, b, between;
  };
  void analyze(const SpringSystem& system);
  void add_pulls(const SpringSystem& system, const Eigen::VectorXd& v, double h, Eigen::VectorXd& out) const;
  void assemble(const SpringSystem& system, double h);

  Linearization linear_;
  Array<Places> places_;
  Array<BlockMatrix::Block> diagonal_;
  BlockMatrix matrix_;
  bool analyzed_ = false;
  Eigen::VectorXd right_, change_, rate_, diagonal_entries_;
};

/// Gives the matrix that takes x to v × x.
inline Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d out;
  out << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return out;
}
inline Eigen::Vector3d to_eigen(Vec3 v) {
  return {v.x, v.y, v.z};
}
inline Vec3 to_vec3(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

}  // namespace plumb::detail
