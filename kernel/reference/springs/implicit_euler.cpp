#include "reference/springs/implicit_euler.hpp"

#include <algorithm>

#include "reference/springs/springs.hpp"

namespace plumb::detail {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

void BlockMatrix::set_pattern(Index blocks, Index size,
                              std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs) {
  size_ = size;
  Array<Eigen::Triplet<double>> entries;
  const auto add_block = [&](Index row, Index column) {
    for (Index i = 0; i < size; ++i)
      for (Index j = 0; j < size; ++j) entries.emplace_back(size * row + i, size * column + j, 0.0);
  };
  for (Index i = 0; i < blocks; ++i) add_block(i, i);
  for (const auto& [row, column] : pairs) add_block(row, column);
  matrix_.resize(size * blocks, size * blocks);
  matrix_.setFromTriplets(entries.begin(), entries.end());
  factor_.analyze(matrix_);
}

// Finds where a block's entries are. All columns of a block have the same rows, so that one place and a
// stride say it.
BlockMatrix::Block BlockMatrix::find(std::uint32_t row, std::uint32_t column) const {
  const Index first_column = size_ * Index(column);
  const auto* const outer = matrix_.outerIndexPtr();
  const auto* const inner = matrix_.innerIndexPtr();
  const auto* const at =
      std::lower_bound(inner + outer[first_column], inner + outer[first_column + 1], size_ * Index(row));
  return {at - inner, Index{outer[first_column + 1]} - outer[first_column]};
}

void BlockMatrix::set_diagonal(const VectorXd& diagonal) {
  std::fill(matrix_.valuePtr(), matrix_.valuePtr() + matrix_.nonZeros(), 0.0);
  for (Index block = 0; block < diagonal.size() / size_; ++block) {
    const Block place = find(static_cast<std::uint32_t>(block), static_cast<std::uint32_t>(block));
    for (Index i = 0; i < size_; ++i)
      matrix_.valuePtr()[place.first + i * place.stride + i] = diagonal[size_ * block + i];
  }
}

void BlockMatrix::add(Block block, Index row, Index column, const Matrix3d& part) {
  for (Index j = 0; j < 3; ++j)
    for (Index i = 0; i < 3; ++i)
      matrix_.valuePtr()[block.first + (column + j) * block.stride + row + i] += part(i, j);
}

bool BlockMatrix::solve(const VectorXd& right, VectorXd& out) {
  if (!factor_.factorize(matrix_)) return false;
  factor_.solve(right, out);
  return true;
}

void ImplicitEuler::analyze(const SpringSystem& system) {
  Array<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (const LinearSpring& spring : linear_.springs)
    if (spring.b != no_body) pairs.emplace_back(std::max(spring.a, spring.b), std::min(spring.a, spring.b));
  const Index bodies = system.masses().size() / system.body_size();
  matrix_.set_pattern(bodies, system.body_size(), pairs);
  for (std::uint32_t i = 0; Index(i) < bodies; ++i) diagonal_.push_back(matrix_.find(i, i));
  for (const LinearSpring& spring : linear_.springs) {
    Places places{diagonal_[spring.a], {}, {}};
    if (spring.b != no_body) {
      places.b = diagonal_[spring.b];
      places.between = matrix_.find(std::max(spring.a, spring.b), std::min(spring.a, spring.b));
    }
    places_.push_back(places);
  }
  analyzed_ = true;
}

/// Adds h K v, by which the springs' forces change while everything moves on at v for h.
void ImplicitEuler::add_pulls(const SpringSystem& system, const VectorXd& v, double h, VectorXd& out) const {
  const Index size = system.body_size();
  const auto point_velocity = [&](std::uint32_t body, const Vector3d& arm) -> Vector3d {
    Vector3d linear = v.segment<3>(size * body);
    if (size == 3) return linear;
    return linear + v.segment<3>(size * body + 3).cross(arm);
  };
  const auto push = [&](std::uint32_t body, const Vector3d& arm, const Vector3d& force) {
    out.segment<3>(size * body) += force;
    if (size > 3) out.segment<3>(size * body + 3) += arm.cross(force);
  };
  for (const LinearSpring& spring : linear_.springs) {
    Vector3d apart = point_velocity(spring.a, spring.arm_a);
    if (spring.b != no_body) apart -= point_velocity(spring.b, spring.arm_b);
    const Vector3d force = -h * (spring.stiffness * apart);
    push(spring.a, spring.arm_a, force);
    if (spring.b != no_body) push(spring.b, spring.arm_b, -force);
  }
  for (Index i = 0; i < linear_.turning.size(); ++i)
    out.segment<3>(size * i + 3) -= h * linear_.turning[i] * v.segment<3>(size * i + 3);
}

/// Assembles M - h D - h² K. A body's point moves by dx + dtheta × arm. A spring therefore adds [1; X_a] W
/// [1, -X_b] to the block (a, b), with W = h damping + h² stiffness and X the matrix of an arm's cross
/// product.
void ImplicitEuler::assemble(const SpringSystem& system, double h) {
  diagonal_entries_ = (1 + h * system.drag()) * system.masses();
  matrix_.set_diagonal(diagonal_entries_);
  const bool turns = system.body_size() > 3;
  const auto add = [&](BlockMatrix::Block at, const Vector3d& arm_row, const Vector3d& arm_column,
                       const Matrix3d& w) {
    matrix_.add(at, 0, 0, w);
    if (!turns) return;
    const Matrix3d row = cross_matrix(arm_row), column = cross_matrix(arm_column);
    matrix_.add(at, 0, 3, -w * column);
    matrix_.add(at, 3, 0, row * w);
    matrix_.add(at, 3, 3, -row * w * column);
  };
  for (std::size_t i = 0; i < linear_.springs.size(); ++i) {
    const LinearSpring& spring = linear_.springs[i];
    const Matrix3d w = h * spring.damping + h * h * spring.stiffness;
    add(places_[i].a, spring.arm_a, spring.arm_a, w);
    if (spring.b == no_body) continue;
    add(places_[i].b, spring.arm_b, spring.arm_b, w);
    if (spring.a > spring.b)
      add(places_[i].between, spring.arm_a, spring.arm_b, -w);
    else
      add(places_[i].between, spring.arm_b, spring.arm_a, -w);
  }
  for (Index i = 0; i < linear_.turning.size(); ++i)
    matrix_.add(diagonal_[static_cast<std::size_t>(i)], 3, 3,
                h * h * linear_.turning[i] * Matrix3d::Identity());
}

void ImplicitEuler::step(SpringSystem& system, MechanicalState& state, const Drive& drive, double h) {
  // Anchors are where they will be, since the forces are those at the end of the step.
  system.find_forces(state, drive, h, right_);
  system.linearize(state, drive, h, linear_);
  if (!analyzed_) analyze(system);
  add_pulls(system, state.v, h, right_);
  right_ *= h;
  assemble(system, h);
  // Only overflow makes the matrix not positive definite. The caller notices what is not finite.
  if (!matrix_.solve(right_, change_))
    change_.setConstant(right_.size(), std::numeric_limits<double>::quiet_NaN());
  state.v += change_;
  system.rates(state, rate_);
  state.q += h * rate_;
  system.settle(state, drive, h);
}

}  // namespace plumb::detail
