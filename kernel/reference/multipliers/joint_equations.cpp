#include "reference/multipliers/joint_equations.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "reference/multipliers/small_matrices.hpp"
#include "scene/flat/flat_bodies.hpp"
#include "scene/validate_bodies.hpp"

namespace plumb::detail {
namespace {

/// A row gives way by this share of what its particles give way by themselves.
constexpr double give = 1e-8;

Array<Vec3> places(const Scene& scene) {
  Array<Vec3> out;
  for (const Particle& particle : scene.particles) out.push_back(particle.position);
  return out;
}

}  // namespace

JointEquations::JointEquations(const Scene& island, MassModel model) {
  for (const Particle& particle : island.particles) movable_ += particle.fixed ? 0u : 1u;
  add_masses(island, model);
  add_constraints(island);
  find_flat_rows(island);
  f.setZero(3 * Eigen::Index(movable_));
  c.setZero(rows());
  x_ = f;
  lambda_ = c;
  set_positions(places(island));
}

void JointEquations::add_masses(const Scene& island, MassModel model) {
  masses_.assign(movable_, 0);
  const auto add = [&](std::uint32_t a, std::uint32_t b, double mass) {
    if (a >= movable_ || mass == 0) return;
    couplings_.push_back({a, b, mass});
    if (a == b) masses_[a] += mass;
  };
  for (std::uint32_t i = 0; i < movable_; ++i) add(i, i, island.particles[i].mass);
  for (std::size_t r = 0; r < island.rods.size(); ++r) {
    const auto [a, b] = std::pair(island.rods[r].a, island.rods[r].b);
    const RodMass mass = rod_mass(island, r, model);
    add(a, a, mass.aa);
    add(a, b, mass.ab);
    add(b, a, mass.ab);
    add(b, b, mass.bb);
  }
  for (std::size_t i = 0; i < island.bodies.size(); ++i) {
    const auto mass = body_mass(island, i);
    for (std::size_t j = 0; j < 4; ++j)
      for (std::size_t k = 0; k < 4; ++k)
        add(island.bodies[i].particles[j], island.bodies[i].particles[k], mass[j][k]);
  }
}

void JointEquations::add_constraints(const Scene& island) {
  const Array<Vec3> x = places(island);
  for (std::size_t r = 0; r < island.rods.size(); ++r) {
    const WeightedSum along{{{island.rods[r].b, 1.0}, {island.rods[r].a, -1.0}}};
    const double length = rod_length(island, r);
    constraints_.push_back({.u = along, .v = along, .value = length * length});
  }
  for (const Alignment& each : island.alignments) {
    Constraint& added = constraints_.emplace_back(Constraint{.u = way(each.u), .v = way(each.v)});
    added.value = each.value.value_or(dot(added.u.of(x), added.v.of(x)));
  }
  for (const Pin& each : island.pins) {
    if (are_one_place(each.a, each.b)) continue;
    for (const Vec3 axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}})
      constraints_.push_back({.u = {}, .v = way(each.a, each.b), .axis = axis});
  }
}

/// Rods of flat bodies make M regular: with rho Jᵀ c beside f, neither solutions nor multipliers change.
void JointEquations::find_flat_rows(const Scene& island) {
  for (std::size_t i = 0; i < island.bodies.size(); ++i) {
    if (!has_singular_mass(island, i)) continue;
    const Body& body = island.bodies[i];
    const auto is_in = [&](std::uint32_t particle) {
      return std::find(body.particles.begin(), body.particles.end(), particle) != body.particles.end();
    };
    if (rho_.size() == 0) rho_.setZero(rows());
    for (const std::uint32_t particle : body.particles)
      if (particle < movable_) masses_[particle] = std::max(masses_[particle], nominal_mass(body));
    for (std::size_t r = 0; r < island.rods.size(); ++r)
      if (is_in(island.rods[r].a) && is_in(island.rods[r].b))
        rho_[static_cast<Eigen::Index>(r)] = body.mass / (4 * constraints_[r].value);
  }
}

