// Node i stands with the row to its parent p. Everything below i is eliminated, and K and r are what is left
// of M and f there:
//
//   K x_i + kappa x_p - d lambda = r        d . (x_i - x_p) + S lambda = c
//
// With H = K^-1, u = H d, s = d . u + S and n = (d + kappa u) / s the solution is:
//
//   lambda = (c - d . H r) / s + n . x_p
//   x_i    = H r + (c - d . H r) / s u + P x_p,   P = u nᵀ - kappa H
//   K_p   += d nᵀ + kappa P,   r_p -= (c - d . H r) / s (d + kappa u) + kappa H r
//
// A tie obeys the same equations with x_p = 0. As part of its own node it adds d dᵀ / S to K where it has a
// compliance, and takes a rank from H where it has none.

#include <stdexcept>

#include "reference/multipliers/rod_equations.hpp"
#include "reference/multipliers/small_matrices.hpp"

namespace plumb::detail {
namespace {

class TreeFactor final : public RodFactor {
 public:
  explicit TreeFactor(const RodEquations& equations) {
    const layouts::Tree& tree = *equations.tree;
    const std::uint32_t n = tree.nodes();
    nodes_.resize(n);
    std::uint32_t tie = n - 1;  // the tie's row
    std::uint32_t slots = 0;
    for (std::uint32_t i = 0; i < n; ++i) {
      Node& node = nodes_[i];
      node.mass = equations.mass[i];
      node.parent = i == 0 ? 0 : tree.parent[i];
      if (i > 0) {
        node.coupling = equations.rows[i - 1].coupling;
        node.compliance = equations.rows[i - 1].compliance;
        if (node.parent + 1 != i && nodes_[node.parent].slot == no_slot) nodes_[node.parent].slot = slots++;
      }
      node.first_tie = static_cast<std::uint32_t>(ties_.size());
      for (std::uint32_t k = tree.tie_begin[i]; k < tree.tie_begin[i + 1]; ++k, ++tie)
        ties_.push_back({tie, equations.rows[tie].compliance, {}, {}});
    }
    nodes_.push_back({.first_tie = static_cast<std::uint32_t>(ties_.size())});
    count_ = n;
    keeps_multipliers_ = equations.softened;
    slots_.resize(slots);
    maps_.resize(n);
  }

  void factorize(const Array<Vec3>& directions) override { directions_ = directions.data(); }

  /// Factorises and solves in one pass. A second solve costs as much as the first, and is rare.
  void solve(const Eigen::VectorXd& f, const Eigen::VectorXd& c, Eigen::VectorXd& x,
             Eigen::VectorXd& lambda) override {
    x.resize(f.size());
    lambda.resize(c.size());
    eliminate(f.data(), c.data());
    substitute(x.data(), lambda.data());
  }

 private:
  static constexpr std::uint32_t no_slot = 0xffffffff;

  struct Node {
    double mass = 0, coupling = 0, compliance = 0;
    std::uint32_t parent = 0;
    std::uint32_t first_tie = 0;   ///< the node's first tie; its ties end where those of the next node begin
    std::uint32_t slot = no_slot;  ///< place where children that do not follow at once leave their part
  };
  /// Holds lambda = rho - y . g of a tie. g is the force from above, that of everything eliminated before
  /// included.
  struct Tie {
    std::uint32_t row;
    double compliance;
    Vec3 y;
    double rho;
  };
  /// Holds what is left of a node's equations.
  struct Block {
    Sym3 k;
    Vec3 r;
    void operator+=(const Block& o) {
      k += o.k;
      r += o.r;
    }
  };
  /// Holds x_i = u (rho + n . x_p) + q - kappa H x_p and lambda = rho + n . x_p.
  struct Map {
    Vec3 u, n, q;
    double rho;
    Sym3 kappa_h;
  };
  struct Held {
    Sym3 h;
    Vec3 q;
  };

