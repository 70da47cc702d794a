#include "direct/attempts/elastic_tree.hpp"

#include <algorithm>

#include "direct/loops/settle.hpp"
#include "direct/trees/newton_limits.hpp"

namespace plumb::detail {
namespace {

/// Nodes keep their numbers, and ties become fixed vertices after them. The rod of node i to its parent is
/// rod i - 1, and ties' rods follow.
std::shared_ptr<const LoopTopology> as_loops(const TreeTopology& tree) {
  Array<LoopRod> rods;
  for (std::uint32_t i = 1; i < tree.nodes; ++i) rods.push_back({i, tree.parent[i]});
  for (std::uint32_t i = 0; i < tree.nodes; ++i)
    for (std::uint32_t k = tree.tie_begin[i]; k < tree.tie_begin[i + 1]; ++k)
      rods.push_back({i, tree.nodes + k});
  auto out = std::make_shared<LoopTopology>(tree.nodes, tree.nodes + tree.ties, std::move(rods));
  const auto vertex = [&](std::int64_t place) {
    const bool is_node = place >= 0 && place < tree.nodes;
    return is_node ? static_cast<std::uint32_t>(place) : tree.nodes + tree.bends.end(place, tree.nodes);
  };
  for (const std::uint32_t slot : tree.bends.slots)
    out->bends.push_back({{vertex(std::int64_t{slot} - 2), vertex(std::int64_t{slot} - 1), vertex(slot)}});
  if (tree.bends.is_twisted()) {
    LoopTwist& twist = out->twists.emplace_back();
    for (std::int64_t place = std::int64_t{tree.bends.twist_begin} - 2; place < tree.bends.twist_end; ++place)
      twist.vertices.push_back(vertex(place));
  }
  out->system = std::make_unique<LoopSystem>(out->rods, out->nodes, true, *out);
  return out;
}

/// Returns the tree as an island, whose numbers are not known yet.
LoopState island_of(const TreeTopology& tree) {
  LoopState out(as_loops(tree));
  const IslandRods rods(out.topology->rods);
  for (const LoopBend& bend : out.topology->bends) {
    const auto [a, b, c] = bend.vertices;
    out.bends.push_back({{}, {rods.find(a, b), rods.find(b, c)}});
  }
  out.twists.resize(out.topology->twists.size());
  return out;
}

template <class To, class From>
void copy(To& to, const From& from) {
  std::transform(from.data(), from.data() + to.size(), to.begin(),
                 [](auto value) { return static_cast<double>(value); });
}

/// Calls f(number of the island's rod, that of the tree's, whether it goes to an anchor).
template <class T, class F>
void for_rods(const TreeState<T>& tree, F&& f) {
  const std::size_t nodes = tree.topology->nodes;
  for (std::size_t i = 1; i < nodes; ++i) f(i - 1, i, false);
  for (std::size_t k = 0; k < tree.topology->tie_begin[nodes]; ++k) f(nodes - 1 + k, k, true);
}

/// Copies what rods do besides keeping their lengths, of a tree alone. Half kicks are forgotten.
template <class T>
void load_laws(const TreeState<T>& tree, LoopState& island) {
  LoopLaws& to = island.laws;
  const TreeLaws<T>& from = tree.laws;
  to.make(island.length2);
  to.moves = from.moves;
  to.pulls = from.pulls;
  for_rods(tree, [&](std::size_t rod, std::size_t i, bool tie) {
    const auto part = [&](const auto& of) { return tie ? of.ties.data() : of.rods.data(); };
    for (std::size_t c = 0; c < to.rods[rod].size(); ++c)
      to.rods[rod][c] = static_cast<double>(part(from.law)[to.rods[rod].size() * i + c]);
    to.half_kick[rod] = 0;
    to.length[rod] = part(from.length)[i];
    to.rate[rod] = part(from.rate)[i];
    to.impulse[rod] = part(from.impulse)[i];
  });
}
template <class T>
void store_laws(const LoopState& island, TreeState<T>& tree) {
  const LoopLaws& from = island.laws;
  TreeLaws<T>& to = tree.laws;
  for_rods(tree, [&](std::size_t rod, std::size_t i, bool tie) {
    const auto part = [&](auto& of) { return tie ? of.ties.data() : of.rods.data(); };
    for (std::size_t c = 0; c < from.rods[rod].size(); ++c)
      part(to.law)[from.rods[rod].size() * i + c] = static_cast<T>(from.rods[rod][c]);
    part(to.half_kick)[i] = T(0);
    part(to.length)[i] = from.length[rod];
    part(to.impulse)[i] = from.impulse[rod];
    (tie ? tree.tie_length2 : tree.length2)[i] = island.length2[rod];
  });
}

/// Copies grabs of a tree alone. Masses that they change are those of the tree now.
template <class T>
void load_grabs(const TreeState<T>& tree, LoopState& island) {
  island.changed.all.clear();
  island.grabs.clear();
  const std::uint32_t nodes = tree.topology->nodes;
  if (tree.grabs.any()) island.weighs.resize(nodes);
  for (std::size_t i = 0; i < nodes && tree.grabs.any(); ++i)
    island.weighs[i] = tree.weighs[i] / tree.mass_unit[0];
  for (const TreeGrab& from : tree.grabs.all) {
    LoopGrab& to = island.grabs.emplace_back(LoopGrab{static_cast<const HeldGrab&>(from)});
    to.count = from.count;
    for (std::uint32_t i = 0; i < from.count; ++i)
      to.parts[i] = {from.parts[i].entry + (from.parts[i].is_tie ? nodes : 0), from.parts[i].share};
    to.rod = from.parts[1].is_tie ? nodes - 1 + from.parts[1].entry : from.parts[0].entry - 1;
  }
}

}  // namespace

template <class T>
ElasticTree<T>::Island::Island(const TreeTopology& tree, Isa isa)
    : state(island_of(tree)),
      work(state, Gradient::mid, isa) {}  // it projects no velocities, as mid does not

template <class T>
auto ElasticTree<T>::load(const TreeState<T>& tree) -> Island& {
  if (!island_) island_ = std::make_unique<Island>(*topology_, isa_);
  LoopState& island = island_->state;
  const std::uint32_t nodes = tree.topology->nodes, ties = tree.topology->ties;
  for (std::size_t i = 0; i < 3 * std::size_t{nodes}; ++i) island.x[i] = tree.x[i];
  for (std::size_t i = 0; i < 3 * std::size_t{ties}; ++i) island.x[3 * nodes + i] = tree.tie_x[i];
  copy(island.u, tree.u);
  copy(island.force, tree.force);
  copy(island.weight, tree.weight);
  island.u_step = tree.u_step[0];
  std::fill(island.mu.begin(), island.mu.end(), 0.0);
  island.mu_kick = 0;
  for (std::uint32_t i = 0; i < nodes; ++i) {
    island.mass[i] = static_cast<double>(tree.node[simd::tree_fields::node * i]);
    if (i == 0) continue;
    island.coupling[i - 1] = static_cast<double>(tree.node[simd::tree_fields::node * i + 1]);
    island.length2[i - 1] = tree.length2[i];
  }
  for (std::uint32_t k = 0; k < tree.topology->tie_begin[nodes]; ++k) {
    island.coupling[nodes - 1 + k] = static_cast<double>(tree.tie[simd::tree_fields::tie * k]);
    island.length2[nodes - 1 + k] = tree.tie_length2[k];
  }
  if (tree.laws.any)
    load_laws(tree, island);
  else
    island.laws = {};
  for (std::size_t k = 0; k < island.bends.size(); ++k)
    island_->work.bends[k] = island.bends[k].law = bend_numbers(tree, tree.topology->bends.slots[k], 0);
  island.twists = tree.twists.numbers;
  island.twisted = tree.twists.twisted;
  island.hold = tree.hold;
  load_grabs(tree, island);
  island.fixed_velocity = tree.tie_velocity;
  island.fixed_last_velocity = tree.tie_last_velocity;
  island.anchors_move = tree.ties_move;
  island.mass_unit = tree.mass_unit[0];
  island.scale2 = tree.scale2[0];
  return *island_;
}

template <class T>
void ElasticTree<T>::store(TreeState<T>& tree) const {
  const LoopState& island = island_->state;
  const std::uint32_t nodes = tree.topology->nodes;
  for (std::size_t i = 0; i < 3 * std::size_t{nodes}; ++i) {
    tree.x[i] = island.x[i];
    tree.u[i] = static_cast<T>(island.u[i]);
  }
  for (std::size_t i = 0; i < tree.tie_x.size(); ++i) tree.tie_x[i] = island.x[3 * nodes + i];
  if (tree.ties_move) tree.tie_last_velocity = tree.tie_velocity;
  tree.hold = island.hold;
  for (std::size_t i = 0; i < tree.grabs.all.size(); ++i)
    static_cast<HeldGrab&>(tree.grabs.all[i]) = island.grabs[i];
  tree.twists.twisted = island.twisted;
  tree.u_step[0] = island.u_step;
  tree.u_step_before[0] = 0;
  for (auto* const each : {&tree.mu, &tree.tie_mu, &tree.mu_before, &tree.tie_mu_before})
    std::fill_n(each->data(), each->size(), T(0));
  tree.mu_kick[0] = tree.mu_kick_before[0] = 0;
  if (tree.laws.any) store_laws(island, tree);
  tree.known[0] = 0;
  tree.gave[0] = island.gave;
  tree.smooth[0] = 0;
  tree.frequency2 = 0;
}

template <class T>
void ElasticTree<T>::advance(TreeState<T>& tree, double h, Tally& counters) {
  Island& island = load(tree);
  stepper_.advance_elastic(island.state, h, island.work, counters);
  island.state.changed.put_back();
  store(tree);
}

template <class T>
void ElasticTree<T>::advance_as_island(TreeState<T>& tree, double h, Tally& counters) {
  Island& island = load(tree);
  // What other trees left there must not matter.
  island.state.damped = island.state.next_damped = 0;
  island.state.pace = {};
  island.state.effort = {};
  island.work.factor(true).h = 0;
  stepper_.advance(island.state, h, island.work, counters);
  island.state.changed.put_back();
  store(tree);
}

template <class T>
std::uint32_t ElasticTree<T>::settle(TreeState<T>& trees, TreeState<T>& alone) {
  std::uint32_t unsettled = 0;
  for (std::uint32_t lane = 0; lane < trees.lanes; ++lane) {
    if (trees.idle[lane]) continue;
    alone.copy_lane(0, trees, lane);
    Island& island = load(alone);
    if (!detail::settle(island.state, island.work)) {
      ++unsettled;
      alone.elastic[0] = alone.next_elastic[0] = tree_limits::elastic_substeps;
    }
    for (std::size_t i = 0; i < alone.x.size(); ++i) alone.x[i] = island.state.x[i];
    trees.copy_lane(lane, alone, 0);
  }
  return unsettled;
}

template class ElasticTree<float>;
template class ElasticTree<double>;

}  // namespace plumb::detail
