#include "direct/displacements/displacement_newton.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "direct/loops/loop_newton.hpp"
#include "direct/loops/loop_vectors.hpp"
#include "linear/elimination_order.hpp"

namespace plumb::detail {
namespace {

/// This is the compliance of a rod in units of L²/mass. With more, iterations converge more slowly; with
/// less, rounding takes digits of masses.
constexpr double compliance = 1e-10;
constexpr int most_iterations = 24, most_factors = 14;
/// After a change this small, RMS over nodes relative to a rod, the next would be lost in rounding where
/// convergence is quadratic. The second may be left where convergence is linear.
constexpr double converged_change = 1e-8, converged_rest = 1e-13;
/// With an old factor the change must fall at least this fast, or a new one is made.
constexpr double slow_rate = 0.1;
/// A change of rod lengths does not lead back, and neither does one so many times the first.
constexpr double hopeless_change = 2, hopeless_growth = 2;
/// Rods whose |C|/L² is larger do not fit together.
constexpr double most_misfit = 1e-10;

constexpr std::uint32_t per_node = 9, per_rod = 18;

SparseAnalysis analyse(const LoopTopology& shape) {
  const std::uint32_t nodes = shape.nodes;
  SparsePattern pattern;
  pattern.size.assign(nodes, 3);
  Array<SparseEntry> entries;
  const auto add_tile = [&](std::uint32_t row, std::uint32_t column, std::uint32_t at) {
    for (std::uint32_t r = 0; r < 3; ++r)
      for (std::uint32_t c = 0; c < 3; ++c) entries.push_back({row, r, column, c, at + 3 * r + c});
  };
  for (std::uint32_t i = 0; i < nodes; ++i) add_tile(i, i, per_node * i);
  for (std::uint32_t k = 0; k < shape.rods.size(); ++k) {
    const auto [a, b] = shape.rods[k];
    if (b >= nodes) continue;
    pattern.meet.emplace_back(a, b);
    add_tile(a, b, per_node * nodes + per_rod * k);
    add_tile(b, a, per_node * nodes + per_rod * k + per_node);
  }
  pattern.order = order_by_degree(nodes, pattern.meet);
  if (nodes > least_dissected) {
    SparsePattern other = pattern;
    other.order = order_by_dissection(nodes, pattern.meet);
    if (SparseAnalysis::estimate(other) < SparseAnalysis::estimate(pattern)) pattern = std::move(other);
  }
  return SparseAnalysis(pattern, entries);
}

/// A rod pushes along `force`, its length grows along `gradient` (both m), and its equation is off by c (m²).
struct Terms {
  Vec3 force, gradient;
  double c, soft;
};

Terms terms(const LoopState& state, std::uint32_t k, double theta, const LoopWorkspace& work) {
  const auto [a, b] = state.topology->rods[k];
  const Vec3 d = at(work.d, k), e = at(work.delta, a) - at(work.delta, b);
  return {d + theta * e, d + e, constraint(d, e, work.excess[k]), compliance * state.length2[k]};
}

/// Adds `sign` times (force gradientᵀ / soft - push) to a tile.
void add_rod(double* tile, double sign, const Terms& rod, double push) {
  const double f[3] = {rod.force.x, rod.force.y, rod.force.z};
  const double g[3] = {rod.gradient.x, rod.gradient.y, rod.gradient.z};
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) tile[3 * r + c] += sign * (f[r] / rod.soft * g[c]);
    tile[4 * r] -= sign * push;
  }
}

void set_unit(double* tile, double value) {
  std::fill(tile, tile + 9, 0.0);
  for (int c = 0; c < 3; ++c) tile[4 * c] = value;
}

/// Says whether a vertex moves by itself.
bool is_free(const LoopState& state, std::uint32_t vertex) {
  return vertex < state.topology->nodes && !state.locks.has(vertex);
}

void factorize(const LoopState& state, double theta, const LoopWorkspace& work, DisplacementFactor& factor) {
  const LoopTopology& shape = *state.topology;
  double* const values = factor.values.data();
  for (std::uint32_t i = 0; i < shape.nodes; ++i) set_unit(values + std::size_t{per_node} * i, state.mass[i]);
  double* off = values + std::size_t{per_node} * shape.nodes;
  for (std::uint32_t k = 0; k < shape.rods.size(); ++k, off += per_rod) {
    const auto [a, b] = shape.rods[k];
    const bool is_a = is_free(state, a), is_b = is_free(state, b);
    const Terms rod = terms(state, k, theta, work);
    const double push = theta * state.mu[k];
    put(&factor.force[3 * std::size_t{k}], rod.force);
    put(&factor.gradient[3 * std::size_t{k}], rod.gradient);
    if (is_a) add_rod(values + std::size_t{per_node} * a, 1, rod, push);
    if (is_b) add_rod(values + std::size_t{per_node} * b, 1, rod, push);
    std::fill(off, off + per_rod, 0.0);
    if (!is_a || !is_b) continue;
    add_rod(off, -1, rod, push);
    std::copy(off, off + per_node, off + per_node);  // both tiles off the diagonal are f gᵀ
  }
  factor.ldu.factorize(factor.values, factor.smallest);
}