  /// Adds the node's ties, so that x = q + H g for a force g from above.
  Held hold(std::uint32_t i, const Block& block, const double* c) {
    Held held{inverse(block.k), {}};
    held.q = held.h * block.r;
    for (std::uint32_t k = nodes_[i].first_tie; k < nodes_[i + 1].first_tie; ++k) {
      Tie& tie = ties_[k];
      const Vec3 d = directions_[tie.row], u = held.h * d;
      const double over = 1 / (dot(d, u) + tie.compliance * dot(d, d));
      tie.rho = (c[tie.row] - dot(d, held.q)) * over;
      tie.y = over * u;
      held.q += tie.rho * u;
      held.h = held.h - outer(over, u);
    }
    return held;
  }

  void eliminate(const double* f, const double* c) {
    for (Block& slot : slots_) slot = {};
    Block carried;  // what node i + 1 hands on, if i is its parent
    for (std::uint32_t i = count_; i-- > 1;) {
      const Node& node = nodes_[i];
      Block block = carried;
      block.k += Sym3::diagonal(node.mass);
      block.r += load3(f + 3 * i);
      if (node.slot != no_slot) block += slots_[node.slot];
      const Held held = hold(i, block, c);
      const Vec3 d = directions_[i - 1], u = held.h * d;
      const double over = 1 / (dot(d, u) + node.compliance * dot(d, d));
      Map& map = maps_[i];
      map.u = u;
      map.q = held.q;
      map.rho = (c[i - 1] - dot(d, held.q)) * over;
      Block up;
      if (node.coupling == 0) {
        map.n = over * d;
        up = {outer(over, d), -map.rho * d};
      } else {
        const Vec3 e = d + node.coupling * u;
        map.n = over * e;
        map.kappa_h = node.coupling * held.h;
        up = {outer(over, e) - node.coupling * map.kappa_h, (-map.rho) * e - node.coupling * held.q};
      }
      if (node.parent + 1 == i) {
        carried = up;
      } else {
        slots_[nodes_[node.parent].slot] += up;
        carried = {};
      }
    }
    Block block = carried;
    block.k += Sym3::diagonal(nodes_[0].mass);
    block.r += load3(f);
    if (nodes_[0].slot != no_slot) block += slots_[nodes_[0].slot];
    root_ = hold(0, block, c).q;
  }

  /// Finds the multipliers of node i's ties, the last eliminated first. `g` is the force from above.
  void pull_ties(std::uint32_t i, Vec3 g, double* lambda) const {
    for (std::uint32_t k = nodes_[i + 1].first_tie; k-- > nodes_[i].first_tie;) {
      const Tie& tie = ties_[k];
      lambda[tie.row] = tie.rho - dot(tie.y, g);
      g += lambda[tie.row] * directions_[tie.row];
    }
  }

  void substitute(double* x, double* lambda) const {
    store3(x, root_);
    if (keeps_multipliers_) pull_ties(0, {}, lambda);
    Vec3 last = root_;
    for (std::uint32_t i = 1; i < count_; ++i) {
      const Node& node = nodes_[i];
      const Map& map = maps_[i];
      const Vec3 above = node.parent + 1 == i ? last : load3(x + 3 * node.parent);
      const double pull = map.rho + dot(map.n, above);
      last = map.q + pull * map.u;
      if (node.coupling != 0) last -= map.kappa_h * above;
      store3(x + 3 * i, last);
      if (!keeps_multipliers_) continue;
      lambda[i - 1] = pull;
      pull_ties(i, pull * directions_[i - 1] - node.coupling * above, lambda);
    }
  }

  std::uint32_t count_ = 0;
  bool keeps_multipliers_ = false;
  Array<Node> nodes_;
  Array<Tie> ties_;
  Array<Block> slots_;
  Array<Map> maps_;
  const Vec3* directions_ = nullptr;
  Vec3 root_;
};

}  // namespace

std::unique_ptr<RodFactor> make_tree_factor(const RodEquations& equations) {
  if (!equations.tree) throw std::logic_error("make_tree_factor: not a tree");
  return std::make_unique<TreeFactor>(equations);
}

}  // namespace plumb::detail
