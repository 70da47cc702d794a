#include "direct/trees/tree_state.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace plumb::detail {
namespace {

using layouts::AlignedBuffer;
using namespace simd;

/// A pivot below this, relative to what it is made of, is rounding. Ties then make the rod redundant.
template <class T>
constexpr T smallest_pivot = 64 * std::numeric_limits<T>::epsilon();

/// A bound of a node's mass is at least this share of it, since rods whose mass is all in their middle leave
/// none.
constexpr double least_share = 1e-6;

template <class B>
void copy_entries(B& to, std::uint32_t to_lanes, std::uint32_t to_lane, const B& from,
                  std::uint32_t from_lanes, std::uint32_t from_lane) {
  for (std::size_t i = 0; i * to_lanes < to.size(); ++i)
    to[i * to_lanes + to_lane] = from[i * from_lanes + from_lane];
}

/// Copies what rods do besides keeping their lengths, by copy(buffer, other's buffer).
template <class T, class Copy>
void copy_laws(TreeState<T>& to, const TreeState<T>& from, Copy&& copy) {
  to.laws.copy_flags(from.laws);
  if (!to.laws.any) return;
  to.laws.make(to.mu.size(), to.tie_mu.size(), to.lanes);
  for_laws(to.laws, from.laws,
           [&](auto& rods, auto& ties, std::uint32_t, const auto& from_rods, const auto& from_ties) {
             copy(rods, from_rods);
             copy(ties, from_ties);
           });
}

}  // namespace

TreeTopology::TreeTopology(const layouts::Tree& tree, LineBends of)
    : bends(std::move(of)),
      nodes(tree.nodes()),
      ties(static_cast<std::uint32_t>(tree.ties.size() + bends.clamps.size())),
      parent(tree.parent),
      tie_begin(tree.tie_begin),
      below_slot(nodes, no_slot),
      holds_ties(nodes, 0) {
  const std::uint32_t first_ties = tie_begin[1],
                      last_ties = nodes > 1 ? tie_begin[nodes] - tie_begin[nodes - 1] : 0;
  is_line = first_ties <= 1 && last_ties <= 1 && first_ties + last_ties == tie_begin[nodes];
  for (std::uint32_t i = 1; i < nodes; ++i) is_line = is_line && parent[i] + 1 == i;
  for (std::uint32_t i = nodes; i-- > 0;) {
    if (tie_begin[i] != tie_begin[i + 1]) holds_ties[i] = 1;
    if (i == 0) break;
    if (holds_ties[i]) holds_ties[parent[i]] = 1;
    if (parent[i] + 1 != i && below_slot[parent[i]] == no_slot) below_slot[parent[i]] = below_slots++;
  }
}

template <class T>
TreeState<T>::TreeState(std::shared_ptr<const TreeTopology> shape, std::uint32_t width)
    : topology(std::move(shape)), lanes(width), trees(width), idle(width, 0) {
  const std::size_t n = std::size_t{topology->nodes} * lanes, p = std::size_t{topology->ties} * lanes;
  node = AlignedBuffer<T>(tree_fields::node * n);
  tie = AlignedBuffer<T>(tree_fields::tie * p);
  u = AlignedBuffer<T>(3 * n);
  acceleration = AlignedBuffer<T>(3 * n);
  acceleration_before = AlignedBuffer<T>(3 * n);
  force = AlignedBuffer<T>(3 * n);
  tie_delta = AlignedBuffer<T>(3 * p);
  tie_u = AlignedBuffer<T>(3 * p);
  mu = AlignedBuffer<T>(n);
  tie_mu = AlignedBuffer<T>(p);
  mu_before = AlignedBuffer<T>(n);
  tie_mu_before = AlignedBuffer<T>(p);
  length2 = AlignedBuffer<double>(n);
  tie_length2 = AlignedBuffer<double>(p);
  x = AlignedBuffer<double>(3 * n);
  tie_x = AlignedBuffer<double>(3 * p);
  weight = AlignedBuffer<double>(3 * n);
  weighs = AlignedBuffer<double>(n);
  if (topology->bends.any()) {
    bends.law = AlignedBuffer<T>(tree_fields::bend * (n + 2 * std::size_t{lanes}));
  }
  if (topology->bends.is_twisted()) {
    twists.numbers.resize(lanes);
    twists.twisted.assign(lanes, 0);
  }
  mass_unit.assign(lanes, 1);
  scale2.assign(lanes, 1);
  tie_velocity.assign(p, {});
  tie_last_velocity.assign(p, {});
  for (auto* times : {&u_step, &u_step_before, &mu_kick, &mu_kick_before}) times->assign(lanes, 0);
  smooth.assign(lanes, 0);
  known.assign(lanes, 0);
  gave.assign(lanes, 0);
  elastic.assign(lanes, 0);
  next_elastic.assign(lanes, 0);
  effort.assign(lanes, {});
}

