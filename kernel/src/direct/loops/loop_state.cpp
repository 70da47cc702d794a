#include "direct/loops/loop_state.hpp"

#include <algorithm>
#include <numeric>

namespace plumb::detail {

LoopTopology::LoopTopology(const layouts::Graph& island, LoopElements elements)
    : LoopElements(std::move(elements)), vertices(island.vertices) {
  for (const layouts::Edge edge : island.edges) {
    const bool turned = !island.movable[edge.a];
    rods.push_back(turned ? LoopRod{edge.b, edge.a} : LoopRod{edge.a, edge.b});
  }
  while (nodes < vertices && island.movable[nodes]) ++nodes;
  order.resize(vertices);
  std::iota(order.begin(), order.end(), 0u);
  find_anchored();
}

LoopTopology::LoopTopology(std::uint32_t movable, std::uint32_t all, Array<LoopRod> of)
    : nodes(movable), vertices(all), order(all), rods(std::move(of)) {
  std::iota(order.begin(), order.end(), 0u);
  find_anchored();
}

/// What is out of a reel pulls as the reel says.
void LoopTopology::find_anchored() {
  const auto is_reeled = [&](std::uint32_t rod) {
    return std::any_of(reels.begin(), reels.end(), [&](const LoopReel& reel) {
      return std::find(reel.rods.begin(), reel.rods.end(), rod) != reel.rods.end();
    });
  };
  for (std::uint32_t k = 0; k < rods.size(); ++k)
    if (rods[k].b >= nodes && !is_reeled(k)) anchored.push_back(k);
}

void LoopTopology::use_lines(std::span<const Vec3> positions) {
  const Array<Line> found = find_lines(rods, nodes, positions);
  renumber(RodLines(found, rods, nodes).node_order());
  lines = std::make_unique<RodLines>(found, rods, nodes);
}

void LoopTopology::use_net() {
  renumber(order_by_levels(rods, nodes));
  net = std::make_unique<NetPattern>(rods, nodes);
}

void LoopTopology::renumber(const Array<std::uint32_t>& nodes_in_order) {
  std::copy(nodes_in_order.begin(), nodes_in_order.end(), order.begin());
  Array<std::uint32_t> place(vertices);
  for (std::uint32_t i = 0; i < vertices; ++i) place[order[i]] = i;
  for (LoopRod& rod : rods) rod = {place[rod.a], place[rod.b]};
}

LoopState::LoopState(std::shared_ptr<const LoopTopology> shape) : topology(std::move(shape)) {
  const std::size_t n = topology->nodes, rods = topology->rods.size();
  x.assign(3 * std::size_t{topology->vertices}, 0);
  u = force = weight = Array<double>(3 * n);
  mass.assign(n, 0);
  mu = coupling = length2 = Array<double>(rods);
  fixed_velocity = fixed_last_velocity = Array<Vec3>(topology->vertices - n);
}

LoopState::LoopState(std::shared_ptr<const LoopTopology> shape, const Scene& scene, MassModel model,
                     std::span<const std::uint32_t> members, std::span<const std::uint32_t> edges)
    : topology(std::move(shape)) {
  const std::uint32_t n = topology->nodes;
  for (const std::uint32_t vertex : members) {
    const Vec3 p = scene.particles[vertex].position;
    x.insert(x.end(), {p.x, p.y, p.z});
  }
  u.assign(3 * std::size_t{n}, 0);
  force = weight = u;
  Array<double> first_moment;
  for (std::uint32_t i = 0; i < n; ++i) mass.push_back(scene.particles[members[i]].mass);
  first_moment = mass;
  double lengths = 0;
  for (std::uint32_t k = 0; k < topology->rods.size(); ++k) {
    const RodMass m = rod_mass(scene, edges[k], model);
    const auto [a, b] = topology->rods[k];
    const bool turned = scene.rods[edges[k]].a != members[a];
    mass[a] += turned ? m.bb : m.aa;
    first_moment[a] += (turned ? m.bb : m.aa) + m.ab;
    if (b < n) {
      mass[b] += turned ? m.aa : m.bb;
      first_moment[b] += (turned ? m.aa : m.bb) + m.ab;
    }
    coupling.push_back(m.ab);
    const double length = rod_length(scene, edges[k]);
    length2.push_back(length * length);
    lengths += length * length;
  }
  mu.assign(topology->rods.size(), 0);
  fixed_velocity.assign(topology->vertices - n, {});
  fixed_last_velocity = fixed_velocity;
  if (!mu.empty()) scale2 = lengths / static_cast<double>(mu.size());
  double total = 0;
  for (const double m : first_moment) total += m;
  mass_unit = total / n;
  for (std::uint32_t i = 0; i < n; ++i) {
    weighs.push_back(first_moment[i] / mass_unit);
    mass[i] /= mass_unit;
  }
  for (double& m : coupling) m /= mass_unit;
  set_gravity(scene.gravity);
  if (std::all_of(edges.begin(), edges.end(), [&](std::uint32_t i) { return scene.rods[i].law.is_rigid(); }))
    return;
  const auto give = [&](std::uint32_t i) { return i < n ? 1 / (mass[i] * mass_unit) : 0; };
  laws.make(length2);
  for (std::uint32_t k = 0; k < topology->rods.size(); ++k) {
    const auto [a, b] = topology->rods[k];
    laws.rods[k] = law_numbers(scene.rods[edges[k]].law, {mass_unit, give(a) + give(b)});
  }
}

void LoopState::set_gravity(Vec3 gravity) {
  for (std::size_t i = 0; i < weighs.size(); ++i) {
    const Vec3 pull = weighs[i] * gravity;
    weight[3 * i] = pull.x;
    weight[3 * i + 1] = pull.y;
    weight[3 * i + 2] = pull.z;
  }
  force = weight;
}

void LoopState::set_force(std::uint32_t node, Vec3 newton) {
  const double f[3] = {newton.x, newton.y, newton.z};
  for (std::uint32_t c = 0; c < 3; ++c) force[3 * node + c] = weight[3 * node + c] + f[c] / mass_unit;
}

}  // namespace plumb::detail