void JointEquations::set_positions(std::span<const Vec3> x) {
  const Eigen::Index n = f.size();
  Array<Eigen::Triplet<double>>& all = entries_;
  const auto vector = [&](Array<Eigen::Triplet<double>>& to, Eigen::Index row, std::uint32_t particle,
                          Vec3 value) {
    if (particle >= movable_) return;
    const double of[3] = {value.x, value.y, value.z};
    for (int k = 0; k < 3; ++k) to.emplace_back(row, 3 * Eigen::Index(particle) + k, of[k]);
  };
  all.clear();
  for (Eigen::Index r = 0; r < rows(); ++r) {
    const Constraint& each = constraints_[static_cast<std::size_t>(r)];
    const Vec3 u = each.u.terms.empty() ? each.axis : each.u.of(x), v = each.v.of(x);
    for (const auto& [particle, weight] : each.u.terms) vector(all, r, particle, weight * v);
    for (const auto& [particle, weight] : each.v.terms) vector(all, r, particle, weight * u);
  }
  jacobian_.resize(rows(), n);
  jacobian_.setFromTriplets(all.begin(), all.end());
  if (!is_analyzed_) {
    Array<Eigen::Triplet<double>> masses;
    for (const Coupling& each : couplings_)
      for (int k = 0; k < 3 && each.b < movable_; ++k)
        masses.emplace_back(3 * Eigen::Index(each.a) + k, 3 * Eigen::Index(each.b) + k, each.mass);
    mass_.resize(n, n);
    mass_.setFromTriplets(masses.begin(), masses.end());
  }
  if (rho_.size() > 0)
    regular_mass_ =
        mass_ + Eigen::SparseMatrix<double>(jacobian_.transpose() * rho_.asDiagonal() * jacobian_);
  else if (!is_analyzed_)
    regular_mass_ = mass_;
  // The matrix is scaled so that the diagonals of M and of J diag(M)⁻¹ Jᵀ are one.
  scale_.resize(n + rows());
  for (Eigen::Index i = 0; i < n; ++i) scale_[i] = 1 / std::sqrt(masses_[static_cast<std::size_t>(i / 3)]);
  scale_.tail(rows()).setZero();
  for (Eigen::Index k = 0; k < n; ++k)
    for (Eigen::SparseMatrix<double>::InnerIterator it(jacobian_, k); it; ++it)
      scale_[n + it.row()] += it.value() * it.value() * scale_[k] * scale_[k];
  for (Eigen::Index r = n; r < n + rows(); ++r) scale_[r] = 1 / std::sqrt(scale_[r]);
  all.clear();
  const auto scaled = [&](Eigen::Index row, Eigen::Index column, double value) {
    if (row >= column) all.emplace_back(row, column, scale_[row] * value * scale_[column]);
  };
  for (Eigen::Index k = 0; k < n; ++k) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(regular_mass_, k); it; ++it)
      scaled(it.row(), k, it.value());
    for (Eigen::SparseMatrix<double>::InnerIterator it(jacobian_, k); it; ++it)
      scaled(n + it.row(), k, it.value());
  }
  for (Eigen::Index r = n; r < n + rows(); ++r) all.emplace_back(r, r, -give);
  matrix_.resize(n + rows(), n + rows());
  matrix_.setFromTriplets(all.begin(), all.end());
  if (!std::exchange(is_analyzed_, true)) factor_.analyze(matrix_);
  factor_.factorize(matrix_);
}

double JointEquations::violations(std::span<const Vec3> x, Eigen::VectorXd& out) const {
  double largest = 0;
  for (Eigen::Index r = 0; r < rows(); ++r) {
    const Constraint& each = constraints_[static_cast<std::size_t>(r)];
    const bool is_pin = each.u.terms.empty();
    const Vec3 u = is_pin ? each.axis : each.u.of(x), v = each.v.of(x);
    out[r] = dot(u, v) - each.value;
    const double off = std::abs(out[r]) / (is_pin ? 1 : norm(u) + norm(v));
    // A value that is not a number stays the largest.
    if (!std::isnan(largest) && !(off <= largest)) largest = off;
  }
  return largest;
}

void JointEquations::add_rates(std::span<const Vec3> x, std::span<const Vec3> v, double by,
                               Eigen::VectorXd& out) const {
  for (Eigen::Index r = 0; r < rows(); ++r) {
    const Constraint& each = constraints_[static_cast<std::size_t>(r)];
    const Vec3 u = each.u.terms.empty() ? each.axis : each.u.of(x);
    out[r] += by * (dot(u, each.v.of(v)) + dot(each.u.of(v), each.v.of(x)));
  }
}

void JointEquations::add_bends(std::span<const Vec3> v, double by, Eigen::VectorXd& out) const {
  for (Eigen::Index r = 0; r < rows(); ++r) {
    const Constraint& each = constraints_[static_cast<std::size_t>(r)];
    out[r] += 2 * by * dot(each.u.of(v), each.v.of(v));
  }
}

void JointEquations::add_momenta(std::span<const Vec3> v, double by, Eigen::VectorXd& out) const {
  for (const auto& [a, b, mass] : couplings_) store3(&out[3 * a], load3(&out[3 * a]) + (by * mass) * v[b]);
}

void JointEquations::add_weights(Vec3 gravity, Eigen::VectorXd& out) const {
  for (const auto& [a, b, mass] : couplings_) store3(&out[3 * a], load3(&out[3 * a]) + mass * gravity);
}

/// Computes what x_ and lambda_ leave of f and c. Returns the largest of c, relative to its terms.
double JointEquations::residuals() {
  left_f_ = f - mass_ * x_ + jacobian_.transpose() * lambda_;
  left_c_ = c - jacobian_ * x_;
  const Eigen::VectorXd terms = c.cwiseAbs() + jacobian_.cwiseAbs() * x_.cwiseAbs();
  double largest = 0;
  for (Eigen::Index r = 0; r < rows(); ++r)
    if (left_c_[r] != 0 && !std::isnan(largest) && !(std::abs(left_c_[r]) <= largest * terms[r]))
      largest = std::abs(left_c_[r]) / terms[r];
  return largest;
}

const Eigen::VectorXd& JointEquations::solve() {
  constexpr double enough = 16 * std::numeric_limits<double>::epsilon();
  const auto add_solution = [&](const Eigen::VectorXd& of_f, const Eigen::VectorXd& of_c) {
    right_.resize(of_f.size() + of_c.size());
    right_ << of_f, of_c;
    if (rho_.size() > 0) right_.head(of_f.size()) += jacobian_.transpose() * rho_.cwiseProduct(of_c);
    right_ = scale_.cwiseProduct(right_);
    factor_.solve(right_, solved_);
    solved_ = scale_.cwiseProduct(solved_);
    x_ += solved_.head(of_f.size());
    lambda_ -= solved_.tail(of_c.size());
  };
  x_.setZero();
  lambda_.setZero();
  add_solution(f, c);
  const double left = refinement_.run(
      x_, lambda_, enough, [this] { return residuals(); }, [&] { add_solution(left_f_, left_c_); });
  if (!(left <= largest_miss_)) largest_miss_ = left;
  return x_;
}

}  // namespace plumb::detail