/// Masses (kg) are summed up here, by node, while a lane is filled.
template <class T>
struct TreeState<T>::Masses {
  Masses(std::size_t nodes, std::size_t ties)
      : all(4 * nodes + ties),
        mass(std::span(all).first(nodes)),
        least(std::span(all).subspan(nodes, nodes)),
        first_moment(std::span(all).subspan(2 * nodes, nodes)),
        coupling(std::span(all).subspan(3 * nodes, nodes)),
        tie_coupling(std::span(all).last(ties)) {}

  Array<double> all;  ///< of which the others are parts
  std::span<double> mass, least, first_moment, coupling;
  std::span<double> tie_coupling;  ///< It is by tie.
};

template <class T>
void TreeState<T>::put(AlignedBuffer<double>& to, std::uint32_t first, std::uint32_t lane, Vec3 v) const {
  to[at(first, lane)] = v.x;
  to[at(first + 1, lane)] = v.y;
  to[at(first + 2, lane)] = v.z;
}

template <class T>
void TreeState<T>::fill_lane(std::uint32_t lane, const Scene& scene, MassModel model,
                             const layouts::Tree& tree, const TreeMembers& members) {
  const std::uint32_t nodes = tree.nodes();
  Masses masses(nodes, tree.ties.size());
  // These have names of their own, since clang 14 lets no lambda take bindings.
  const std::span<double> mass = masses.mass, least = masses.least, first_moment = masses.first_moment;
  const std::span<double> coupling = masses.coupling, tie_coupling = masses.tie_coupling;
  const auto square = [&](std::uint32_t e) {
    const double length = rod_length(scene, members.edges[e]);
    return length * length;
  };
  // Adds the rod of local edge `e`, with `vertex` (local) as its own end; the other may be fixed.
  const auto add_rod = [&](std::uint32_t e, std::uint32_t vertex, std::uint32_t i, double& couples,
                           bool other_moves) {
    const std::uint32_t rod = members.edges[e];
    const RodMass m = rod_mass(scene, rod, model);
    const bool is_a = scene.rods[rod].a == members.vertices[vertex];
    const double own = is_a ? m.aa : m.bb, other = is_a ? m.bb : m.aa;
    masses.mass[i] += own;
    // [aa ab; ab bb] lies above its diagonal less |ab| sqrt(aa/bb) and |ab| sqrt(bb/aa).
    masses.least[i] += other_moves && m.ab != 0 ? own - std::abs(m.ab) * std::sqrt(own / other) : own;
    masses.first_moment[i] += own + m.ab;
    couples = m.ab;
  };
  for (std::uint32_t i = 0; i < nodes; ++i) {
    const Particle& particle = scene.particles[members.vertices[tree.vertex[i]]];
    put(x, 3 * i, lane, particle.position);
    mass[i] += particle.mass;
    least[i] += particle.mass;
    first_moment[i] += particle.mass;
    for (std::uint32_t k = tree.tie_begin[i]; k < tree.tie_begin[i + 1]; ++k) {
      add_rod(tree.ties[k].edge, tree.vertex[i], i, tie_coupling[k], false);
      tie_length2[at(k, lane)] = square(tree.ties[k].edge);
      put(tie_x, 3 * k, lane, scene.particles[members.vertices[tree.ties[k].vertex]].position);
    }
    if (i == 0) continue;
    const std::uint32_t p = tree.parent[i];
    add_rod(tree.edge[i], tree.vertex[i], i, coupling[i], true);
    length2[at(i, lane)] = square(tree.edge[i]);
    double same;
    add_rod(tree.edge[i], tree.vertex[p], p, same, true);
  }
  double sum = 0;
  for (std::uint32_t i = 1; i < nodes; ++i) sum += length2[at(i, lane)];
  for (std::uint32_t k = 0; k < topology->ties; ++k) sum += tie_length2[at(k, lane)];
  const auto& clamps = topology->bends.clamps;
  for (std::uint32_t c = 0; c < clamps.size(); ++c)
    put(tie_x, 3 * (tree.tie_begin[nodes] + c), lane, scene.particles[members.vertices[clamps[c]]].position);
  const std::uint32_t rods = topology->rods();
  scale2[lane] = rods > 0 ? sum / rods : 1;
  write_masses(lane, masses, scene.gravity);
  fill_laws(lane, scene, tree, members);
}

