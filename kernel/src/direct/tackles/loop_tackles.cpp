#include "direct/tackles/loop_tackles.hpp"

#include <algorithm>
#include <cmath>

#include "direct/loops/loop_newton.hpp"
#include "direct/loops/loop_vectors.hpp"

namespace plumb::detail {
namespace {

/// A segment pulls its first end along -force, and its length grows along `gradient`. Both have no unit.
/// `slope` is the derivative of force by what the ends come apart, but for force itself, in 1/m.
struct Pull {
  Vec3 force, gradient;
  double slope, growth;  ///< growth of the length, in m
};

/// Returns that of a segment whose ends come apart by e. With theta 1/2 force . e is the growth, so that the
/// work of a cord is its pull times that.
Pull pull_along(const TackleWorkspace::Segment& segment, Vec3 e, double theta) {
  const auto& [way, length] = segment;
  const Vec3 end_way = way + e;
  const double end = norm(end_way), both = length + end;
  if (both == 0) return {};
  const double growth = dot(way + end_way, e) / both, mean = length + theta * growth;
  if (mean == 0) return {};
  return {1 / mean * (way + theta * e), end > 0 ? 1 / end * end_way : Vec3{}, theta / mean, growth};
}

/// Walks along the cords of an island at the present displacements.
class Cords {
 public:
  /// Unless the island moves, cords lie where the substep starts.
  Cords(const LoopState& state, const LoopWorkspace& work, double theta, bool moves = true)
      : state_(state), work_(work), theta_(theta), moves_(moves) {}

  std::uint32_t count() const { return static_cast<std::uint32_t>(state_.topology->tackles.size()); }
  const LoopTackle& tackle(std::uint32_t t) const { return state_.topology->tackles[t]; }
  std::uint32_t multiplier(std::uint32_t t) const {
    return static_cast<std::uint32_t>(state_.topology->rods.size()) + t;
  }

  /// Calls f(segment, first vertex, second vertex, pull) along tackle `t`.
  template <class F>
  void along(std::uint32_t t, F&& f) const {
    const LoopTackle& of = tackle(t);
    const auto* segment = work_.tackles.segments.data() + of.first;
    for (std::uint32_t s = 0; s < of.segments(); ++s, ++segment) {
      const std::uint32_t a = of.vertices[s], b = of.vertices[s + 1];
      const Vec3 apart = moves_ ? at(work_.delta, a) - at(work_.delta, b) : Vec3{};
      f(s, a, b, pull_along(*segment, apart, theta_));
    }
  }

  TackleIterate iterate(std::uint32_t t) const {
    const double start = work_.tackles.starts[t] - work_.tackles.lengths[t];
    double growth = 0;
    along(t, [&](std::uint32_t, std::uint32_t, std::uint32_t, const Pull& pull) { growth += pull.growth; });
    return {start, start + growth, state_.mu[multiplier(t)]};
  }
  TackleRow row(std::uint32_t t, double soft) const {
    const LawFactors& factors = work_.laws.factors;
    if (soft > 0) return giving_tackle_row(state_.tackle_laws[t], factors.kick, 2 * soft, iterate(t));
    return tackle_row(state_.tackle_laws[t], {factors.kick, factors.rate, theta_}, iterate(t));
  }

