#include "direct/bends/loop_bends.hpp"

#include <algorithm>
#include <cmath>

#include "direct/loops/loop_stepper.hpp"
#include "direct/loops/loop_vectors.hpp"
#include "scene/bends/bends.hpp"
#include "scene/bends/curvature.hpp"
#include "scene/bends/twists.hpp"

namespace plumb::detail {
namespace {

/// Returns w of three vectors: d1/L1 - d2/L2 from differences, which do not cancel far from the origin.
Vec3 weighted(const BendNumbers& numbers, const LoopBend& bend, std::span<const double> x) {
  const auto [a, b, c] = bend.vertices;
  return -numbers.weights[0] * (at(x, b) - at(x, a)) + numbers.weights[2] * (at(x, c) - at(x, b));
}

BendPull pull_of(const LoopState& state, std::uint32_t k, double theta, bool gives,
                 const LoopWorkspace& work) {
  const BendNumbers& numbers = work.bends[k];
  const Vec3 change = weighted(numbers, state.topology->bends[k], work.delta);
  const double kick = work.laws.factors.kick;
  if (gives) return definite_bend_pull(numbers, kick, work.bend_starts[k] + change);
  return bend_pull(numbers, {kick, kick * work.laws.factors.rate, theta}, work.bend_starts[k], change);
}

/// Returns the numbers of a bend whose rods may have other lengths than in the scene, or be broken.
BendNumbers present_numbers(const LoopState& state, const LoopBendNumbers& bend) {
  BendNumbers out = bend.law;
  double lengths[2] = {-1 / out.weights[0], -1 / out.weights[2]};
  for (std::size_t side = 0; side < 2; ++side) {
    const std::uint32_t rod = bend.rods[side];
    if (rod == IslandRods::none) continue;
    if (state.laws.is_broken(rod)) return {out.weights, 0, out.curvature, 0};
    if (state.laws.moves) lengths[side] = std::sqrt(state.length2[rod]);
  }
  if (state.laws.moves) out.weights = bend_weights(lengths[0], lengths[1]);
  return out;
}

}  // namespace

BendTable::BendTable(const Scene& of) : scene(of), lengths(bend_lengths(of)) {
  if (of.twists.empty()) return;
  const RodTable rods(of);
  for (const Twist& twist : of.twists) twist_lengths.push_back(twist_length(of, rods, twist));
}

void load_bends(LoopState& state, const BendTable& table, const IslandRods& rods,
                std::span<const std::uint32_t> bends) {
  for (std::size_t k = 0; k < bends.size(); ++k) {
    const Bend& bend = table.scene.bends[bends[k]];
    const auto [first, second] = table.lengths[bends[k]];
    const auto [a, b, c] = state.topology->bends[k].vertices;
    state.bends.push_back({{bend_weights(first, second), bend.stiffness / state.mass_unit,
                            curvature_of_angle(bend.angle), bend.damping / state.mass_unit},
                           {rods.find(a, b), rods.find(b, c)}});
  }
}

void measure_bends(const LoopState& state, LoopWorkspace& work) {
  for (std::uint32_t k = 0; k < state.bends.size(); ++k) {
    if (state.laws.any()) work.bends[k] = present_numbers(state, state.bends[k]);
    work.bend_starts[k] = weighted(work.bends[k], state.topology->bends[k], state.x);
  }
}

void write_bends(const LoopState& state, double theta, bool gives, const LoopWorkspace& work,
                 std::span<double> values, std::span<double> resists) {
  double* at = values.data();
  for (std::uint32_t k = 0; k < state.bends.size(); ++k) {
    const auto& weights = work.bends[k].weights;
    const BendPull bend = pull_of(state, k, theta, gives, work);
    const auto& vertices = state.topology->bends[k].vertices;
    for (const auto [i, j] : LoopBend::pairs) {
      const bool is_locked = state.locks.has(vertices[i]) || state.locks.has(vertices[j]);
      for (const double slope : bend.slope) *at++ = is_locked ? 0 : weights[i] * weights[j] * slope;
    }
    const double mean = (bend.slope[0] + bend.slope[4] + bend.slope[8]) / 3;
    for (std::size_t i = 0; i < 3; ++i)
      if (const std::uint32_t node = vertices[i]; node < state.topology->nodes)
        resists[node] += weights[i] * weights[i] * mean;
  }
}

void pull_by_bends(const LoopState& state, double theta, bool gives, const LoopWorkspace& work,
                   std::span<double> right) {
  const SparseAnalysis& analysis = state.topology->system->analysis;
  for (std::uint32_t k = 0; k < state.bends.size(); ++k) {
    const Vec3 pull = pull_of(state, k, theta, gives, work).pull;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t node = state.topology->bends[k].vertices[i];
      if (node >= state.topology->nodes) continue;
      double* const to = right.data() + analysis.position(node);
      put(to, Vec3{to[0], to[1], to[2]} - work.bends[k].weights[i] * pull);
    }
  }
}

LoopWork work_of_bends(const LoopState& state, const LoopWorkspace& work, double least) {
  LoopWork out;
  for (std::uint32_t k = 0; k < state.bends.size(); ++k) {
    const Vec3 pull = pull_of(state, k, 0.5, false, work).pull;
    const Vec3 change = weighted(work.bends[k], state.topology->bends[k], work.delta);
    out.done -= dot(pull, change);
    out.scale += norm(pull) * (norm(change) + least);
  }
  return out;
}

void hold_bends(LoopState& state, const SubstepEnd& end, const LoopWorkspace& work) {
  if (!state.laws.any()) return;
  std::fill(state.laws.bent.begin(), state.laws.bent.end(), 0.0);
  const std::uint32_t nodes = state.topology->nodes;
  for (std::uint32_t k = 0; k < state.bends.size(); ++k) {
    const auto& [weights, stiffness, curvature, damping] = work.bends[k];
    const auto& vertices = state.topology->bends[k].vertices;
    const Vec3 pull = 1 / end.kick * pull_of(state, k, end.theta, false, work).pull;
    for (std::size_t side = 0; side < 2; ++side) {
      const std::uint32_t rod = state.bends[k].rods[side], a = vertices[side], b = vertices[side + 1];
      if (rod == IslandRods::none) continue;
      const Vec3 growth = at(work.delta, b) - at(work.delta, a);
      const Vec3 d = at(state.x, b) - at(state.x, a) - (1 - end.theta) * growth;
      state.laws.bent[rod] += (side == 0 ? -weights[0] : weights[2]) * dot(pull, d) / norm(d);
    }
    for (std::size_t i = 0; state.laws.pulls && i < 3; ++i)
      if (vertices[i] >= nodes)
        state.hold[vertices[i] - nodes] += (end.h * end.mass_unit * weights[i]) * pull;
  }
}

double energy_of_bends(const LoopState& state, const LoopWorkspace& work) {
  double sum = 0;
  for (std::uint32_t k = 0; k < state.bends.size(); ++k) {
    const Vec3 end = work.bend_starts[k] + weighted(work.bends[k], state.topology->bends[k], work.delta);
    sum += bending_energy(work.laws.factors.kick * work.bends[k].stiffness, work.bends[k].curvature,
                          dot(end, end));
  }
  return sum;
}

}  // namespace plumb::detail