template <class T>
void TreeState<T>::fill_laws(std::uint32_t lane, const Scene& scene, const layouts::Tree& tree,
                             const TreeMembers& members) {
  const auto law_of = [&](std::uint32_t edge) -> const RodLaw& {
    return scene.rods[members.edges[edge]].law;
  };
  const bool all_rigid = std::all_of(members.edges.begin(), members.edges.end(),
                                     [&](std::uint32_t rod) { return scene.rods[rod].law.is_rigid(); });
  if (all_rigid && !laws.any) return;
  // The first lane with laws makes them for those before, too.
  const std::size_t first_lane = laws.any ? lane : 0, stride = laws.any ? lanes : 1;
  laws.make(mu.size(), tie_mu.size(), lanes);
  const auto root_of = [](const AlignedBuffer<double>& squares, std::size_t i) {
    return std::sqrt(squares[i]);
  };
  for (std::size_t i = first_lane; i < mu.size(); i += stride) laws.length.rods[i] = root_of(length2, i);
  for (std::size_t k = first_lane; k < tie_mu.size(); k += stride)
    laws.length.ties[k] = root_of(tie_length2, k);
  const double unit = mass_unit[lane];
  const auto give = [&](std::uint32_t i) {
    return static_cast<double>(node[at(tree_fields::node * i + 3, lane)]) / unit;
  };
  const auto first = [&](std::uint32_t i) { return at(tree_fields::law * i, lane); };
  for (std::uint32_t i = 0; i < topology->nodes; ++i) {
    if (i > 0)
      laws.put(laws.law.rods, first(i), lanes, law_of(tree.edge[i]), {unit, give(i) + give(tree.parent[i])});
    for (std::uint32_t k = tree.tie_begin[i]; k < tree.tie_begin[i + 1]; ++k)
      laws.put(laws.law.ties, first(k), lanes, law_of(tree.ties[k].edge), {unit, give(i)});
  }
}

/// Writes the numbers of a lane that follow from its masses, which are stored relative to their mean.
template <class T>
void TreeState<T>::write_masses(std::uint32_t lane, const Masses& masses, Vec3 gravity) {
  const auto& [all, mass, least, first_moment, coupling, tie_coupling] = masses;
  const std::uint32_t nodes = topology->nodes;
  double total = 0;
  for (const double m : first_moment) total += m;
  const double unit = total / nodes;
  mass_unit[lane] = unit;
  for (std::uint32_t i = 0; i < nodes; ++i) {
    const T floor = topology->holds_ties[i] ? smallest_pivot<T> : T(0);
    node[at(tree_fields::node * i, lane)] = static_cast<T>(mass[i] / unit);
    node[at(tree_fields::node * i + 1, lane)] = static_cast<T>(coupling[i] / unit);
    is_coupled = is_coupled || coupling[i] != 0;
    node[at(tree_fields::node * i + 2, lane)] = floor;
    node[at(tree_fields::node * i + 3, lane)] =
        static_cast<T>(unit / std::max(least[i], least_share * mass[i]));
    weighs[at(i, lane)] = first_moment[i];
    for (std::uint32_t k = topology->tie_begin[i]; k < topology->tie_begin[i + 1]; ++k) {
      tie[at(tree_fields::tie * k, lane)] = static_cast<T>(tie_coupling[k] / unit);
      is_coupled = is_coupled || tie_coupling[k] != 0;
      tie[at(tree_fields::tie * k + 1, lane)] = floor;
    }
  }
  set_gravity(lane, gravity);
}