 private:
  const LoopState& state_;
  const LoopWorkspace& work_;
  double theta_;
  bool moves_;
};

void add(double* to, Vec3 v) {
  put(to, Vec3{to[0], to[1], to[2]} + v);
}

/// Adds a segment to what -A^T and B have at its two vertices.
void add_ends(double* first, const Pull& pull, double use) {
  double* const second = first + LoopTackle::per_vertex;
  add(first, -1.0 * pull.force);
  add(first + 3, use * pull.gradient);
  add(second, pull.force);
  add(second + 3, -use * pull.gradient);
}

/// Writes `push` times the derivative of a segment's force by what its ends come apart.
void write_slope(double* tile, const Pull& pull, double push) {
  const double f[3] = {pull.force.x, pull.force.y, pull.force.z};
  const double g[3] = {pull.gradient.x, pull.gradient.y, pull.gradient.z};
  const double slope = push * pull.slope;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) tile[3 * r + c] = slope * ((r == c ? 1 : 0) - f[r] * g[c]);
}

/// Takes out what a tackle has at vertices that are locked. Their changes stay zero.
void leave_out_locked(const LoopState& state, const LoopTackle& tackle, double* values) {
  for (std::uint32_t o = 0; o < tackle.vertices.size(); ++o) {
    if (!state.locks.has(tackle.vertices[o])) continue;
    std::fill_n(values + LoopTackle::per_vertex * o, LoopTackle::per_vertex, 0.0);
    for (const std::uint32_t s : {o - 1, o})
      if (s < tackle.segments())
        std::fill_n(values + tackle.at_segments() + LoopTackle::per_segment * s, LoopTackle::per_segment,
                    0.0);
  }
}

/// Adds up the impulses (N s) with which cords pull by these multipliers, `scale` times as large.
void add_impulses(LoopState& state, const Cords& cords, std::span<const double> multipliers, double scale) {
  const std::uint32_t nodes = state.topology->nodes;
  for (std::uint32_t t = 0; t < cords.count(); ++t) {
    const double impulse = -scale * multipliers[cords.multiplier(t)];
    state.tackles[t].impulse += impulse;
    cords.along(t, [&](std::uint32_t, std::uint32_t a, std::uint32_t b, const Pull& pull) {
      if (a >= nodes) state.hold[a - nodes] += impulse * pull.force;
      if (b >= nodes) state.hold[b - nodes] -= impulse * pull.force;
    });
  }
}

/// Says whether a cord keeps its length in a projection of velocities.
bool holds(const LoopState& state, std::uint32_t t, double mu) {
  const TackleLaw& law = state.tackle_laws[t];
  return law.is_rigid && (!law.is_one_sided || mu < 0);
}

}  // namespace

void load_tackles(LoopState& state, const Scene& scene, std::span<const std::uint32_t> tackles) {
  double squares = 0, segments = 0;
  for (const std::uint32_t i : tackles) {
    const RodLaw& law = scene.tackles[i].law;
    const double length = tackle_length(scene, i);
    const double stiffness = law.is_elastic() ? law.stiffness / state.mass_unit : 0;
    state.tackle_laws.push_back({stiffness, law.damping / state.mass_unit, !law.is_elastic(), law.one_sided});
    state.tackles.push_back({length});
    const auto count = static_cast<double>(scene.tackles[i].particles.size() - 1);
    segments += count;
    squares += length * length / count;
  }
  if (tackles.empty()) return;
  const auto rods = static_cast<double>(state.topology->rods.size());
  state.scale2 = ((rods > 0 ? state.scale2 * rods : 0) + squares) / (rods + segments);
  state.mu.resize(state.topology->rods.size() + tackles.size());
}

void set_tackle_lengths(const LoopState& state, double h, TackleWorkspace& work) {
  for (std::size_t t = 0; t < state.tackles.size(); ++t) {
    const auto& [length, rate, impulse] = state.tackles[t];
    work.lengths[t] = length + (state.tackle_laws[t].is_rigid ? h : h / 2) * rate;
  }
}

void measure_tackles(const LoopState& state, TackleWorkspace& work) {
  for (std::size_t t = 0; t < state.tackles.size(); ++t) {
    const LoopTackle& tackle = state.topology->tackles[t];
    work.starts[t] = 0;
    for (std::uint32_t s = 0; s < tackle.segments(); ++s) {
      const Vec3 way = state.position(tackle.vertices[s]) - state.position(tackle.vertices[s + 1]);
      work.segments[tackle.first + s] = {way, norm(way)};
      work.starts[t] += norm(way);
    }
  }
}

void write_tackles(const LoopState& state, double theta, double soft, const LoopWorkspace& work,
                   std::span<double> values) {
  const Cords cords(state, work, theta);
  double* to = values.data();
  for (std::uint32_t t = 0; t < cords.count(); ++t) {
    const LoopTackle& tackle = cords.tackle(t);
    std::fill_n(to, tackle.values(), 0.0);
    const TackleRow row = cords.row(t, soft);
    const double mu = state.mu[cords.multiplier(t)], push = soft > 0 ? std::min(mu, 0.0) : mu;
    cords.along(t, [&](std::uint32_t s, std::uint32_t, std::uint32_t, const Pull& pull) {
      add_ends(to + LoopTackle::per_vertex * s, pull, row.use);
      double* const tile = to + tackle.at_segments() + LoopTackle::per_segment * s;
      write_slope(tile, pull, -push);
      write_slope(tile + 9, pull, push);
    });
    to[tackle.at_soft()] = row.soft;
    if (state.locks.any()) leave_out_locked(state, tackle, to);
    to += tackle.values();
  }
}

