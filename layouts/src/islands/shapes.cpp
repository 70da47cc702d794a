#include "plumb/layouts/shapes.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "../unset.hpp"

namespace plumb::layouts {
namespace {

/// Where the path of a chain starts, or unset if `graph` cannot be a chain.
std::uint32_t start_of_chain(const Graph& graph, const Incidence& incidence) {
  // A path ends at a movable vertex with one edge or at any edge of a fixed vertex.
  std::uint32_t ends = 0;
  std::uint32_t first_movable_end = unset;
  std::uint32_t first_fixed_end = unset;
  for (std::uint32_t v = 0; v < graph.vertices; ++v) {
    const bool movable = graph.movable[v] != 0;
    const std::uint32_t degree = incidence.degree(v);
    if (degree == 0 || degree > 2) return unset;
    if (movable && degree == 2) continue;
    ends += degree;
    if (ends > 2) return unset;
    std::uint32_t& first = movable ? first_movable_end : first_fixed_end;
    if (first == unset) first = v;
  }
  return first_fixed_end != unset ? first_fixed_end : first_movable_end;
}

std::optional<ShapeInfo> as_chain(const Graph& graph, const Incidence& incidence) {
  const std::uint32_t start = start_of_chain(graph, incidence);
  if (start == unset) return std::nullopt;

  ShapeInfo chain;
  chain.shape = Shape::chain;
  chain.vertex_order.reserve(graph.edges.size() + 1);
  chain.edge_order.reserve(graph.edges.size());
  chain.vertex_order.push_back(start);
  std::uint32_t edge = incidence.edges(start).front();
  while (true) {
    const std::uint32_t vertex = other_end(graph.edges[edge], chain.vertex_order.back());
    chain.edge_order.push_back(edge);
    chain.vertex_order.push_back(vertex);
    const auto edges = incidence.edges(vertex);
    if (graph.movable[vertex] == 0 || edges.size() == 1) break;
    edge = edges[0] == edge ? edges[1] : edges[0];
  }
  // What the walk did not reach would be a ring beside the path.
  if (chain.edge_order.size() != graph.edges.size()) return std::nullopt;
  return chain;
}

/// Number of edges from `start` to every vertex, through fixed ones too; unset where there is no way.
Array<std::uint32_t> distances_from(const Graph& graph, const Incidence& incidence, std::uint32_t start) {
  Array<std::uint32_t> distance(graph.vertices, unset);
  Array<std::uint32_t> queue{start};
  queue.reserve(graph.vertices);
  distance[start] = 0;
  for (std::size_t i = 0; i < queue.size(); ++i) {
    const std::uint32_t v = queue[i];
    for (const std::uint32_t e : incidence.edges(v)) {
      const std::uint32_t neighbor = other_end(graph.edges[e], v);
      if (distance[neighbor] != unset) continue;
      distance[neighbor] = distance[v] + 1;
      queue.push_back(neighbor);
    }
  }
  return distance;
}

/// The vertices with two edges, if the degrees are those of a lattice: four corners, elsewhere three or four.
std::optional<std::array<std::uint32_t, 4>> corners_of(const Graph& graph, const Incidence& incidence) {
  std::array<std::uint32_t, 4> corners{};
  std::size_t found = 0;
  for (std::uint32_t v = 0; v < graph.vertices; ++v) {
    const std::uint32_t degree = incidence.degree(v);
    if (degree < 2 || degree > 4) return std::nullopt;
    if (degree > 2) continue;
    if (found == corners.size()) return std::nullopt;
    corners[found++] = v;
  }
  if (found < corners.size()) return std::nullopt;
  return corners;
}

/// Columns and rows of vertices that may form a lattice.
struct Lattice {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  Array<std::uint32_t> x;
  Array<std::uint32_t> y;
};

/// The lattice that the distances from two corners of a side suggest; the edges are still to be checked. In a
/// lattice of width w the distances from (0, 0) and (w − 1, 0) are x + y and (w − 1 − x) + y.
std::optional<Lattice> place_vertices(const Graph& graph, const Incidence& incidence) {
  const auto corners = corners_of(graph, incidence);
  if (!corners) return std::nullopt;
  const std::uint32_t origin = corners->front();
  const Array<std::uint32_t> from_origin = distances_from(graph, incidence, origin);

  for (const std::uint32_t corner : std::span(*corners).subspan(1)) {
    const std::uint64_t width = std::uint64_t{from_origin[corner]} + 1;
    if (width > graph.vertices || graph.vertices % width != 0) continue;
    const std::uint64_t height = graph.vertices / width;
    if (height < 2 || graph.edges.size() != 2 * width * height - width - height) continue;
    // The corner opposite the origin has failed above: its width leaves no height.
    const Array<std::uint32_t> from_corner = distances_from(graph, incidence, corner);

    Lattice lattice{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), {}, {}};
    lattice.x.reserve(graph.vertices);
    lattice.y.reserve(graph.vertices);
    bool fits = true;
    for (std::uint32_t v = 0; fits && v < graph.vertices; ++v) {
      const std::int64_t side = lattice.width - std::int64_t{1};
      const std::int64_t two_x = std::int64_t{from_origin[v]} - from_corner[v] + side;
      const std::int64_t two_y = std::int64_t{from_origin[v]} + from_corner[v] - side;
      fits = two_x >= 0 && two_x <= 2 * side && two_y >= 0 && two_y < 2 * lattice.height;
      lattice.x.push_back(static_cast<std::uint32_t>(two_x / 2));
      lattice.y.push_back(static_cast<std::uint32_t>(two_y / 2));
    }
    if (fits) return lattice;
  }
  return std::nullopt;
}

/// How ids change along the edges in one direction.
struct Trend {
  std::uint64_t edges = 0;
  std::uint64_t total_difference = 0;
  std::int64_t rising = 0;  // edges along which the id grows, less those along which it falls