template <class T>
void TreeState<T>::set_gravity(std::uint32_t lane, Vec3 gravity) {
  for (std::uint32_t i = 0; i < topology->nodes; ++i) {
    put(weight, 3 * i, lane, weighs[at(i, lane)] * gravity);
    set_force(i, lane, {});
  }
}

template <class T>
void TreeState<T>::copy_lane(std::uint32_t lane, const TreeState& from, std::uint32_t from_lane) {
  const auto copy = [&](auto& to, const auto& source) {
    copy_entries(to, lanes, lane, source, from.lanes, from_lane);
  };
  for_motion(*this, from, copy);
  copy(node, from.node);
  copy(tie, from.tie);
  copy(force, from.force);
  copy(tie_delta, from.tie_delta);
  copy(tie_u, from.tie_u);
  copy(length2, from.length2);
  copy(tie_length2, from.tie_length2);
  copy(tie_x, from.tie_x);
  copy(weight, from.weight);
  copy(weighs, from.weighs);
  copy(tie_velocity, from.tie_velocity);
  copy(tie_last_velocity, from.tie_last_velocity);
  copy(mass_unit, from.mass_unit);
  copy(scale2, from.scale2);
  copy(bends.law, from.bends.law);
  bends.damped = from.bends.damped;
  copy(twists.numbers, from.twists.numbers);
  copy(twists.twisted, from.twists.twisted);
  if (grabs.any() || from.grabs.any()) grabs.copy_lane(lane, from.grabs, from_lane);
  hold.resize(from.hold.empty() ? 0 : tie_velocity.size());
  copy(hold, from.hold);
  ties_move = from.ties_move;
  is_coupled = from.is_coupled;
  copy_laws(*this, from, copy);
}

template <class T>
void TreeState<T>::set_idle(std::uint32_t lane, bool is_idle) {
  idle[lane] = is_idle;
  trees = static_cast<std::uint32_t>(std::count(idle.begin(), idle.end(), std::uint8_t{0}));
}

template <class T>
void TreeState<T>::displace(std::uint32_t number, std::uint32_t lane, double h) {
  for (std::uint32_t c = 0; c < 3; ++c) u[at(3 * number + c, lane)] *= static_cast<T>(h);
  u_step[lane] = h;
}

template <class T>
void TreeState<T>::set_velocities(std::uint32_t lane, std::span<const T> velocity) {
  for (std::size_t i = lane; i < u.size(); i += lanes) u[i] = velocity[i];
  u_step[lane] = 0;
}

template <class T>
void TreeState<T>::restart(std::uint32_t lane, std::span<const T> velocity) {
  set_velocities(lane, velocity);
  known[lane] = 0;
  smooth[lane] = 0;
}

template <class T>
void TreeState<T>::copy_motion(const TreeState& from) {
  const auto copy = [](auto& to, const auto& source) {
    std::copy_n(source.data(), source.size(), to.data());
  };
  for_motion(*this, from, copy);
  copy(tie_x, from.tie_x);
  copy(tie_last_velocity, from.tie_last_velocity);
  copy_laws(*this, from, copy);
  copy(bends.law, from.bends.law);
  copy(twists.twisted, from.twists.twisted);
  grabs.all = from.grabs.all;
  hold = from.hold;
  frequency2 = from.frequency2;
}

template <class T>
Vec3 TreeState<T>::position(std::uint32_t i, std::uint32_t lane) const {
  return {x[at(3 * i, lane)], x[at(3 * i + 1, lane)], x[at(3 * i + 2, lane)]};
}

template <class T>
void TreeState<T>::set_force(std::uint32_t i, std::uint32_t lane, Vec3 newton) {
  const double f[3] = {newton.x, newton.y, newton.z};
  for (std::uint32_t c = 0; c < 3; ++c)
    force[at(3 * i + c, lane)] = static_cast<T>((weight[at(3 * i + c, lane)] + f[c]) / mass_unit[lane]);
}

template struct TreeState<float>;
template struct TreeState<double>;

}  // namespace plumb::detail
