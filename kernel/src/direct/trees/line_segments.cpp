#include "direct/trees/line_segments.hpp"

#include <algorithm>
#include <cmath>

namespace plumb::detail {
namespace {

using namespace simd;

/// From so many nodes per lane on, segments are faster than the line as a whole.
constexpr std::uint32_t shortest_segment = 4;

/// Returns the topology of a segment, a line with a tie at its first node.
layouts::Tree segment_tree(std::uint32_t nodes) {
  layouts::Tree tree;
  for (std::uint32_t i = 0; i < nodes; ++i) {
    tree.vertex.push_back(i);
    tree.parent.push_back(i == 0 ? 0 : i - 1);
    tree.edge.push_back(i);
    tree.tie_begin.push_back(i == 0 ? 0 : 1);
  }
  tree.tie_begin.push_back(1);
  tree.ties.push_back({nodes, nodes});
  return tree;
}

/// Copies what the anchor of a line held, which is its first tie.
template <class T>
void copy_hold(const TreeState<T>& from, TreeState<T>& to) {
  to.hold.resize(from.hold.empty() ? 0 : to.tie_velocity.size());
  if (!to.hold.empty()) to.hold[0] = from.hold[0];
}

/// Copies grabs from segments to the whole, or back.
template <class T>
void gather_grabs(const TreeState<T>& segments, TreeState<T>& whole) {
  whole.grabs.changed.clear();
  whole.grabs.all = segments.grabs.all;
  for (TreeGrab& grab : whole.grabs.all) {
    grab.lane = 0;
    for (TreeGrab::Part& part : grab.parts) part.entry = part.is_tie ? part.entry : part.node_of_line;
  }
}
template <class T>
void scatter_grabs(const TreeState<T>& whole, TreeState<T>& segments) {
  for (std::size_t i = 0; i < segments.grabs.all.size(); ++i)
    static_cast<HeldGrab&>(segments.grabs.all[i]) = whole.grabs.all[i];
}

}  // namespace

bool LineSegments::fits(const TreeTopology& topology, std::uint32_t lanes) {
  return topology.is_line && topology.ties == 1 && topology.tie_begin[1] == 1 &&
         topology.nodes >= shortest_segment * lanes;
}

LineSegments::LineSegments(std::uint32_t nodes, std::uint32_t lanes)
    : nodes_(nodes), lanes_(lanes), length_((nodes + lanes - 1) / lanes) {}

template <class T>
TreeState<T> LineSegments::cut(const TreeState<T>& whole) const {
  TreeState<T> segments(std::make_shared<const TreeTopology>(segment_tree(length_)), lanes_);
  for_numbers(tree_fields::node,
              [&](std::size_t from, std::size_t to) { segments.node[to] = whole.node[from]; });
  for_numbers(3, [&](std::size_t from, std::size_t to) { segments.weight[to] = whole.weight[from]; });
  for_numbers(1, [&](std::size_t from, std::size_t to) { segments.weighs[to] = whole.weighs[from]; });
  for_numbers(1, [&](std::size_t from, std::size_t to) { segments.length2[to] = whole.length2[from]; });
  segments.tie_length2[0] = whole.tie_length2[0];
  for (std::uint32_t lane = 1; lane < lanes_; ++lane)
    if (lane * length_ < nodes_) segments.tie_length2[lane] = whole.length2[std::size_t{lane} * length_];
  std::fill(segments.mass_unit.begin(), segments.mass_unit.end(), whole.mass_unit[0]);
  std::fill(segments.scale2.begin(), segments.scale2.end(), whole.scale2[0]);
  for_numbers(3, [&](std::size_t from, std::size_t to) { segments.force[to] = whole.force[from]; });
  scatter(whole, segments);
  return segments;
}

template <class T>
void LineSegments::gather(const TreeState<T>& segments, TreeState<T>& whole) const {
  for_node_motion(whole, segments, [&](auto& to, const auto& from) {
    for_numbers(3, [&](std::size_t i, std::size_t j) { to[i] = from[j]; });
  });
  for_rod_motion(whole, segments, [&](auto& to, auto& tie_to, const auto& from, const auto& tie_from) {
    for_numbers(1, [&](std::size_t i, std::size_t j) { to[i] = begins(i) ? tie_from[j] : from[j]; });
    tie_to[0] = tie_from[0];
  });
  for_lane_motion(whole, segments, [](auto& to, const auto& from) { to[0] = from[0]; });
  whole.laws.copy_flags(segments.laws);
  if (whole.laws.any) {
    whole.laws.make(whole.mu.size(), whole.tie_mu.size(), 1);
    const auto gather_rods = [&](auto& to, auto& tie_to, std::uint32_t fields, const auto& from,
                                 const auto& tie_from) {
      for_numbers(fields,
                  [&](std::size_t i, std::size_t j) { to[i] = begins(i / fields) ? tie_from[j] : from[j]; });
      for (std::uint32_t c = 0; c < fields; ++c) tie_to[c] = tie_from[c * lanes_];
    };
    for_laws(whole.laws, segments.laws, gather_rods);
    gather_rods(whole.length2, whole.tie_length2, 1, segments.length2, segments.tie_length2);
  }
  for_numbers(3, [&](std::size_t i, std::size_t j) { whole.force[i] = segments.force[j]; });
  for (std::uint32_t c = 0; c < 3; ++c) whole.tie_x[c] = segments.tie_x[c * lanes_];
  whole.tie_velocity[0] = segments.tie_velocity[0];
  whole.tie_last_velocity[0] = segments.tie_last_velocity[0];
  whole.ties_move = segments.ties_move;
  copy_hold(segments, whole);
  gather_grabs(segments, whole);
}

template <class T>
void LineSegments::scatter(const TreeState<T>& whole, TreeState<T>& segments) const {
  for_node_motion(segments, whole, [&](auto& to, const auto& from) {
    for_numbers(3, [&](std::size_t i, std::size_t j) { to[j] = from[i]; });
  });
  for_rod_motion(segments, whole, [&](auto& to, auto& tie_to, const auto& from, const auto& tie_from) {
    for_numbers(1, [&](std::size_t i, std::size_t j) { (begins(i) ? tie_to : to)[j] = from[i]; });
    tie_to[0] = tie_from[0];
  });
  for_lane_motion(segments, whole,
                  [](auto& to, const auto& from) { std::fill(to.begin(), to.end(), from[0]); });
  segments.laws.copy_flags(whole.laws);
  if (whole.laws.any) {
    segments.laws.make(segments.mu.size(), segments.tie_mu.size(), lanes_);
    for_laws(segments.laws, whole.laws, [&](auto&&... fields) { scatter_rods(fields...); });
    scatter_rods(segments.length2, segments.tie_length2, 1, whole.length2, whole.tie_length2);
  }
  for (std::uint32_t c = 0; c < 3; ++c) segments.tie_x[c * lanes_] = whole.tie_x[c];
  segments.tie_velocity[0] = whole.tie_velocity[0];
  segments.tie_last_velocity[0] = whole.tie_last_velocity[0];
  segments.ties_move = whole.ties_move;
  copy_hold(whole, segments);
  scatter_grabs(whole, segments);
}

template <class T>
void LineSegments::scatter_nodes(std::span<T> whole, layouts::AlignedBuffer<T>& segments) const {
  for_numbers(3, [&](std::size_t from, std::size_t to) { segments[to] = whole[from]; });
}

template <class T>
void LineSegments::link(TreeState<T>& segments) const {
  for (std::uint32_t c = 0; c < 3; ++c)
    for (std::uint32_t lane = 1; lane < lanes_; ++lane)
      segments.tie_x[c * lanes_ + lane] =
          segments.x[(std::size_t{3} * (length_ - 1) + c) * lanes_ + lane - 1];
}

template <class T>
void LineSegments::trim(TreeWorkspace<T>& work) const {
  for (std::uint32_t i = nodes_; i < length_ * lanes_; ++i) {
    T* const rods = entry(i) > 0 ? work.rod.data() : work.tie_rod.data();
    for (std::uint32_t c = 0; c < tree_fields::rod; ++c)
      rods[(std::size_t{tree_fields::rod} * entry(i) + c) * lanes_ + lane(i)] = 0;
    if (work.law_start.size() == 0) continue;
    T* const laws = entry(i) > 0 ? work.law_start.data() : work.tie_law_start.data();
    for (std::uint32_t c = 0; c < tree_fields::law_start; ++c)
      laws[(std::size_t{tree_fields::law_start} * entry(i) + c) * lanes_ + lane(i)] = 0;
  }
}

template <class T>
void LineSegments::join_stiffness(const TreeState<T>& segments, TreeWorkspace<T>& work) const {
  const std::size_t last = length_ - 1;
  const auto& own = last > 0 ? segments.mu : segments.tie_mu;
  for (std::size_t lane = 0; lane + 1 < lanes_; ++lane) {
    const T pull = std::abs(own[last * lanes_ + lane]) + std::abs(segments.tie_mu[lane + 1]);
    const T over = segments.node[(tree_fields::node * last + 3) * lanes_ + lane];
    work.stiffness[lane] = std::max(work.stiffness[lane], 2 * over * pull);
  }
}

#define PLUMB_INSTANTIATE(T)                                                                 \
  template TreeState<T> LineSegments::cut(const TreeState<T>&) const;                        \
  template void LineSegments::gather(const TreeState<T>&, TreeState<T>&) const;              \
  template void LineSegments::scatter(const TreeState<T>&, TreeState<T>&) const;             \
  template void LineSegments::scatter_nodes(std::span<T>, layouts::AlignedBuffer<T>&) const; \
  template void LineSegments::link(TreeState<T>&) const;                                     \
  template void LineSegments::trim(TreeWorkspace<T>&) const;                                 \
  template void LineSegments::join_stiffness(const TreeState<T>&, TreeWorkspace<T>&) const;
PLUMB_INSTANTIATE(float)
PLUMB_INSTANTIATE(double)
#undef PLUMB_INSTANTIATE

}  // namespace plumb::detail