void pull_by_tackles(const LoopState& state, double theta, double soft, const LoopWorkspace& work,
                     std::span<double> right) {
  const Cords cords(state, work, theta);
  const LoopTopology& shape = *state.topology;
  const SparseAnalysis& analysis = shape.system->analysis;
  for (std::uint32_t t = 0; t < cords.count(); ++t) {
    const double mu = state.mu[cords.multiplier(t)];
    cords.along(t, [&](std::uint32_t, std::uint32_t a, std::uint32_t b, const Pull& pull) {
      if (a < shape.nodes) add(right.data() + analysis.position(a), mu * pull.force);
      if (b < shape.nodes) add(right.data() + analysis.position(b), -mu * pull.force);
    });
    right[analysis.position(shape.nodes + cords.multiplier(t))] = -cords.row(t, soft).c;
  }
}

void write_projected_tackles(const LoopState& state, const LoopWorkspace& work, std::span<double> values) {
  const Cords cords(state, work, 1, false);
  double* to = values.data();
  for (std::uint32_t t = 0; t < cords.count(); ++t) {
    const LoopTackle& tackle = cords.tackle(t);
    const double use = holds(state, t, state.mu[cords.multiplier(t)]) ? 1 : 0;
    std::fill_n(to, tackle.values(), 0.0);
    cords.along(t, [&](std::uint32_t s, std::uint32_t, std::uint32_t, const Pull& pull) {
      add_ends(to + LoopTackle::per_vertex * s, pull, use);
    });
    to[tackle.at_soft()] = 1 - use;
    if (state.locks.any()) leave_out_locked(state, tackle, to);
    to += tackle.values();
  }
}

void lack_of_projected_tackles(const LoopState& state, const LoopWorkspace& work, std::span<double> right) {
  const Cords cords(state, work, 1, false);
  const LoopTopology& shape = *state.topology;
  for (std::uint32_t t = 0; t < cords.count(); ++t) {
    double& lack = right[shape.system->analysis.position(shape.nodes + cords.multiplier(t))];
    lack = 0;
    if (!holds(state, t, state.mu[cords.multiplier(t)])) continue;
    lack = state.tackles[t].rate;
    cords.along(t, [&](std::uint32_t, std::uint32_t a, std::uint32_t b, const Pull& pull) {
      lack -= dot(pull.gradient, at(work.delta, a) - at(work.delta, b));
    });
  }
}

double tackle_misfit(const LoopState& state, const LoopWorkspace& work, std::uint32_t tackle) {
  const Cords cords(state, work, 1);
  return std::abs(cords.row(tackle, 0).c) / work.tackles.lengths[tackle];
}

double work_of_tackles(const LoopState& state, double theta, const LoopWorkspace& work) {
  const Cords cords(state, work, theta);
  double sum = 0;
  for (std::uint32_t t = 0; t < cords.count(); ++t) {
    const TackleLaw& law = state.tackle_laws[t];
    if (law.is_rigid && !law.is_one_sided && state.tackles[t].rate == 0) continue;
    const auto [start, end, mu] = cords.iterate(t);
    sum += mu * (end - start);
  }
  return sum;
}

double energy_of_tackles(const LoopState& state, double soft, const LoopWorkspace& work) {
  const Cords cords(state, work, 1);
  double sum = 0;
  for (std::uint32_t t = 0; t < cords.count(); ++t)
    sum += giving_tackle_pull(state.tackle_laws[t], work.laws.factors.kick, 2 * soft, cords.iterate(t).end)
               .energy;
  return sum;
}

void set_elastic_tackles(LoopState& state, double soft, const LoopWorkspace& work) {
  const Cords cords(state, work, 1);
  for (std::uint32_t t = 0; t < cords.count(); ++t)
    state.mu[cords.multiplier(t)] =
        giving_tackle_pull(state.tackle_laws[t], work.laws.factors.kick, 2 * soft, cords.iterate(t).end).mu;
}

void end_tackles(LoopState& state, const SubstepEnd& end, const LoopWorkspace& work) {
  for (LoopTackleMotion& tackle : state.tackles) tackle.length += end.h * tackle.rate;
  add_impulses(state, Cords(state, work, end.theta), state.mu, end.h / end.kick * end.mass_unit);
}

void hold_blows(LoopState& state, const LoopWorkspace& work) {
  add_impulses(state, Cords(state, work, 0, false), work.blows, state.mass_unit);
}

}  // namespace plumb::detail
