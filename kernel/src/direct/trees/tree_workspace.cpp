#include "direct/trees/tree_state.hpp"

namespace plumb::detail {
using layouts::AlignedBuffer;
using namespace simd;

namespace {

/// A part of working memory gets so many numbers.
template <class T>
struct Share {
  std::span<T>* part;
  std::size_t size;
};

/// Makes memory that parts share, each from a boundary of AlignedBuffer on. Empty parts have none.
template <class T>
AlignedBuffer<T> share_out(std::span<const Share<T>> shares) {
  const auto room = [](std::size_t size) {
    const std::size_t lanes = layouts::lane_width<T>;
    return (size + lanes - 1) / lanes * lanes;
  };
  std::size_t all = 0;
  for (const auto& [part, size] : shares) all += room(size);
  AlignedBuffer<T> memory(all);
  std::size_t first = 0;
  for (const auto& [part, size] : shares) {
    if (size > 0) *part = std::span(memory.data() + first, size);
    first += room(size);
  }
  return memory;
}

}  // namespace

template <class T>
TreeWorkspace<T>::TreeWorkspace(const TreeTopology& topology, std::uint32_t lanes) {
  const std::size_t n = std::size_t{topology.nodes} * lanes, p = std::size_t{topology.ties} * lanes;
  Array<Share<T>> shares{{&delta, 3 * n},
                         {&velocity, 3 * n},
                         {&load, 3 * n},
                         {&rod, tree_fields::rod * n},
                         {&tie_rod, tree_fields::rod * p},
                         {&elimination, tree_fields::elimination * n},
                         {&tie_elimination, tree_fields::tie_elimination * p},
                         {&blow, n},
                         {&tie_blow, p},
                         {&below, tree_fields::below * std::size_t{topology.below_slots} * lanes}};
  for (auto* part : {&active, &change, &stiffness, &residual, &ratio, &kick, &guess, &guess_before, &mu_scale,
                     &mu_scale_before, &u_delta, &u_before, &inverse_kick, &push, &jolt})
    shares.push_back({part, lanes});
  if (topology.bends.any()) {
    shares.push_back({&bend_start, 3 * (n + 2 * std::size_t{lanes})});
    shares.push_back({&bend_rate, lanes});
    shares.push_back(
        {&bent_elimination, tree_fields::bent_elimination * n + tree_fields::bent_tip * std::size_t{lanes}});
  }
  if (topology.bends.is_twisted()) {
    shares.push_back({&clamp_rod, 6 * std::size_t{lanes}});
    for (auto* part : {&twist_stiffness, &twist_start, &torque, &twist_turn}) shares.push_back({part, lanes});
    shares.push_back({&torque_elimination, tree_fields::torque_elimination * n + 3 * std::size_t{lanes}});
  }
  memory = share_out<T>(shares);
  tie_jump.resize(p);
  tie_rest.resize(p);
  failed.assign(lanes, 0);
  iterations.assign(lanes, 0);
  first.assign(lanes, 0);
}

template <class T>
simd::TreeView<T> TreeWorkspace<T>::view(TreeState<T>& state) {
  const TreeTopology& shape = *state.topology;
  simd::TreeView<T> view{.nodes = shape.nodes,
                         .lanes = state.lanes,
                         .parent = shape.parent.data(),
                         .tie_begin = shape.tie_begin.data(),
                         .is_coupled = state.is_coupled,
                         .is_plain = !state.is_coupled && shape.tie_begin[shape.nodes] <= 1,
                         .node = state.node.data(),
                         .tie = state.tie.data(),
                         .length2 = state.length2.data(),
                         .tie_length2 = state.tie_length2.data(),
                         .x = state.x.data(),
                         .u = state.u.data(),
                         .force = state.force.data(),
                         .tie_x = state.tie_x.data(),
                         .tie_delta = state.tie_delta.data(),
                         .tie_u = state.tie_u.data(),
                         .guesses = !is_line,
                         .keeps_acceleration = keeps_acceleration,
                         .acceleration_before = state.acceleration_before.data(),
                         .acceleration = state.acceleration.data(),
                         .ratio = ratio.data(),
                         .kick = kick.data(),
                         .guess = guess.data(),
                         .guess_before = guess_before.data(),
                         .mu_scale = mu_scale.data(),
                         .mu_scale_before = mu_scale_before.data(),
                         .u_delta = u_delta.data(),
                         .u_before = u_before.data(),
                         .inverse_kick = inverse_kick.data(),
                         .active = active.data(),
                         .change = change.data(),
                         .stiffness = stiffness.data(),
                         .residual = residual.data(),
                         .push = push.data(),
                         .jolt = jolt.data(),
                         .delta = delta.data(),
                         .mu = state.mu.data(),
                         .tie_mu = state.tie_mu.data(),
                         .mu_before = state.mu_before.data(),
                         .tie_mu_before = state.tie_mu_before.data(),
                         .load = load.data(),
                         .rod = rod.data(),
                         .tie_rod = tie_rod.data(),
                         .elimination = elimination.data(),
                         .tie_elimination = tie_elimination.data(),
                         .below_slot = shape.below_slot.data(),
                         .below_slots = shape.below_slots,
                         .below = below.data()};
  if (state.bends.any()) add_bends(state, view);
  if (state.laws.gives) add_laws(state.laws, state.mu.size(), state.tie_mu.size(), view);
  return view;
}

template <class T>
void TreeWorkspace<T>::add_bends(TreeState<T>& state, simd::TreeView<T>& to) {
  to.has_bends = true;
  to.has_bend_damping = state.bends.damped;
  to.bend_ends = state.topology->bends.ends.data();
  to.bend = state.bends.law.data();
  to.bend_start = bend_start.data();
  to.bend_rate = bend_rate.data();
  to.bent_elimination = bent_elimination.data();
  to.twist_begin = state.topology->bends.twist_begin;
  to.twist_end = state.topology->bends.twist_end;
  to.clamp_rod = clamp_rod.data();
  to.twist_stiffness = twist_stiffness.data();
  to.twist_start = twist_start.data();
  to.torque = torque.data();
  to.twist_turn = twist_turn.data();
  to.torque_elimination = torque_elimination.data();
}

template <class T>
void TreeWorkspace<T>::add_laws(TreeLaws<T>& laws, std::size_t rods, std::size_t ties,
                                simd::TreeView<T>& to) {
  if (law_start.size() == 0) {  // only trees with laws need it
    law_start = AlignedBuffer<T>(tree_fields::law_start * rods);
    tie_law_start = AlignedBuffer<T>(tree_fields::law_start * ties);
    projection_factors = AlignedBuffer<T>(law_factors::count * kick.size());
  }
  to.has_laws = true;
  to.has_cables = laws.cables;
  to.is_mid = is_mid;
  to.is_line = is_line;
  to.law = laws.law.rods.data();
  to.tie_law = laws.law.ties.data();
  to.makes_law_steps = laws.steps_are_old;
  to.law_step = laws.step.rods.data();
  to.tie_law_step = laws.step.ties.data();
  to.law_start = law_start.data();
  to.tie_law_start = tie_law_start.data();
  to.half_kick = laws.half_kick.rods.data();
  to.tie_half_kick = laws.half_kick.ties.data();
  to.lengths_change = laws.moves;
  to.length_rate = laws.rate.rods.data();
  to.tie_length_rate = laws.rate.ties.data();
  to.law_factors = laws.factor_numbers.data();
  to.keeps_half_kicks = keeps_half_kicks;
}

template struct TreeWorkspace<float>;
template struct TreeWorkspace<double>;

}  // namespace plumb::detail
