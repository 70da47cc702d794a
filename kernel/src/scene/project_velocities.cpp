#include "scene/project_velocities.hpp"

#include <Eigen/SparseCore>
#include <algorithm>

#include "linear/sparse_cholesky.hpp"

namespace plumb::detail {
namespace {

/// Returns J, in which each rod has a row. Its unit direction stands in the three columns of b, and the
/// opposite in those of a. Fixed ends are left out.
Eigen::SparseMatrix<double> stretching_rates(const Scene& scene, std::span<const double> inverse_masses) {
  Array<Eigen::Triplet<double>> entries;
  entries.reserve(6 * scene.rods.size());
  for (std::size_t i = 0; i < scene.rods.size(); ++i) {
    const Rod& rod = scene.rods[i];
    const Vec3 d = scene.particles[rod.b].position - scene.particles[rod.a].position;
    const double length = norm(d);
    if (length == 0) continue;
    const double unit[3] = {d.x / length, d.y / length, d.z / length};
    for (int k = 0; k < 3; ++k) {
      if (inverse_masses[rod.a] > 0) entries.emplace_back(i, 3 * rod.a + k, -unit[k]);
      if (inverse_masses[rod.b] > 0) entries.emplace_back(i, 3 * rod.b + k, unit[k]);
    }
  }
  Eigen::SparseMatrix<double> rates(static_cast<Eigen::Index>(scene.rods.size()),
                                    static_cast<Eigen::Index>(3 * scene.particles.size()));
  rates.setFromTriplets(entries.begin(), entries.end());
  return rates;
}

}  // namespace

double project_velocities(const Scene& scene, std::span<const double> inverse_masses, Array<Vec3>& velocities,
                          std::span<const double> wanted) {
  if (wanted.empty() && std::all_of(velocities.begin(), velocities.end(), [](Vec3 v) { return v == Vec3{}; }))
    return 0;
  const Eigen::SparseMatrix<double> rates = stretching_rates(scene, inverse_masses);
  const auto n = static_cast<Eigen::Index>(velocities.size());
  Eigen::VectorXd v(3 * n), inverse_mass(3 * n);
  for (Eigen::Index i = 0; i < n; ++i) {
    v.segment<3>(3 * i) << velocities[i].x, velocities[i].y, velocities[i].z;
    inverse_mass.segment<3>(3 * i).setConstant(inverse_masses[i]);
  }
  const auto lack = [&](const Eigen::VectorXd& of) -> Eigen::VectorXd {
    if (wanted.empty()) return rates * of;
    return rates * of -
           Eigen::Map<const Eigen::VectorXd>(wanted.data(), static_cast<Eigen::Index>(wanted.size()));
  };
  const Eigen::VectorXd pull = lack(v);
  if (pull.squaredNorm() == 0) return 0;

  // The matrix is scaled to a diagonal of ones, so that light particles do not drown heavy ones. Redundant
  // rods make it singular, and a small ridge makes it definite again. Refinement takes the ridge's error out
  // of every direction in which a rod can pull.
  Eigen::SparseMatrix<double> matrix = rates * inverse_mass.asDiagonal() * rates.transpose();
  const Eigen::VectorXd scale = matrix.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  matrix = scale.asDiagonal() * matrix * scale.asDiagonal();
  Eigen::SparseMatrix<double> identity(matrix.rows(), matrix.cols());
  identity.setIdentity();
  Eigen::VectorXd changed = v, scaled_lambda;
  double left = pull.norm();
  const double enough = 1e-14 * left;
  for (const double ridge : {0.0, 1e-15, 1e-13, 1e-11}) {
    SparseCholesky factor;
    const Eigen::SparseMatrix<double> ridged = matrix + ridge * identity;
    factor.analyze(ridged);
    if (!factor.factorize(ridged)) continue;
    for (int refinement = 0; refinement < 10 && left > enough; ++refinement) {
      factor.solve(scale.cwiseProduct(lack(changed)), scaled_lambda);
      const Eigen::VectorXd lambda = scale.cwiseProduct(scaled_lambda);
      const Eigen::VectorXd next = changed - inverse_mass.cwiseProduct(rates.transpose() * lambda);
      const double now = lack(next).norm();
      if (!(now < left)) break;
      changed = next;
      left = now;
    }
    if (left <= enough) break;
  }

  double largest = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    largest = std::max(largest, (changed - v).segment<3>(3 * i).norm());
    velocities[i] = {changed[3 * i], changed[3 * i + 1], changed[3 * i + 2]};
  }
  return largest;
}

}  // namespace plumb::detail
