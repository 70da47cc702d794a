#include "direct/loops/settle.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "direct/loops/loop_vectors.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {
namespace {

/// Bows are tried by height, as a share of a rod a rod: from the first, each so many times as high as the
/// last, to one whose rods go down by their own length on average.
constexpr double least_bow = 1e-3, next_bow = 1.1;
constexpr int bows = 80;
/// Rods may give way so many times, one after the other, before rods are tried as they are again.
constexpr int most_elastic_steps = 3;

/// Returns the number of rods between every vertex and the nearest fixed one, or the first if none is fixed.
Array<std::uint32_t> distances_to_fixed(const LoopTopology& shape) {
  Array<Array<std::uint32_t>> neighbours(shape.vertices);
  for (const auto [a, b] : shape.rods) {
    neighbours[a].push_back(b);
    neighbours[b].push_back(a);
  }
  Array<std::uint32_t> out(shape.vertices, shape.vertices), found;
  for (std::uint32_t i = shape.nodes; i < shape.vertices; ++i) found.push_back(i);
  if (found.empty()) found.push_back(0);
  for (const std::uint32_t i : found) out[i] = 0;
  for (std::size_t k = 0; k < found.size(); ++k)
    for (const std::uint32_t next : neighbours[found[k]])
      if (out[next] == shape.vertices) {
        out[next] = out[found[k]] + 1;
        found.push_back(next);
      }
  return out;
}

/// Returns the direction in which particles are bent: along gravity, but across the line from the first
/// vertex to the farthest from it.
Vec3 bending_direction(const LoopState& state) {
  Vec3 along{}, pull{};
  for (std::uint32_t i = 0; i < state.topology->vertices; ++i) {
    const Vec3 from_first = state.position(i) - state.position(0);
    if (norm(from_first) > norm(along)) along = from_first;
    if (i < state.topology->nodes) pull += at(state.weight, i);
  }
  if (norm(along) > 0) along = (1 / norm(along)) * along;
  // Where gravity is along the line, or there is none, an axis serves.
  for (const Vec3 direction : {pull, Vec3{0, -1, 0}, Vec3{1, 0, 0}}) {
    const Vec3 across = direction - dot(direction, along) * along;
    if (norm(across) > 0.1 * norm(direction)) return (1 / norm(across)) * across;
  }
  return {0, -1, 0};
}

/// Returns how high a bow of height 1 (m a rod) lies at every node: steepest near what is fixed.
Array<double> bow_of(const LoopTopology& shape) {
  const Array<std::uint32_t> distances = distances_to_fixed(shape);
  const double farthest = *std::max_element(distances.begin(), distances.end());
  Array<double> out;
  for (std::uint32_t i = 0; i < shape.nodes; ++i)
    out.push_back(distances[i] * (1 - distances[i] / (2 * farthest)));
  return out;
}

Array<double> bowed(const LoopState& state, const Array<double>& bow, Vec3 by) {
  Array<double> x = state.x;
  for (std::uint32_t i = 0; i < bow.size(); ++i)
    if (!state.locks.has(i)) put(x.data() + 3 * std::size_t{i}, state.position(i) + bow[i] * by);
  return x;
}

/// Returns the sum of squares of what rods lack, relative to their lengths.
double misfit(const LoopState& state, const Array<double>& x) {
  double sum = 0;
  for (std::uint32_t k = 0; k < state.topology->rods.size(); ++k) {
    const auto [a, b] = state.topology->rods[k];
    const Vec3 d = at(x, a) - at(x, b);
    const double off = dot(d, d) / state.length2[k] - 1;
    sum += off * off;
  }
  for (std::uint32_t t = 0; t < state.tackles.size(); ++t) {
    const auto& vertices = state.topology->tackles[t].vertices;
    double way = 0;
    for (std::size_t s = 1; s < vertices.size(); ++s)
      way += norm(at(x, vertices[s]) - at(x, vertices[s - 1]));
    const double off = 2 * (way / state.tackles[t].length - 1);
    sum += off * off;
  }
  return sum;
}

/// Bends the island in the bow that brings rods nearest to their lengths.
void bend(LoopState& state) {
  const Array<double> bow = bow_of(*state.topology);
  const Vec3 direction = std::sqrt(state.scale2) * bending_direction(state);
  Array<double> best = state.x;  // where no bow has a finite misfit
  double least = std::numeric_limits<double>::infinity();
  double share = least_bow;
  for (int i = 0; i < bows; ++i, share *= next_bow) {
    Array<double> x = bowed(state, bow, share * direction);
    const double lacking = misfit(state, x);
    if (lacking >= least) continue;
    least = lacking;
    best = std::move(x);
  }
  state.x = std::move(best);
}

/// Tries to bring rods to their lengths as they are, then after each of so many steps with elastic rods.
bool settles(LoopState& state, LoopWorkspace& work, int elastic_steps) {
  const LoopStepper still(Gradient::new_, 0);
  for (int i = 0;; ++i) {
    std::fill(state.u.begin(), state.u.end(), 0.0);
    state.u_step = state.mu_kick = 0;
    Tally counters;
    if (still.try_substep(state, projection_step, work, counters)) return true;
    if (i == elastic_steps) return false;
    still.advance_elastic(state, projection_step, work, counters);
    if (counters.unsolved > 0) return false;
  }
}

}  // namespace

bool settle(LoopState& state, LoopWorkspace& work) {
  LoopMotion start = state.motion();
  work.tackles.are_smooth = true;
  // What gives way without a bow crumples, so that comes last.
  bool settled = settles(state, work, 0);
  if (!settled) {
    state.motion() = start;
    bend(state);
    settled = settles(state, work, most_elastic_steps);
  }
  if (!settled) {
    state.motion() = start;
    settled = settles(state, work, most_elastic_steps);
  }
  work.tackles.are_smooth = false;
  const bool is_finite =
      std::all_of(state.x.begin(), state.x.end(), [](double c) { return std::isfinite(c); });
  if (is_finite) std::swap(start.x, state.x);
  state.motion() = start;
  return settled;
}

}  // namespace plumb::detail
