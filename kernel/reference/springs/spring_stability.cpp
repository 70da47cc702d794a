#include <Eigen/Eigenvalues>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <complex>

#include "linear/sparse_cholesky.hpp"
#include "plumb/reference/springs.hpp"
#include "reference/springs/springs.hpp"

namespace plumb {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;
using Complex = std::complex<double>;

/// All eigenvalues are found up to this number n of unknowns, in some 27·(2n)³ operations. A larger one makes
/// more limits exact and takes longer.
constexpr Index most_dense = 150;
/// Eigenvalues below this share of the largest are motions without a spring. Defective zeros come out as
/// sqrt(rounding).
constexpr double slow = 1e-6;
/// Limits are bisected to the first of these, relative. Where there are many unknowns they are bisected to
/// the second, because each trial is a large factorisation.
constexpr double fine = 1e-10, coarse = 1e-4;
constexpr Index many = 20000;

/// Describes x'' + damping x' + stiffness x = 0, in coordinates scaled by the roots of the masses.
struct Vibrations {
  Sparse stiffness, damping;
};

Vibrations find_vibrations(detail::SpringSystem& system, const detail::Linearization& linear) {
  const Index size = system.body_size();
  Array<Eigen::Triplet<double>> stiffness, damping;
  const VectorXd scale = system.masses().cwiseSqrt().cwiseInverse();
  const auto add_to = [&](Array<Eigen::Triplet<double>>& out, std::uint32_t row_body,
                          std::uint32_t column_body, const Matrix3d& part, Index row, Index column) {
    for (Index i = 0; i < 3; ++i)
      for (Index j = 0; j < 3; ++j) {
        const Index at_row = size * row_body + row + i, at_column = size * column_body + column + j;
        out.emplace_back(at_row, at_column, scale[at_row] * part(i, j) * scale[at_column]);
      }
  };
  const auto add = [&](Array<Eigen::Triplet<double>>& out, std::uint32_t row_body,
                       const Eigen::Vector3d& row_arm, std::uint32_t column_body,
                       const Eigen::Vector3d& column_arm, const Matrix3d& w) {
    add_to(out, row_body, column_body, w, 0, 0);
    if (size == 3) return;
    const Matrix3d row = detail::cross_matrix(row_arm), column = detail::cross_matrix(column_arm);
    add_to(out, row_body, column_body, -w * column, 0, 3);
    add_to(out, row_body, column_body, row * w, 3, 0);
    add_to(out, row_body, column_body, -row * w * column, 3, 3);
  };
  for (const detail::LinearSpring& s : linear.springs)
    for (const auto& [out, w] : {std::pair{&stiffness, &s.stiffness}, std::pair{&damping, &s.damping}}) {
      add(*out, s.a, s.arm_a, s.a, s.arm_a, *w);
      if (s.b == detail::no_body) continue;
      add(*out, s.b, s.arm_b, s.b, s.arm_b, *w);
      add(*out, s.a, s.arm_a, s.b, s.arm_b, -*w);
      add(*out, s.b, s.arm_b, s.a, s.arm_a, -*w);
    }
  const Index n = system.masses().size();
  Vibrations out{Sparse(n, n), Sparse(n, n)};
  out.stiffness.setFromTriplets(stiffness.begin(), stiffness.end());
  out.damping.setFromTriplets(damping.begin(), damping.end());
  return out;
}

Sparse identity(Index n) {
  Sparse out(n, n);
  out.setIdentity();
  return out;
}

/// Returns the step at which 4 - 2 h damping - h² stiffness stops being positive definite.
///
/// A vibration x_n = μⁿ y of semi-implicit Euler obeys (μ - 1)² + h damping (μ - 1) + h² stiffness μ = 0. By
/// Rayleigh quotients of y it leaves the unit circle at μ = -1 only. The fastest frequency is 2/h without
/// damping.
double alternating_limit(const Sparse& stiffness, const Sparse& damping) {
  const Sparse one = identity(stiffness.rows());
  detail::SparseCholesky factor;
  factor.analyze(one + stiffness + damping);
  const auto holds = [&](double h) {
    factor.factorize(4 * one - 2 * h * damping - h * h * stiffness);
    return factor.is_positive();
  };
  // The limit lies between what the largest row sums and what the largest entries of the diagonal allow.
  double low = INFINITY, high = INFINITY;
  for (Index i = 0; i < stiffness.outerSize(); ++i) {
    const auto root = [](double k, double c) { return 4 / (c + std::sqrt(c * c + 4 * k)); };
    const double k = stiffness.coeff(i, i), c = damping.coeff(i, i);
    if (k + c > 0) high = std::min(high, root(k, c));
    const double ks = stiffness.col(i).cwiseAbs().sum(), cs = damping.col(i).cwiseAbs().sum();
    if (ks + cs > 0) low = std::min(low, root(ks, cs));
  }
  if (!std::isfinite(high)) return INFINITY;
  low *= 1 - 1e-12;
  high *= 1 + 1e-12;
  const double tolerance = stiffness.rows() > many ? coarse : fine;
  while (high - low > tolerance * high) (holds((low + high) / 2) ? low : high) = (low + high) / 2;
  return (low + high) / 2;
}

/// Returns λ of every vibration exp(λt).
Array<Complex> all_rates(const Vibrations& v) {
  const Index n = v.stiffness.rows();
  Array<Complex> out;
  if (v.damping.nonZeros() == 0 || v.damping.norm() == 0) {  // rounding would make growth or decay of it
    const Eigen::VectorXcd squares = Eigen::MatrixXd(v.stiffness).eigenvalues();
    for (Index i = 0; i < n; ++i) out.emplace_back(0, std::sqrt(std::max(0.0, squares[i].real())));
    return out;
  }
  Eigen::MatrixXd first_order = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  first_order.topRightCorner(n, n).setIdentity();
  first_order.bottomLeftCorner(n, n) = -Eigen::MatrixXd(v.stiffness);
  first_order.bottomRightCorner(n, n) = -Eigen::MatrixXd(v.damping);
  const Eigen::VectorXcd values = first_order.eigenvalues();
  out.assign(values.begin(), values.end());
  return out;
}

/// Returns λ of the fastest vibration, by inverse iteration just above its frequency.
Array<Complex> fastest_rates(const Vibrations& v, double frequency) {
  const Index n = v.stiffness.rows();
  const double square = frequency * frequency;
  const Sparse shifted = (1 + 1e-6) * square * identity(n) - v.stiffness;
  detail::SparseCholesky factor;
  factor.analyze(shifted);
  factor.factorize(shifted);
  VectorXd shape(n), next;
  for (Index i = 0; i < n; ++i) shape[i] = 1 + 0.5 * std::sin(1.0 + static_cast<double>(i) * i);
  for (int i = 0; i < 30; ++i) {
    factor.solve(shape, next);
    shape = next.normalized();
  }
  const double half = shape.dot(v.damping * shape) / 2;
  const Complex root = std::sqrt(Complex(half * half - square));
  return {-half + root, -half - root};
}

double amplification(Integrator integrator, Complex z) {
  Complex sum = 1.0 + z;
  if (integrator == Integrator::rk2) sum += z * z / 2.0;
  if (integrator == Integrator::rk4) sum += z * z / 2.0 + z * z * z / 6.0 + z * z * z * z / 24.0;
  return std::abs(sum);
}

/// Returns the first h at which a one-step method makes exp(λt) grow.
double growth_limit(Integrator integrator, Complex rate) {
  const double size = std::abs(rate);
  if (integrator == Integrator::explicit_euler) return std::max(0.0, -2 * rate.real() / (size * size));
  const auto grows = [&](double reach) { return amplification(integrator, reach / size * rate) > 1 + 1e-12; };
  constexpr double step = 0.01;
  double low = 0;
  while (!grows(low + step) && low < 10) low += step;
  if (low == 0) return 0;
  double high = low + step;
  for (int i = 0; i < 40; ++i) (grows((low + high) / 2) ? high : low) = (low + high) / 2;
  return low / size;
}

double largest_step(Integrator integrator, const Vibrations& vibrations, double frequency) {
  if (integrator == Integrator::implicit_euler || integrator == Integrator::adaptive_implicit_euler)
    return INFINITY;
  if (integrator == Integrator::semi_implicit_euler)
    return alternating_limit(vibrations.stiffness, vibrations.damping);
  const Array<Complex> rates = vibrations.stiffness.rows() <= most_dense
                                   ? all_rates(vibrations)
                                   : fastest_rates(vibrations, frequency);
  double fastest = 0, limit = INFINITY;
  for (const Complex rate : rates) fastest = std::max(fastest, std::abs(rate));
  for (const Complex rate : rates)
    if (std::abs(rate) > slow * fastest) limit = std::min(limit, growth_limit(integrator, rate));
  return limit;
}

}  // namespace

SpringStability spring_stability(const Scene& scene, const Settings& settings) {
  Settings own = settings;
  own.method = Method::springs;
  validate(scene);
  validate(own);
  detail::require_spring_bodies(scene, own);
  const auto system = detail::make_springs(scene, own);
  detail::Drive drive;
  drive.forces.resize(scene.particles.size());
  drive.anchor_velocities.resize(scene.particles.size());
  for (const Particle& particle : scene.particles) drive.anchors.push_back(particle.position);
  detail::Linearization linear;
  system->linearize(system->initial_state(drive), drive, 0, linear);
  if (linear.springs.empty()) return {.frequency = 0, .largest_step = INFINITY};
  const Vibrations vibrations = find_vibrations(*system, linear);
  const Sparse none(vibrations.stiffness.rows(), vibrations.stiffness.cols());
  const double frequency = 2 / alternating_limit(vibrations.stiffness, none);
  return {.frequency = frequency, .largest_step = largest_step(integrator_of(own), vibrations, frequency)};
}

}  // namespace plumb
