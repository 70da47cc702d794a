#include "truth/constraint_solver.hpp"

#include <algorithm>
#include <limits>
#include <string>

namespace plumb::truth {

ConstraintSolver::ConstraintSolver(const Model& model)
    : model_(model), mass_(model.mass), fixed_(model.fixed), push_(model.rods.size()) {
  const SpanningTree tree = grow_spanning_tree(model);
  for (const TreeNode& node : tree.nodes) add_node(node);
  for (const std::uint32_t r : tree.chords) {
    const ModelRod& rod = model.rods[r];
    if (rod.coupling == 0 || model.fixed[rod.a] || model.fixed[rod.b]) {
      rows_.push_back({.a = rod.a, .b = rod.b, .rod = r});
      continue;
    }
    const std::uint32_t copy = static_cast<std::uint32_t>(mass_.size());
    mass_[rod.b] -= rod.at_b;
    mass_.push_back(rod.at_b);
    fixed_.push_back(0);
    copied_.push_back(rod.b);
    add_node({.particle = copy, .parent = rod.a, .rod = r});
    for (const Point axis : {Point{1, 0, 0}, Point{0, 1, 0}, Point{0, 0, 1}}) {
      rows_.push_back({.a = rod.b, .b = copy, .d = axis});
    }
  }
  if (rows_.size() > most_rows) {
    throw Unreachable("the scene is too large: its loops need " + std::to_string(rows_.size()) +
                      " equations, one for each rod that closes one or three if it has mass, and at most " +
                      std::to_string(most_rows) + " can be solved (rods in trees have no limit)");
  }
  felt_.resize(mass_.size());
  motion_.resize(mass_.size());
  right_.resize(rows_.size());
}

void ConstraintSolver::add_node(const TreeNode& tree_node) {
  Node node{tree_node};
  if (node.rod != no_rod) {
    node.passes_up = !fixed_[node.parent];
    node.coupling = model_.rods[node.rod].coupling;
  }
  nodes_.push_back(node);
}

void ConstraintSolver::factor(const std::vector<Point>& x) {
  factor_tree(x);
  for (Row& row : rows_) {
    if (row.rod != no_rod) row.d = x[row.b] - x[row.a];
  }
  factor_rows();
}

/// K is the mass felt at a particle and b the coupling to its parent p. Its own equations are
///   K a + b a_p - d mu = f,   d·(a - a_p) = c,
/// so mu = (c - u·f + e·a_p) / sigma. In the parent's equations they add e eᵀ/sigma - b² K⁻¹ to its mass.
void ConstraintSolver::factor_tree(const std::vector<Point>& x) {
  const auto place = [&](std::uint32_t i) { return x[i < x.size() ? i : copied_[i - x.size()]]; };
  for (std::size_t i = 0; i < felt_.size(); ++i) {
    felt_[i] = {};
    felt_[i].add_identity(mass_[i]);
  }
  for (std::size_t n = nodes_.size(); n-- > 0;) {
    Node& node = nodes_[n];
    if (!node.factor.factor(felt_[node.particle])) {
      throw Unreachable("particle " + std::to_string(node.particle) +
                        " has no inertia in some direction: the mass matrix is singular");
    }
    if (node.rod == no_rod) continue;
    if (model_.rods[node.rod].elastic) {
      node.sigma = std::numeric_limits<Real>::infinity();  // Its vectors stay 0, and so does what it says.
    } else {
      node.d = place(node.particle) - place(node.parent);
      node.u = node.factor.solve(node.d);
      node.sigma = dot(node.d, node.u);
      node.e = node.d + node.coupling * node.u;
    }
    if (!node.passes_up) continue;
    Symmetric& above = felt_[node.parent];
    above.add_square(1 / node.sigma, node.e);
    if (node.coupling == 0) continue;
    const Real square = node.coupling * node.coupling;
    const Point ix = node.factor.solve({1, 0, 0}), iy = node.factor.solve({0, 1, 0}),
                iz = node.factor.solve({0, 0, 1});
    above.xx -= square * ix.x, above.yx -= square * ix.y, above.yy -= square * iy.y;
    above.zx -= square * ix.z, above.zy -= square * iy.z, above.zz -= square * iz.z;
  }
}

/// Finds the motion and the tree's multipliers of pull_, which is used up.
void ConstraintSolver::solve_tree(const std::vector<Real>& c) {
  for (std::size_t n = nodes_.size(); n-- > 0;) {
    Node& node = nodes_[n];
    const Point& own = pull_[node.particle];
    node.q = node.factor.solve(own);
    if (node.rod == no_rod) continue;
    node.s = (c[node.rod] - dot(node.u, own)) / node.sigma;
    if (node.passes_up) pull_[node.parent] -= node.coupling * node.q + node.s * node.e;
    node.q += node.s * node.u;
  }
  for (const Node& node : nodes_) {
    Point& out = motion_[node.particle];
    out = node.q;
    if (node.rod == no_rod) continue;
    push_[node.rod] = node.s;
    if (!node.passes_up) continue;
    const Point& above = motion_[node.parent];
    const Real more = dot(node.e, above) / node.sigma;
    push_[node.rod] += more;
    out += more * node.u;
    if (node.coupling != 0) out -= node.coupling * node.factor.solve(above);
  }
}

void ConstraintSolver::factor_rows() {
  const std::size_t k = rows_.size();
  if (k == 0) return;
  // Least pivot of a row, relative to what the row would feel if its ends were free.
  constexpr Real least = 1e-13L;
  const std::vector<Real> still(model_.rods.size());
  std::vector<Real> full(k * k), unit(k);
  for (std::size_t j = 0; j < k; ++j) {
    const Row& row = rows_[j];
    pull_.assign(mass_.size(), {});
    Real free = 0;
    if (!fixed_[row.a]) pull_[row.a] -= row.d, free += 1 / mass_[row.a];
    if (!fixed_[row.b]) pull_[row.b] += row.d, free += 1 / mass_[row.b];
    unit[j] = free * dot(row.d, row.d);
    solve_tree(still);
    for (std::size_t i = 0; i < k; ++i) {
      full[i * k + j] = dot(rows_[i].d, motion_[rows_[i].b] - motion_[rows_[i].a]);
    }
  }
  dense_.factor(full, unit, least);
}

void ConstraintSolver::solve(const std::vector<Point>& f, const std::vector<Real>& c, std::vector<Point>& a,
                             std::vector<Real>& mu) {
  const auto load = [&] {
    pull_.assign(mass_.size(), {});
    std::copy(f.begin(), f.end(), pull_.begin());
  };
  load();
  solve_tree(c);
  if (!rows_.empty()) {
    for (std::size_t j = 0; j < rows_.size(); ++j) {
      const Row& row = rows_[j];
      right_[j] = (row.rod == no_rod ? 0 : c[row.rod]) - dot(row.d, motion_[row.b] - motion_[row.a]);
    }
    dense_.solve(right_);
    load();
    for (std::size_t j = 0; j < rows_.size(); ++j) {
      const Row& row = rows_[j];
      pull_[row.a] -= right_[j] * row.d;
      pull_[row.b] += right_[j] * row.d;
    }
    solve_tree(c);
    for (std::size_t j = 0; j < rows_.size(); ++j) {
      if (rows_[j].rod != no_rod) push_[rows_[j].rod] = right_[j];
    }
  }
  std::copy_n(motion_.begin(), a.size(), a.begin());
  mu = push_;
}

}  // namespace plumb::truth