  void add(std::uint32_t id, std::uint32_t next_id) {
    ++edges;
    total_difference += id < next_id ? next_id - id : id - next_id;
    rising += id < next_id ? 1 : -1;
  }
  /// Gives infinity without edges, since a direction that says nothing must not become the rows.
  double mean_difference() const {
    return edges == 0 ? std::numeric_limits<double>::infinity()
                      : static_cast<double>(total_difference) / static_cast<double>(edges);
  }
};

void mirror(Array<std::uint32_t>& coordinate, std::uint32_t size) {
  for (std::uint32_t& c : coordinate) c = size - 1 - c;
}

/// Turns the lattice so that its rows follow the ids. False if an edge does not join neighbours.
bool turn_along_ids(const Graph& graph, Lattice& lattice) {
  Trend along_x;
  Trend along_y;
  for (const auto& [a, b] : graph.edges) {
    const std::int64_t dx = std::int64_t{lattice.x[b]} - lattice.x[a];
    const std::int64_t dy = std::int64_t{lattice.y[b]} - lattice.y[a];
    if (dx * dx + dy * dy != 1) return false;
    // Ids of fixed vertices are not asked: in an island they come after all others.
    if (graph.movable[a] == 0 || graph.movable[b] == 0) continue;
    const bool forwards = dx + dy > 0;
    (dx != 0 ? along_x : along_y).add(forwards ? a : b, forwards ? b : a);
  }
  if (along_x.rising < 0) mirror(lattice.x, lattice.width);
  if (along_y.rising < 0) mirror(lattice.y, lattice.height);
  if (along_y.mean_difference() < along_x.mean_difference()) {
    std::swap(lattice.x, lattice.y);
    std::swap(lattice.width, lattice.height);
  }
  return true;
}

std::optional<ShapeInfo> as_grid(const Graph& graph, const Incidence& incidence) {
  std::optional<Lattice> lattice = place_vertices(graph, incidence);
  if (!lattice || !turn_along_ids(graph, *lattice)) return std::nullopt;

  const std::size_t width = lattice->width;
  const std::size_t height = lattice->height;
  ShapeInfo grid;
  grid.shape = Shape::grid;
  grid.width = lattice->width;
  grid.height = lattice->height;
  // This is the proof. There are as many edges as slots, so if none is taken twice every lattice edge is
  // there; every place then has a vertex, and as there are no more vertices than places, it has one.
  grid.vertex_order.resize(graph.vertices);
  grid.edge_order.assign(graph.edges.size(), unset);
  for (std::uint32_t v = 0; v < graph.vertices; ++v) {
    grid.vertex_order[lattice->y[v] * width + lattice->x[v]] = v;
  }
  for (std::uint32_t e = 0; e < graph.edges.size(); ++e) {
    const auto [a, b] = graph.edges[e];
    const std::size_t x = std::min(lattice->x[a], lattice->x[b]);
    const std::size_t y = std::min(lattice->y[a], lattice->y[b]);
    const bool horizontal = lattice->y[a] == lattice->y[b];
    const std::size_t slot = horizontal ? y * (width - 1) + x : (width - 1) * height + y * width + x;
    if (std::exchange(grid.edge_order[slot], e) != unset) return std::nullopt;
  }
  return grid;
}

}  // namespace

ShapeInfo detect_shape(const Graph& island) {
  const Incidence incidence = edges_by_vertex(island);
  if (auto chain = as_chain(island, incidence)) return *std::move(chain);
  if (auto grid = as_grid(island, incidence)) return *std::move(grid);
  return {};
}

}  // namespace plumb::layouts
