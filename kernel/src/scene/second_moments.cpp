#include "scene/second_moments.hpp"

#include <Eigen/Eigenvalues>

namespace plumb::detail {

Sym3 second_moments(const Inertia& inertia) {
  const double half = (inertia.xx + inertia.yy + inertia.zz) / 2;
  return {.xx = half - inertia.xx,
          .xy = -inertia.xy,
          .xz = -inertia.xz,
          .yy = half - inertia.yy,
          .yz = -inertia.yz,
          .zz = half - inertia.zz};
}

Principal principal_axes(const Sym3& m) {
  Eigen::Matrix3d matrix;
  matrix << m.xx, m.xy, m.xz, m.xy, m.yy, m.yz, m.xz, m.yz, m.zz;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(matrix);
  Principal out;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d axis = solver.eigenvectors().col(k);
    out.axis[static_cast<std::size_t>(k)] = {axis.x(), axis.y(), axis.z()};
    out.moment[static_cast<std::size_t>(k)] = solver.eigenvalues()(k);
  }
  return out;
}

}  // namespace plumb::detail
