#include "reference/multipliers/rod_equations.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "reference/multipliers/small_matrices.hpp"
#include "scene/scene_graph.hpp"

namespace plumb::detail {
namespace {

/// A softened row gives way by this share of what its rod gives way by itself, |d|² (1/m_a + 1/m_b). It is so
/// small that two or three refinements reach rounding. It is so large that the factors keep half their
/// digits.
constexpr double softness = 1e-8;

}  // namespace

RodEquations make_rod_equations(const Scene& island, MassModel model) {
  RodEquations equations;
  const SceneGraph owner(island);
  equations.tree = layouts::find_tree(owner.view());
  if (equations.tree) {
    equations.particle = equations.tree->vertex;
  } else {
    for (std::uint32_t i = 0; i < island.particles.size(); ++i)
      if (!island.particles[i].fixed) equations.particle.push_back(i);
  }
  Array<std::uint32_t> node(island.particles.size(), RodEquations::none);
  for (std::uint32_t i = 0; i < equations.particle.size(); ++i) {
    node[equations.particle[i]] = i;
    equations.mass.push_back(island.particles[equations.particle[i]].mass);
  }
  const auto add_row = [&](std::uint32_t r, std::uint32_t from) {
    const Rod& rod = island.rods[r];
    const RodMass mass = rod_mass(island, r, model);
    if (node[rod.a] != RodEquations::none) equations.mass[node[rod.a]] += mass.aa;
    if (node[rod.b] != RodEquations::none) equations.mass[node[rod.b]] += mass.bb;
    const std::uint32_t to = rod.a == from ? rod.b : rod.a;
    const double length = rod_length(island, r);
    equations.rows.push_back({node[from], node[to], to, r, mass.ab, length * length, 0});
  };
  if (equations.tree) {
    const layouts::Tree& tree = *equations.tree;
    for (std::uint32_t i = 1; i < tree.nodes(); ++i) add_row(tree.edge[i], tree.vertex[i]);
    for (std::uint32_t i = 0; i < tree.nodes(); ++i)
      for (std::uint32_t k = tree.tie_begin[i]; k < tree.tie_begin[i + 1]; ++k)
        add_row(tree.ties[k].edge, tree.vertex[i]);
  } else {
    for (std::uint32_t r = 0; r < island.rods.size(); ++r) {
      const Rod& rod = island.rods[r];
      add_row(r, island.particles[rod.a].fixed ? rod.b : rod.a);
    }
  }
  // A tree with one tie has no redundant rods in any configuration.
  equations.softened = !equations.tree || equations.tree->ties.size() > 1;
  if (equations.softened)
    for (RodEquations::Row& row : equations.rows)
      row.compliance = softness * (1 / equations.mass[row.a] +
                                   (row.b == RodEquations::none ? 0 : 1 / equations.mass[row.b]));
  return equations;
}

RodSolver::RodSolver(const Scene& island, MassModel model) : equations_(make_rod_equations(island, model)) {
  factor_ = equations_.tree ? make_tree_factor(equations_) : make_sparse_factor(equations_);
  directions.resize(equations_.rows.size());
  f.setZero(equations_.unknowns());
  c.setZero(static_cast<Eigen::Index>(equations_.rows.size()));
  x_ = f;
  lambda_ = c;
}

/// Computes what x_ and lambda_ leave of f and c. Returns the largest of c, relative to its terms.
double RodSolver::residuals() {
  left_f_ = f;
  for (std::size_t i = 0; i < equations_.mass.size(); ++i)
    store3(&left_f_[3 * i], load3(&f[3 * i]) - equations_.mass[i] * load3(&x_[3 * i]));
  left_c_ = c;
  double largest = 0;
  for (std::size_t r = 0; r < equations_.rows.size(); ++r) {
    const RodEquations::Row& row = equations_.rows[r];
    const Vec3 d = directions[r], pull = lambda_[r] * d, a = load3(&x_[3 * row.a]);
    double terms = norm(a);
    Vec3 difference = a;
    store3(&left_f_[3 * row.a], load3(&left_f_[3 * row.a]) + pull);
    if (row.b != RodEquations::none) {
      const Vec3 b = load3(&x_[3 * row.b]);
      store3(&left_f_[3 * row.a], load3(&left_f_[3 * row.a]) - row.coupling * b);
      store3(&left_f_[3 * row.b], load3(&left_f_[3 * row.b]) - pull - row.coupling * a);
      difference -= b;
      terms += norm(b);
    }
    left_c_[r] -= dot(d, difference);
    terms = std::abs(c[r]) + norm(d) * terms;
    // A value that is not a number stays the largest.
    if (!std::isnan(largest) && !(std::abs(left_c_[r]) <= largest * terms))
      largest = std::abs(left_c_[r]) / terms;
  }
  return largest;
}

const Eigen::VectorXd& RodSolver::solve() {
  factor_->factorize(directions);
  factor_->solve(f, c, x_, lambda_);
  if (!equations_.softened) return x_;
  constexpr double enough = 4 * std::numeric_limits<double>::epsilon();
  const double left = refinement_.run(
      x_, lambda_, enough, [this] { return residuals(); },
      [this] {
        factor_->solve(left_f_, left_c_, dx_, dlambda_);
        x_ += dx_;
        lambda_ += dlambda_;
      });
  if (!(left <= largest_miss_)) largest_miss_ = left;
  return x_;
}

}  // namespace plumb::detail
