#include "direct/tackles/loop_tackles.hpp"

#include <algorithm>
#include <cmath>

#include "direct/tackles/cords.hpp"
#include "direct/tackles/loop_pulleys.hpp"

namespace plumb::detail {

Pull pull_along(const TackleWorkspace::Segment& segment, Vec3 e, double theta) {
  const auto& [way, length] = segment;
  const Vec3 end_way = way + e;
  const double end = norm(end_way), both = length + end;
  if (both == 0) return {};
  const double growth = dot(way + end_way, e) / both, mean = length + theta * growth;
  if (mean == 0) return {};
  return {1 / mean * (way + theta * e), end > 0 ? 1 / end * end_way : Vec3{}, theta / mean, growth};
}

namespace {

void add(double* to, Vec3 v) {
  put(to, Vec3{to[0], to[1], to[2]} + v);
}

/// Adds a segment to what B has at its two vertices, and to -A^T unless it has a multiplier of its own.
void add_ends(double* first, const Pull& pull, double use, bool is_own) {
  double* const second = first + LoopTackle::per_vertex;
  add(first + 3, use * pull.gradient);
  add(second + 3, -use * pull.gradient);
  if (is_own) return;
  add(first, -1.0 * pull.force);
  add(second, pull.force);
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
  leave_out_locked_pulleys(state, tackle, values);
}

/// Adds up the impulses (N s) with which cords pull by these multipliers, `scale` times as large.
void add_impulses(LoopState& state, const Cords& cords, std::span<const double> multipliers, double scale) {
  const std::uint32_t nodes = state.topology->nodes;
  for (std::uint32_t t = 0; t < cords.count(); ++t) {
    const LoopTackle& tackle = cords.tackle(t);
    cords.along(t, [&](std::uint32_t s, std::uint32_t a, std::uint32_t b, const Pull& pull) {
      const double impulse = -scale * multipliers[cords.multiplier(t, s)];
      if (s == 0) state.tackles[t].impulse += impulse;
      if (s > 0 && tackle.rubs) state.pulley_impulses[tackle.first_pulley + s - 1] += impulse;
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
    state.tackle_laws.push_back({stiffness, law.damping / state.mass_unit, !law.is_elastic(), law.one_sided,
                                 scene.tackles[i].friction});
    state.tackles.push_back({length});
    const auto count = static_cast<double>(scene.tackles[i].particles.size() - 1);
    segments += count;
    squares += length * length / count;
  }
  if (tackles.empty()) return;
  const auto rods = static_cast<double>(state.topology->rods.size());
  state.scale2 = ((rods > 0 ? state.scale2 * rods : 0) + squares) / (rods + segments);
  state.pulley_impulses.resize(state.topology->pulleys());
  state.mu.resize(state.topology->rods.size() + tackles.size() + state.pulley_impulses.size());
}

void set_tackle_lengths(const LoopState& state, double h, TackleWorkspace& work) {
  for (std::size_t t = 0; t < state.tackles.size(); ++t) {
    const auto& [length, rate, jump, impulse] = state.tackles[t];
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
    cords.along(t, [&](std::uint32_t s, std::uint32_t, std::uint32_t, const Pull& pull) {
      const double mu = state.mu[cords.multiplier(t, s)], push = soft > 0 ? std::min(mu, 0.0) : mu;
      add_ends(to + LoopTackle::per_vertex * s, pull, row.use, s > 0 && tackle.rubs);
      double* const tile = to + tackle.at_segments() + LoopTackle::per_segment * s;
      write_slope(tile, pull, -push);
      write_slope(tile + 9, pull, push);
    });
    to[tackle.at_soft()] = row.soft;
    if (tackle.rubs) write_pulleys(cords, t, soft > 0 ? nullptr : &Pulley::slide, work.tackles, to);
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
    cords.along(t, [&](std::uint32_t s, std::uint32_t a, std::uint32_t b, const Pull& pull) {
      const double mu = state.mu[cords.multiplier(t, s)];
      if (a < shape.nodes) add(right.data() + analysis.position(a), mu * pull.force);
      if (b < shape.nodes) add(right.data() + analysis.position(b), -mu * pull.force);
    });
    right[analysis.position(shape.nodes + cords.multiplier(t))] = -cords.row(t, soft).c;
    lack_of_pulleys(cords, t, soft > 0 ? nullptr : &Pulley::slide, {state, work}, right);
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
      add_ends(to + LoopTackle::per_vertex * s, pull, use, s > 0 && tackle.rubs);
    });
    to[tackle.at_soft()] = 1 - use;
    if (tackle.rubs) write_pulleys(cords, t, &Pulley::blow, work.tackles, to);
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
    lack_of_projected_pulleys(cords, t, {state, work}, right);
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
    if (cords.tackle(t).rubs) {
      cords.along(t, [&](std::uint32_t s, std::uint32_t, std::uint32_t, const Pull& pull) {
        sum += state.mu[cords.multiplier(t, s)] * pull.growth;
      });
      continue;
    }
    if (law.is_rigid && !law.is_one_sided && state.tackles[t].rate == 0) continue;
    const auto [start, end, mu, paid] = cords.iterate(t);
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
  for (std::uint32_t t = 0; t < cords.count(); ++t) {
    const double mu =
        giving_tackle_pull(state.tackle_laws[t], work.laws.factors.kick, 2 * soft, cords.iterate(t).end).mu;
    for (std::uint32_t s = 0; s <= cords.tackle(t).pulleys(); ++s) state.mu[cords.multiplier(t, s)] = mu;
  }
}

void end_tackles(LoopState& state, const SubstepEnd& end, const LoopWorkspace& work) {
  for (LoopTackleMotion& tackle : state.tackles) tackle.length += end.h * tackle.rate;
  add_impulses(state, Cords(state, work, end.theta), state.mu, end.h / end.kick * end.mass_unit);
}

void hold_blows(LoopState& state, const LoopWorkspace& work) {
  add_impulses(state, Cords(state, work, 0, false), work.blows, state.mass_unit);
}

}  // namespace plumb::detail
