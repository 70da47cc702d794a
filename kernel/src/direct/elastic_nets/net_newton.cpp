#include "direct/elastic_nets/net_newton.hpp"

#include <algorithm>
#include <cmath>

#include "direct/laws/change_share.hpp"
#include "direct/loops/loop_newton.hpp"
#include "direct/loops/loop_vectors.hpp"

namespace plumb::detail {
namespace {

constexpr int most_iterations = 30;
/// One solution of a Newton step leaves this share of what is left, since the next one's directions are
/// better. A projection is solved once, to rounding.
constexpr double coarse = 1e-3, projected = 1e-12;
/// A solution takes at most so many iterations of conjugate gradients.
constexpr int most_conjugate_iterations = 400;
/// The last change, RMS over nodes relative to a rod, leaves this by its rate. Where a change this small does
/// not fall any more, it is rounding.
constexpr double converged_rest = 1e-14, rounding = 1e-9, lost_rate = 0.7;
/// A change of many rod lengths does not lead back.
constexpr double hopeless_change = 30;

/// Puts into net.right what nodes lack, rods included, and into net.parts what rods add to the matrix.
void assemble(const LoopState& state, double theta, const LoopWorkspace& work, NetWorkspace& net) {
  const LoopTopology& shape = *state.topology;
  for (std::uint32_t i = 0; i < shape.nodes; ++i)
    net.right[i] = at(work.load, i) - state.mass[i] * at(work.delta, i);
  for (std::uint32_t k = 0; k < shape.rods.size(); ++k) {
    const auto [a, b] = shape.rods[k];
    const RodTerms rod = rod_terms(state, k, theta, 0, work);
    net.lacking[k] = rod.c / rod.soft;
    const double pull = state.mu[k] - net.lacking[k];
    net.right[a] += pull * rod.force;
    if (b < shape.nodes) net.right[b] = net.right[b] - pull * rod.force;
    net.parts[k] = {rod.force, rod.use / rod.soft, -theta * state.mu[k]};
  }
}

NetMatrix::Outcome solve(const LoopState& state, NetWorkspace& net) {
  net.matrix.set(state.mass, net.parts);
  auto outcome = net.matrix.solve(net.right, coarse, most_conjugate_iterations, net.change);
  if (outcome != NetMatrix::Outcome::indefinite) return outcome;
  for (NetMatrix::RodPart& rod : net.parts) rod.across = std::max(rod.across, 0.0);
  net.matrix.set(state.mass, net.parts);
  return net.matrix.solve(net.right, coarse, most_conjugate_iterations, net.change);
}

/// Makes `scale` times the change.
void apply(LoopState& state, double scale, const NetWorkspace& net, LoopWorkspace& work) {
  const LoopTopology& shape = *state.topology;
  for (std::uint32_t k = 0; k < shape.rods.size(); ++k) {
    const auto [a, b] = shape.rods[k];
    const Vec3 apart = net.change[a] - (b < shape.nodes ? net.change[b] : Vec3{});
    state.mu[k] -= scale * (net.lacking[k] + net.parts[k].along * dot(net.parts[k].f, apart));
  }
  for (std::uint32_t i = 0; i < shape.nodes; ++i)
    put(work.delta.data() + 3 * std::size_t{i}, at(work.delta, i) + scale * net.change[i]);
}

}  // namespace

NetWorkspace::NetWorkspace(const NetPattern& pattern)
    : matrix(pattern),
      parts(pattern.rods.size()),
      lacking(pattern.rods.size()),
      right(pattern.nodes),
      change(pattern.nodes) {}

bool iterate_net(LoopState& state, double theta, LoopWorkspace& work, Tally& counters) {
  NetWorkspace& net = *work.net;
  measure_rods(state, work);
  double last = 0;
  ChangeShare share;
  for (int i = 0; i < most_iterations; ++i) {
    assemble(state, theta, work, net);
    if (solve(state, net) != NetMatrix::Outcome::solved) return false;
    ++counters.newton;
    double sum = 0;
    for (const Vec3 change : net.change) sum += dot(change, change);
    const double change = std::sqrt(sum / (state.topology->nodes * state.scale2));
    if (!(change <= hopeless_change)) return false;
    const double rate = last > 0 ? change / last : 1;
    const double made = share.next(rate);
    apply(state, made, net, work);
    if ((made == 1 && change * rate <= converged_rest) || (change <= rounding && rate > lost_rate))
      return true;
    last = change;
  }
  return false;
}

bool project_net(const LoopState& state, double kick, LoopWorkspace& work) {
  const LoopTopology& shape = *state.topology;
  NetWorkspace& net = *work.net;
  for (std::uint32_t i = 0; i < shape.nodes; ++i) net.right[i] = kick * at(state.force, i);
  for (std::uint32_t k = 0; k < shape.rods.size(); ++k) {
    const auto [a, b] = shape.rods[k];
    const auto [known, row] = projected_row(state, k, work);
    if (!(row.soft > 0)) return false;
    const Vec3 d = at(work.d, k), pull = (known - row.c / row.soft) * d;
    net.right[a] += pull;
    if (b < shape.nodes) net.right[b] = net.right[b] - pull;
    net.parts[k] = {d, row.use / row.soft, 0};
  }
  net.matrix.set(state.mass, net.parts);
  if (net.matrix.solve(net.right, projected, most_conjugate_iterations, net.change) !=
      NetMatrix::Outcome::solved)
    return false;
  for (std::uint32_t i = 0; i < shape.nodes; ++i)
    put(work.delta.data() + 3 * std::size_t{i}, at(work.delta, i) + net.change[i]);
  for (std::uint32_t k = 0; k < shape.rods.size(); ++k) {
    const auto [known, row] = projected_row(state, k, work);  // of velocities that have changed
    work.blows[k] = known - row.c / row.soft;
  }
  return true;
}

}  // namespace plumb::detail
