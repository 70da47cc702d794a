#include "plumb/layouts/coloring.hpp"

#include <algorithm>
#include <utility>

#include "../unset.hpp"

namespace plumb::layouts {
namespace {

/// The open colours, kept in ascending order of (edges that have it, number).
class Palette {
 public:
  std::uint32_t size() const { return static_cast<std::uint32_t>(uses_.size()); }

  /// Keeps the colour from being taken by `edge`.
  void block(std::uint32_t color, std::uint32_t edge) { blocked_for_[color] = edge; }

  /// Takes the least used colour not blocked for `edge`, or opens one. Looks at one colour more than are
  /// blocked at most.
  std::uint32_t take_least_used(std::uint32_t edge) {
    const auto at = std::find_if(by_use_.begin(), by_use_.end(),
                                 [&](std::uint32_t color) { return blocked_for_[color] != edge; });
    if (at == by_use_.end()) return open();
    const std::uint32_t color = *at;
    ++uses_[color];
    const auto place = std::lower_bound(at + 1, by_use_.end(), color, Before{uses_});
    std::rotate(at, at + 1, place);
    return color;
  }

  /// Takes a colour that no edge has yet.
  std::uint32_t open() {
    const std::uint32_t color = size();
    uses_.push_back(1);
    blocked_for_.push_back(unset);
    by_use_.insert(std::lower_bound(by_use_.begin(), by_use_.end(), color, Before{uses_}), color);
    return color;
  }

 private:
  struct Before {
    const Array<std::uint32_t>& uses;
    bool operator()(std::uint32_t a, std::uint32_t b) const {
      return std::pair(uses[a], a) < std::pair(uses[b], b);
    }
  };

  Array<std::uint32_t> uses_;         // per colour
  Array<std::uint32_t> blocked_for_;  // per colour: the last edge it was blocked for
  Array<std::uint32_t> by_use_;
};

/// The colours that edges at each movable vertex have so far.
class TakenColors {
 public:
  explicit TakenColors(const Graph& graph)
      : movable_(graph.movable), begin_(graph.vertices + std::size_t{1}, 0), list_() {
    for (const Edge& edge : graph.edges) {
      for (const std::uint32_t v : {edge.a, edge.b}) begin_[v + std::size_t{1}] += movable_[v] != 0 ? 1 : 0;
    }
    for (std::size_t v = 0; v < graph.vertices; ++v) begin_[v + 1] += begin_[v];
    list_.resize(begin_.back());
    end_.assign(begin_.begin(), begin_.end() - 1);
  }

  std::span<const std::uint32_t> at(std::uint32_t vertex) const {
    return std::span(list_).subspan(begin_[vertex], end_[vertex] - begin_[vertex]);
  }
  void add(std::uint32_t vertex, std::uint32_t color) {
    if (movable_[vertex] != 0) list_[end_[vertex]++] = color;
  }

 private:
  std::span<const std::uint8_t> movable_;
  Array<std::uint32_t> begin_;
  Array<std::uint32_t> end_;
  Array<std::uint32_t> list_;
};

}  // namespace

Coloring color_edges(const Graph& graph) {
  Coloring coloring;
  coloring.color_of_edge.reserve(graph.edges.size());
  Palette palette;
  TakenColors taken(graph);
  for (std::uint32_t e = 0; e < graph.edges.size(); ++e) {
    const auto [a, b] = graph.edges[e];
    std::uint32_t color;
    if (taken.at(a).size() == palette.size() || taken.at(b).size() == palette.size()) {
      // No colour is left at one end. Saying so without a search keeps a hub with n edges from costing n².
      color = palette.open();
    } else {
      for (const std::uint32_t c : taken.at(a)) palette.block(c, e);
      for (const std::uint32_t c : taken.at(b)) palette.block(c, e);
      color = palette.take_least_used(e);
    }
    taken.add(a, color);
    taken.add(b, color);
    coloring.color_of_edge.push_back(color);
  }
  coloring.colors = palette.size();
  return coloring;
}

bool is_valid(const Graph& graph, const Coloring& coloring) {
  const auto& colors = coloring.color_of_edge;
  if (colors.size() != graph.edges.size()) return false;
  if (std::any_of(colors.begin(), colors.end(), [&](std::uint32_t c) { return c >= coloring.colors; }))
    return false;

  const Incidence incidence = edges_by_vertex(graph);
  Array<std::uint32_t> last_seen_at(coloring.colors, unset);
  for (std::uint32_t v = 0; v < graph.vertices; ++v) {
    if (graph.movable[v] == 0) continue;
    for (const std::uint32_t e : incidence.edges(v)) {
      if (std::exchange(last_seen_at[colors[e]], v) == v) return false;
    }
  }
  return true;
}

}  // namespace plumb::layouts
