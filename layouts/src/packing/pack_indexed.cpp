#include <algorithm>
#include <tuple>
#include <utility>

#include "packing_builder.hpp"
#include "plumb/layouts/stores.hpp"

namespace plumb::layouts {
namespace {

struct IndexedEdge {
  std::uint32_t color;
  bool uncommon;
  std::uint32_t a, b;  // addresses
  std::uint32_t edge;

  auto key() const { return std::make_tuple(color, uncommon, std::min(a, b), std::max(a, b), edge); }
};

/// Slots of an island: one for each vertex, and one more for each further edge at a fixed vertex. Edges of
/// one colour may share a fixed vertex, and a kernel writes to both ends of an edge, be it only zero: with
/// slots of their own, threads never write to the same place.
std::uint32_t slots(const Graph& local) {
  Array<std::uint32_t> fixed_ends(local.vertices, 0);
  for (const Edge edge : local.edges)
    for (const std::uint32_t end : {edge.a, edge.b})
      if (local.movable[end] == 0) ++fixed_ends[end];
  std::uint32_t count = local.vertices;
  for (const std::uint32_t ends : fixed_ends) count += ends > 1 ? ends - 1 : 0;
  return count;
}

template <ParticleStore Store>
Packing pack_with(const Store& store, std::span<const IndexedPiece> pieces, Layout layout,
                  std::span<const std::uint8_t> common, std::uint32_t lanes, std::string_view shape) {
  const Access access = layout == Layout::aos ? Access::records : Access::gather;
  detail::PackingBuilder builder(shape, layout, access, Coupling::whole, lanes);

  Array<IndexedEdge> edges;
  std::uint32_t slot = 0, colors = 0;
  Array<std::uint32_t> address;
  Array<std::uint8_t> taken;
  for (const IndexedPiece& indexed : pieces) {
    address.assign(indexed.local.vertices, 0);
    for (std::uint32_t rank = 0; rank < indexed.local.vertices; ++rank) {
      const std::uint32_t vertex = indexed.vertex_order.empty() ? rank : indexed.vertex_order[rank];
      address[vertex] = store.offset(slot++);
      builder.add_slot(address[vertex], indexed.piece.vertices[vertex], indexed.piece.island);
    }
    taken.assign(indexed.local.vertices, 0);
    const auto address_for_edge = [&](std::uint32_t vertex) {
      if (indexed.local.movable[vertex] != 0 || std::exchange(taken[vertex], 1) == 0) return address[vertex];
      const std::uint32_t own = store.offset(slot++);
      builder.add_slot(own, indexed.piece.vertices[vertex], indexed.piece.island, true);
      return own;
    };
    for (std::uint32_t i = 0; i < indexed.local.edges.size(); ++i) {
      const std::uint32_t edge = indexed.piece.edges[i];
      const std::uint32_t a = address_for_edge(indexed.local.edges[i].a);
      const std::uint32_t b = address_for_edge(indexed.local.edges[i].b);
      edges.push_back({indexed.coloring.color_of_edge[i], common[edge] == 0, a, b, edge});
    }
    colors = std::max(colors, indexed.coloring.colors);
  }
  std::sort(edges.begin(), edges.end(),
            [](const IndexedEdge& left, const IndexedEdge& right) { return left.key() < right.key(); });

  const std::uint32_t dummy = store.offset(slot);  // both ends of padding
  for (std::size_t i = 0; i < edges.size();) {
    const std::size_t first = i;
    builder.begin_stage();
    for (; i < edges.size() && edges[i].color == edges[first].color &&
           edges[i].uncommon == edges[first].uncommon;
         ++i)
      builder.add_indexed(edges[i].a, edges[i].b, edges[i].edge);
    while (builder.edges_added() % lanes != 0) builder.add_indexed(dummy, dummy, none);
    builder.end_stage();
  }
  builder.end_position();
  return builder.finish(store, colors);
}

}  // namespace

Packing pack_indexed(std::span<const IndexedPiece> pieces, Layout layout,
                     std::span<const std::uint8_t> common, std::uint32_t lanes, std::uint32_t element_bytes,
                     std::string_view shape) {
  std::uint32_t particles = 1;  // the dummy
  for (const IndexedPiece& indexed : pieces) particles += slots(indexed.local);
  switch (layout) {
    case Layout::aos:
      return pack_with(AosStore(particles, lanes), pieces, layout, common, lanes, shape);
    case Layout::soa:
      return pack_with(SoaStore(particles, lanes, element_bytes), pieces, layout, common, lanes, shape);
    case Layout::aosoa:
      break;
  }
  return pack_with(AosoaStore(particles, lanes), pieces, layout, common, lanes, shape);
}

}  // namespace plumb::layouts
