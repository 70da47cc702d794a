#include "direct/loops/loop_newton.hpp"

#include <algorithm>
#include <cmath>

#include "direct/loops/loop_vectors.hpp"

namespace plumb::detail {
namespace {

/// A pivot below this, relative to what both ends of the rod could yield, is rounding.
constexpr double redundant_pivot = 1e-12;

void add(double* to, Vec3 v) {
  to[0] += v.x;
  to[1] += v.y;
  to[2] += v.z;
}

/// Says whether a vertex goes where anchors take it.
bool is_held(const LoopState& state, std::uint32_t vertex) {
  return vertex >= state.topology->nodes || state.locks.has(vertex);
}

/// Adds what bends and twists do to Newton's matrix, and returns how much a node resists by bends with its
/// own part of it.
void add_bends(const LoopState& state, double theta, double soft, LoopWorkspace& work,
               LoopWorkspace::Factor& factor) {
  std::fill(work.resists.begin(), work.resists.end(), 0.0);
  write_bends(state, theta, soft > 0, work, std::span(factor.values).subspan(factor.system->at_bends()),
              work.resists);
  if (!state.twists.empty())
    write_twists(state, theta, soft > 0, work, std::span(factor.values).subspan(factor.system->at_twists()));
}

void write_rod(double* values, Vec3 force, Vec3 gradient, double soft) {
  put(values + 1, force);
  put(values + 4, -1.0 * force);
  put(values + 7, gradient);
  put(values + 10, -1.0 * gradient);
  values[13] = soft;
}

/// Takes from a rod, which write_rod() wrote, what it has at ends that are locked. Their changes stay zero.
void leave_out_locked(const LoopState& state, std::uint32_t k, double* values) {
  const auto [a, b] = state.topology->rods[k];
  const bool is_a = state.locks.has(a), is_b = state.locks.has(b);
  if (is_a || is_b) values[0] = 0;
  if (is_a) std::fill(values + 4, values + 10, 0.0);
  if (is_b) std::fill(values + 1, values + 4, 0.0);
  if (is_b) std::fill(values + 10, values + 13, 0.0);
}

/// Sets below which pivot a tackle follows from other equations. Pulleys never do.
template <class Give>
void set_tackle_pivots(const LoopState& state, Give&& give, LoopWorkspace::Factor& factor) {
  const LoopSystem& system = *factor.system;
  const double* values = factor.values.data() + system.at_tackles();
  std::uint32_t row = system.nodes + system.rods;
  for (const LoopTackle& tackle : state.topology->tackles) {
    factor.smallest[system.analysis.position(row++)] = redundant_pivot * tackle_pivot(tackle, values, give);
    values += tackle.values();
  }
}

/// Lets nothing pull on locked nodes.
void hold_locked(const LoopState& state, const SparseAnalysis& analysis, double* right) {
  for (std::uint32_t i = 0; i < state.locks.anchors.size(); ++i)
    if (state.locks.has(i)) put(right + analysis.position(i), {});
}

}  // namespace

RodTerms rod_terms(const LoopState& state, std::uint32_t k, double theta, double soft,
                   const LoopWorkspace& work) {
  const LoopRod& rod = state.topology->rods[k];
  if (state.locks.has(rod.a) && is_held(state, rod.b)) return {{}, {}, 0, 1, state.mu[k]};
  const Vec3 d = at(work.d, k), e = at(work.delta, rod.a) - at(work.delta, rod.b);
  const double c = constraint(d, e, work.excess[k]), give = softness(state, k, soft);
  RodTerms terms{d + theta * e, d + e, 1, give, c + give * state.mu[k]};
  if (!state.laws.any()) return terms;
  if (soft > 0 && (state.laws.is_rigid(k) || is_softened(state, k, give, work))) {
    // A cable that gives a little is taut where it is too long, or where it pulls and is sought with its
    // pull.
    const double pull = work.draws_cables ? -state.mu[k] * state.length2[k] : 0;
    if (!state.laws.is_one_sided(k) || c + pull > 0) return terms;
    return {terms.force, {}, 0, 1, state.mu[k]};
  }
  const RodRow row = law_row(state.laws, work.laws, k, {growth_of(d, e), c, state.mu[k]}, theta);
  return {terms.force, row.use * terms.gradient, row.use, row.soft, row.c};
}

VelocityRow projected_row(const LoopState& state, std::uint32_t k, const LoopWorkspace& work) {
  const auto [a, b] = state.topology->rods[k];
  if (state.locks.has(a) && is_held(state, b)) return {0, {0, 1, 0}};
  const Vec3 d = at(work.d, k);
  const double c = dot(d, at(work.delta, a) - at(work.delta, b));
  if (!state.laws.any()) return {0, {1, 0, c}};
  return velocity_row(state.laws, work.laws, k, dot(d, d), c, state.mu[k]);
}

void measure_rods(const LoopState& state, LoopWorkspace& work) {
  const LoopTopology& shape = *state.topology;
  work.laws.starts.resize(state.laws.rods.size());
  for (std::uint32_t k = 0; k < shape.rods.size(); ++k) {
    const Vec3 d = at(state.x, shape.rods[k].a) - at(state.x, shape.rods[k].b);
    put(work.d.data() + 3 * std::size_t{k}, d);
    work.excess[k] = 0.5 * (dot(d, d) - state.length2[k]);
    if (state.laws.any()) start_law(state.laws, k, dot(d, d), work.excess[k], work.laws);
  }
  measure_bends(state, work);
  measure_tackles(state, work.tackles);
}

void factorize_newton(const LoopState& state, double theta, double soft, LoopWorkspace& work,
                      LoopWorkspace::Factor& factor) {
  const LoopTopology& shape = *state.topology;
  const LoopSystem& system = *factor.system;
  double* diagonal = factor.values.data();
  std::copy(state.mass.begin(), state.mass.end(), diagonal);
  for (std::uint32_t k = 0; k < shape.rods.size(); ++k) {
    const auto [a, b] = shape.rods[k];
    const double mu = soft > 0 ? std::min(state.mu[k], 0.0) : state.mu[k];
    diagonal[a] -= theta * mu;
    if (b < shape.nodes) diagonal[b] -= theta * mu;
    factor.values[system.at(k)] = state.coupling[k] + theta * mu;
    const RodTerms rod = rod_terms(state, k, theta, soft, work);
    write_rod(&factor.values[system.at(k)], rod.force, rod.gradient, rod.soft);
    if (state.laws.any()) factor.acts[k] = rod.use != 0;
    if (state.locks.any()) leave_out_locked(state, k, &factor.values[system.at(k)]);
  }
  for (std::uint32_t i = 0; i < state.locks.anchors.size(); ++i)
    if (state.locks.has(i)) diagonal[i] = state.mass[i];
  add_bends(state, theta, soft, work, factor);
  write_tackles(state, theta, soft, work, std::span(factor.values).subspan(system.at_tackles()));
  const auto give = [&](std::uint32_t i) {
    if (is_held(state, i)) return 0.0;
    const double own = diagonal[i] + work.resists[i];
    return 1 / (own > 0 ? own : state.mass[i]);
  };
  for (std::uint32_t k = 0; k < shape.rods.size(); ++k) {
    const auto [a, b] = shape.rods[k];
    const double* v = &factor.values[system.at(k)];
    const double along = std::abs(v[4] * v[7] + v[5] * v[8] + v[6] * v[9]);
    factor.smallest[system.analysis.position(shape.nodes + k)] =
        redundant_pivot * along * (give(a) + give(b));
  }
  set_tackle_pivots(state, give, factor);
  factor.ldu.factorize(factor.values, factor.smallest);
}

bool has_same_cables(const LoopState& state, double theta, const LoopWorkspace& work,
                     const LoopWorkspace::Factor& factor) {
  if (!state.laws.any()) return true;
  for (std::uint32_t k = 0; k < state.topology->rods.size(); ++k)
    if (state.laws.is_one_sided(k) && (rod_terms(state, k, theta, 0, work).use != 0) != (factor.acts[k] != 0))
      return false;
  return true;
}

double find_newton_change(const LoopState& state, double theta, double soft, LoopWorkspace& work,
                          LoopWorkspace::Factor& factor) {
  const LoopTopology& shape = *state.topology;
  const SparseAnalysis& analysis = factor.system->analysis;
  double* right = factor.right.data();
  for (std::uint32_t i = 0; i < shape.nodes; ++i)
    put(right + analysis.position(i), at(work.load, i) - state.mass[i] * at(work.delta, i));
  for (std::uint32_t k = 0; k < shape.rods.size(); ++k) {
    const auto [a, b] = shape.rods[k];
    const RodTerms rod = rod_terms(state, k, theta, soft, work);
    const Vec3 pull = state.mu[k] * rod.force;
    add(right + analysis.position(a), pull - state.coupling[k] * at(work.delta, b));
    if (b < shape.nodes)
      add(right + analysis.position(b), -1.0 * (pull + state.coupling[k] * at(work.delta, a)));
    right[analysis.position(shape.nodes + k)] = -rod.c;
  }
  if (!state.bends.empty()) pull_by_bends(state, theta, soft > 0, work, factor.right);
  if (!state.tackles.empty()) pull_by_tackles(state, theta, soft, work, factor.right);
  if (!state.twists.empty()) pull_by_twists(state, theta, soft > 0, work, factor.right);
  hold_locked(state, analysis, right);
  factor.ldu.solve(factor.right);
  double sum = 0;
  for (std::uint32_t i = 0; i < shape.nodes; ++i) {
    const double* change = right + analysis.position(i);
    sum += (change[0] * change[0] + change[1] * change[1]) + change[2] * change[2];
  }
  return std::sqrt(sum / (shape.nodes * state.scale2));
}

void apply_change(LoopState& state, double scale, LoopWorkspace& work, const LoopWorkspace::Factor& factor) {
  const LoopTopology& shape = *state.topology;
  const SparseAnalysis& analysis = factor.system->analysis;
  for (std::uint32_t i = 0; i < shape.nodes; ++i)
    for (std::uint32_t c = 0; c < 3; ++c)
      work.delta[3 * i + c] += scale * factor.right[analysis.position(i) + c];
  for (std::uint32_t k = 0; k < state.mu.size(); ++k)
    state.mu[k] += scale * factor.right[analysis.position(shape.nodes + k)];
  change_torques(state, scale, factor.right, work);
}

double largest_misfit(const LoopState& state, const LoopWorkspace& work,
                      const LoopWorkspace::Factor& factor) {
  const LoopTopology& shape = *state.topology;
  double largest = 0;
  for (std::uint32_t k = 0; k < shape.rods.size(); ++k)
    if (factor.ldu.left_out(factor.system->analysis.position(shape.nodes + k)))
      largest = std::max(largest, std::abs(rod_terms(state, k, 0, 0, work).c) / state.length2[k]);
  const auto rods = static_cast<std::uint32_t>(shape.rods.size());
  for (std::uint32_t t = 0; t < state.tackles.size(); ++t)
    if (factor.ldu.left_out(factor.system->analysis.position(shape.nodes + rods + t)))
      largest = std::max(largest, tackle_misfit(state, work, t));
  return largest;
}

namespace {

/// Adds what rods' mass passes on from fixed vertices that change their velocity.
void pass_on_jumps(const LoopState& state, const SparseAnalysis& analysis, std::span<double> right) {
  const LoopTopology& shape = *state.topology;
  for (const std::uint32_t k : shape.anchored) {
    const auto [a, b] = shape.rods[k];
    const std::uint32_t fixed = b - shape.nodes;
    const Vec3 change = state.fixed_velocity[fixed] - state.fixed_last_velocity[fixed];
    add(right.data() + analysis.position(a), -state.coupling[k] * change);
  }
}

/// Factorises the matrix of a projection of velocities.
void factorize_projection(const LoopState& state, const LoopWorkspace& work, LoopWorkspace::Factor& factor) {
  const LoopTopology& shape = *state.topology;
  const LoopSystem& system = *factor.system;
  const SparseAnalysis& analysis = system.analysis;
  const auto give_of = [&](std::uint32_t i) { return is_held(state, i) ? 0 : 1 / state.mass[i]; };
  std::copy(state.mass.begin(), state.mass.end(), factor.values.data());
  std::fill(factor.values.begin() + static_cast<std::ptrdiff_t>(system.at_bends()), factor.values.end(), 0.0);
  for (std::uint32_t k = 0; k < shape.rods.size(); ++k) {
    const auto [a, b] = shape.rods[k];
    const Vec3 d = at(work.d, k);
    const RodRow row = projected_row(state, k, work).row;
    factor.values[system.at(k)] = state.coupling[k];
    write_rod(&factor.values[system.at(k)], d, row.use * d, row.soft);
    if (state.locks.any()) leave_out_locked(state, k, &factor.values[system.at(k)]);
    const double give = give_of(a) + give_of(b);
    factor.smallest[analysis.position(shape.nodes + k)] = redundant_pivot * row.use * dot(d, d) * give;
  }
  write_projected_tackles(state, work, std::span(factor.values).subspan(system.at_tackles()));
  set_tackle_pivots(state, give_of, factor);
  factor.ldu.factorize(factor.values, factor.smallest);
}

}  // namespace

void project_delta(const LoopState& state, const Projected& acts, LoopWorkspace& work,
                   LoopWorkspace::Factor& factor) {
  const LoopTopology& shape = *state.topology;
  const SparseAnalysis& analysis = factor.system->analysis;
  if (!acts.as_before) factorize_projection(state, work, factor);
  // The second time takes out what rounding left in the first.
  for (const bool again : {false, true}) {
    const double force = again ? 0 : acts.kick;
    for (std::uint32_t i = 0; i < shape.nodes; ++i)
      put(factor.right.data() + analysis.position(i), force * at(state.force, i));
    for (std::uint32_t k = 0; k < shape.rods.size(); ++k) {
      const auto [a, b] = shape.rods[k];
      const auto [known, row] = projected_row(state, k, work);
      double& right = factor.right[analysis.position(shape.nodes + k)];
      right = -(row.c + (again ? row.soft * right : 0));  // it was the pull that the first time found
      if (known == 0 || force == 0) continue;
      work.blows[k] += known;
      const Vec3 pull = known * at(work.d, k);
      add(factor.right.data() + analysis.position(a), pull);
      if (b < shape.nodes) add(factor.right.data() + analysis.position(b), -1.0 * pull);
    }
    if (acts.jumps && !again) pass_on_jumps(state, analysis, factor.right);
    lack_of_projected_tackles(state, work, factor.right);
    hold_locked(state, analysis, factor.right.data());
    factor.ldu.solve(factor.right);
    for (std::uint32_t i = 0; i < shape.nodes; ++i) {
      const double* change = factor.right.data() + analysis.position(i);
      add(work.delta.data() + 3 * std::size_t{i}, {change[0], change[1], change[2]});
    }
    for (std::uint32_t k = 0; k < state.mu.size(); ++k)
      work.blows[k] += factor.right[analysis.position(shape.nodes + k)];
  }
}

}  // namespace plumb::detail
