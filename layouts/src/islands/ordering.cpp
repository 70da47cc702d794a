#include "plumb/layouts/ordering.hpp"

#include <algorithm>
#include <compare>
#include <limits>
#include <numeric>
#include <utility>

namespace plumb::layouts {
namespace {

/// Neighbours of every vertex, those with fewer edges first: the order in which Cuthill and McKee visit them.
class Neighbors {
 public:
  explicit Neighbors(const Graph& graph) {
    Incidence incidence = edges_by_vertex(graph);
    begin_ = std::move(incidence.edge_begin);
    list_.reserve(incidence.edge_list.size());
    for (std::uint32_t v = 0; v < graph.vertices; ++v) {
      const auto first = static_cast<std::ptrdiff_t>(list_.size());
      for (std::uint32_t i = begin_[v]; i < begin_[v + 1]; ++i) {
        list_.push_back(other_end(graph.edges[incidence.edge_list[i]], v));
      }
      std::sort(list_.begin() + first, list_.end(),
                [this](std::uint32_t a, std::uint32_t b) { return comes_before(a, b); });
    }
  }

  std::uint32_t degree(std::uint32_t v) const { return begin_[v + 1] - begin_[v]; }
  std::span<const std::uint32_t> of(std::uint32_t v) const {
    return std::span(list_).subspan(begin_[v], degree(v));
  }
  /// Whether a comes before b: by degree, then by id.
  bool comes_before(std::uint32_t a, std::uint32_t b) const {
    return std::pair(degree(a), a) < std::pair(degree(b), b);
  }

 private:
  Array<std::uint32_t> begin_;
  Array<std::uint32_t> list_;
};

/// Breadth-first visits of the vertices that have not been placed yet.
class Visitor {
 public:
  explicit Visitor(const Graph& graph)
      : movable_(graph.movable), neighbors_(graph), seen_in_(graph.vertices, 0) {}

  /// A fixed vertex with several edges would join what it only holds; with one it is the end of a chain.
  bool can_start(std::uint32_t v) const { return movable_[v] != 0 || neighbors_.degree(v) == 1; }
  bool is_placed(std::uint32_t v) const { return seen_in_[v] == placed; }

  /// Visits what can be reached from `start`; the result is in visited().
  void visit(std::uint32_t start) {
    ++visit_;
    visited_.assign(1, start);
    level_begin_.clear();
    seen_in_[start] = visit_;
    for (std::size_t next = 0; next < visited_.size();) {
      level_begin_.push_back(next);
      for (const std::size_t end = visited_.size(); next < end; ++next) pass_through(visited_[next], start);
    }
    level_begin_.push_back(visited_.size());
  }
  std::size_t levels() const { return level_begin_.size() - 1; }
  std::span<const std::uint32_t> visited() const { return visited_; }

  /// Picks a vertex to start the next visit from: one of the last level with the fewest edges, the smallest
  /// id of several. It goes back a level where only anchors lie furthest out.
  std::uint32_t far_vertex() const {
    for (std::size_t level = levels(); level-- > 0;) {
      const std::uint32_t* best = nullptr;
      for (std::size_t i = level_begin_[level]; i < level_begin_[level + 1]; ++i) {
        const std::uint32_t& v = visited_[i];
        if (!can_start(v)) continue;
        if (best == nullptr || neighbors_.comes_before(v, *best)) best = &v;
      }
      if (best != nullptr) return *best;
    }
    return visited_.front();
  }

  void place_visited() {
    for (const std::uint32_t v : visited_) seen_in_[v] = placed;
  }

 private:
  static constexpr std::uint32_t placed = std::numeric_limits<std::uint32_t>::max();

  void pass_through(std::uint32_t v, std::uint32_t start) {
    if (movable_[v] == 0 && v != start) return;
    for (const std::uint32_t neighbor : neighbors_.of(v)) {
      if (seen_in_[neighbor] == visit_ || is_placed(neighbor)) continue;
      seen_in_[neighbor] = visit_;
      visited_.push_back(neighbor);
    }
  }

  std::span<const std::uint8_t> movable_;
  Neighbors neighbors_;
  Array<std::uint32_t> seen_in_;  // per vertex: number of the last visit that met it
  std::uint32_t visit_ = 0;
  Array<std::uint32_t> visited_;
  Array<std::size_t> level_begin_;
};

/// Leaves the visitor with a visit from a vertex about as far out as its component goes.
void visit_from_far_end(Visitor& visitor, std::uint32_t start) {
  // Each retry goes further out; two or three are common, and the limit keeps the cost linear.
  constexpr int retries = 8;
  visitor.visit(start);
  for (int retry = 0; retry < retries; ++retry) {
    const std::size_t levels = visitor.levels();
    const std::uint32_t next = visitor.far_vertex();
    if (next == start) return;
    visitor.visit(next);
    if (visitor.levels() < levels) visitor.visit(start);
    if (visitor.levels() == levels) return;
    start = next;
  }
}

Array<std::uint32_t> positions_in(std::span<const std::uint32_t> order) {
  Array<std::uint32_t> position(order.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) position[order[i]] = i;
  return position;
}

std::uint32_t distance(Edge edge, std::span<const std::uint32_t> position) {
  const auto [low, high] = std::minmax(position[edge.a], position[edge.b]);
  return high - low;
}

/// What an order is judged by; the more important measures come first.
struct Cost {
  std::uint32_t movable_bandwidth = 0;  // without edges to anchors, which may be long in any order
  std::uint32_t bandwidth = 0;
  std::uint64_t total_distance = 0;

  auto operator<=>(const Cost&) const = default;
};

Cost cost_of(const Graph& graph, std::span<const std::uint32_t> order) {
  const Array<std::uint32_t> position = positions_in(order);
  Cost cost;
  for (const Edge& edge : graph.edges) {
    const std::uint32_t apart = distance(edge, position);
    const bool movable = graph.movable[edge.a] != 0 && graph.movable[edge.b] != 0;
    if (movable) cost.movable_bandwidth = std::max(cost.movable_bandwidth, apart);
    cost.bandwidth = std::max(cost.bandwidth, apart);
    cost.total_distance += apart;
  }
  return cost;
}

}  // namespace

Array<std::uint32_t> bandwidth_reducing_order(const Graph& graph) {
  Visitor visitor(graph);
  Array<std::uint32_t> order;
  order.reserve(graph.vertices);
  for (std::uint32_t v = 0; v < graph.vertices; ++v) {
    if (visitor.is_placed(v) || !visitor.can_start(v)) continue;
    visit_from_far_end(visitor, v);
    order.insert(order.end(), visitor.visited().rbegin(), visitor.visited().rend());
    visitor.place_visited();
  }
  // Fixed vertices that no movable one touches.
  for (std::uint32_t v = 0; v < graph.vertices; ++v) {
    if (!visitor.is_placed(v)) order.push_back(v);
  }

  Array<std::uint32_t> given(graph.vertices);
  std::iota(given.begin(), given.end(), 0u);
  return cost_of(graph, order) < cost_of(graph, given) ? order : given;
}

std::uint32_t bandwidth(const Graph& graph, std::span<const std::uint32_t> order) {
  const Array<std::uint32_t> position = positions_in(order);
  std::uint32_t widest = 0;
  for (const Edge& edge : graph.edges) widest = std::max(widest, distance(edge, position));
  return widest;
}

}  // namespace plumb::layouts