/// Puts the change of displacements into factor.right. Returns its RMS over nodes relative to a rod.
double find_change(const LoopState& state, double theta, const LoopWorkspace& work,
                   DisplacementFactor& factor) {
  const LoopTopology& shape = *state.topology;
  double* const right = factor.right.data();
  const auto add = [&](std::uint32_t i, Vec3 v) {
    double* const to = right + factor.analysis.position(i);
    put(to, Vec3{to[0], to[1], to[2]} + v);
  };
  for (std::uint32_t i = 0; i < shape.nodes; ++i)
    put(right + factor.analysis.position(i), at(work.load, i) - state.mass[i] * at(work.delta, i));
  for (std::uint32_t k = 0; k < shape.rods.size(); ++k) {
    const auto [a, b] = shape.rods[k];
    const Terms rod = terms(state, k, theta, work);
    const Vec3 pull = state.mu[k] * rod.force - rod.c / rod.soft * at(factor.force, k);
    add(a, pull);
    if (b < shape.nodes) add(b, -1.0 * pull);
  }
  for (std::uint32_t i = 0; i < state.locks.anchors.size(); ++i)
    if (state.locks.has(i)) put(right + factor.analysis.position(i), {});
  factor.ldu.solve(factor.right);
  double sum = 0;
  for (const double change : factor.right) sum += change * change;
  return std::sqrt(sum / (shape.nodes * state.scale2));
}

void apply(LoopState& state, double theta, const DisplacementFactor& factor, LoopWorkspace& work) {
  const LoopTopology& shape = *state.topology;
  const auto change_of = [&](std::uint32_t i) {
    if (i >= shape.nodes) return Vec3{};
    const double* const change = factor.right.data() + factor.analysis.position(i);
    return Vec3{change[0], change[1], change[2]};
  };
  for (std::uint32_t k = 0; k < shape.rods.size(); ++k) {
    const auto [a, b] = shape.rods[k];
    if (!is_free(state, a) && !is_free(state, b)) continue;
    const Terms rod = terms(state, k, theta, work);
    state.mu[k] -= (rod.c + dot(at(factor.gradient, k), change_of(a) - change_of(b))) / rod.soft;
  }
  for (std::uint32_t i = 0; i < shape.nodes; ++i)
    put(work.delta.data() + 3 * std::size_t{i}, at(work.delta, i) + change_of(i));
}

bool fits(const LoopState& state, const LoopWorkspace& work) {
  for (std::uint32_t k = 0; k < state.topology->rods.size(); ++k)
    if (!(std::abs(terms(state, k, 0, work).c) <= most_misfit * state.length2[k])) return false;
  return true;
}

}  // namespace

DisplacementFactor::DisplacementFactor(const LoopTopology& topology, Isa isa)
    : analysis(analyse(topology)),
      ldu(analysis, isa),
      values(per_node * std::size_t{topology.nodes} + per_rod * topology.rods.size()),
      smallest(analysis.size()),
      right(analysis.size()),
      force(3 * topology.rods.size()),
      gradient(3 * topology.rods.size()) {}

bool iterate_by_displacements(LoopState& state, double theta, DisplacementFactor& factor, LoopWorkspace& work,
                              Tally& counters) {
  measure_rods(state, work);
  bool stale = true;
  double first = 0, last = 0;
  for (int i = 0, factors = 0; i < most_iterations; ++i) {
    const bool fresh = stale;
    if (fresh) {
      if (factors++ == most_factors) return false;
      factorize(state, theta, work, factor);
    }
    const double change = find_change(state, theta, work, factor);
    ++counters.newton;
    if (i == 0) first = change;
    if (!(change <= hopeless_change && change <= hopeless_growth * first)) return false;
    apply(state, theta, factor, work);
    const double rate = last > 0 ? change / last : 1;
    if (change <= converged_change && (fresh || change * rate <= converged_rest)) return fits(state, work);
    stale = fresh ? change > slow_rate : rate > slow_rate;
    last = change;
  }
  return false;
}

}  // namespace plumb::detail
