// What every packing promises, whatever the layout: each rod once, each particle in a place of its own, and
// no two rods of a stage at the same movable particle. Every case is made from its seed alone.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <span>
#include <vector>

#include "plumb/layouts/coloring.hpp"
#include "plumb/layouts/islands.hpp"
#include "plumb/layouts/ordering.hpp"
#include "plumb/layouts/packing.hpp"
#include "plumb/layouts/shapes.hpp"
#include "support/graphs.hpp"

namespace plumb::layouts::PLUMB_TEST_FILE {
namespace {

using namespace test;

/// A chain of `rods` between two fixed ends that are one and the same vertex: a ring through vertex 0.
LocalGraph ring_through_anchor(std::uint32_t rods) {
  LocalGraph g = lattice(rods, 1);
  g.edges.push_back({rods - 1, 0});
  g.movable[0] = 0;
  return g;
}

/// `count` copies of a graph, vertices of the copies interleaved, so that islands are strewn over ids.
LocalGraph copies(const LocalGraph& one, std::uint32_t count) {
  LocalGraph g;
  for (const std::uint8_t movable : one.movable) g.movable.insert(g.movable.end(), count, movable);
  for (std::uint32_t copy = 0; copy < count; ++copy)
    for (const Edge edge : one.edges) g.edges.push_back({edge.a * count + copy, edge.b * count + copy});
  return g;
}

/// A packing and what it was made from; checks what Packing promises.
class Checker {
 public:
  Checker(const LocalGraph& graph, const Islands& islands, Packing packing, Ids packed_islands)
      : graph_(graph), islands_(islands), p_(std::move(packing)), packed_(std::move(packed_islands)) {
    slot_at_.assign(p_.elements, none);
  }

  void check() {
    check_sizes();
    check_slots();
    check_edges();
    check_stages();
    check_positions();
  }

 private:
  bool by_row() const { return p_.access == Access::rows; }
  std::uint32_t address(const Ids& addresses, std::uint32_t vector, std::uint32_t lane) const {
    return by_row() ? addresses[vector] + lane : addresses[vector * p_.lanes + lane];
  }
  std::array<std::uint32_t, 3> components(std::uint32_t element) const {
    return {element, element + p_.component_stride, element + 2 * p_.component_stride};
  }
  template <class F>
  void for_lanes(F&& f) const {
    for (std::uint32_t vector = 0; vector < p_.vectors(); ++vector)
      for (std::uint32_t lane = 0; lane < p_.lanes; ++lane)
        f(vector, lane, p_.lane_edge[vector * p_.lanes + lane], address(p_.address_a, vector, lane),
          address(p_.address_b, vector, lane));
  }

  void check_sizes() const {
    const std::size_t addresses = by_row() ? p_.vectors() : p_.vectors() * p_.lanes;
    ASSERT_EQ(p_.address_a.size(), addresses);
    ASSERT_EQ(p_.address_b.size(), addresses);
    ASSERT_EQ(p_.lane_edge.size(), std::size_t{p_.vectors()} * p_.lanes);
    EXPECT_EQ(p_.elements % p_.lanes, 0u) << "loops over particles take whole vectors";
    EXPECT_EQ(p_.position_elements % p_.lanes, 0u);
    EXPECT_LE(p_.within_stages, p_.stages.size());
    std::uint32_t next = 0;  // stages follow each other and cover a position
    for (const Stage& stage : p_.stages) {
      EXPECT_EQ(stage.begin, next);
      EXPECT_GT(stage.count, 0u);
      next = stage.begin + stage.count;
    }
    EXPECT_EQ(next, p_.position_vectors);
    for (std::size_t i = 0; i < addresses; ++i)
      for (const std::uint32_t at : {p_.address_a[i], p_.address_b[i]}) {
        const std::uint32_t last = at + 2 * p_.component_stride + (by_row() ? p_.lanes - 1 : 0);
        ASSERT_LT(std::max(last, p_.access == Access::records ? at + 3 : 0), p_.elements);
        if (p_.access == Access::records) {
          ASSERT_EQ(at % 4, 0u) << "a record is one aligned load";
        }
      }
    if (p_.access == Access::records) {
      EXPECT_EQ(p_.component_stride, 1u);
    }
    if (!by_row()) return;
    for (std::size_t i = 0; i < addresses; ++i) {  // aligned, or shifted by one lane to the next
      EXPECT_EQ(p_.address_a[i] % p_.lanes, 0u);
      EXPECT_LE(p_.address_b[i] % p_.lanes, 1u);
    }
  }

  void check_slots() {
    ASSERT_EQ(p_.slot_vertex.size(), p_.slot_offset.size());
    ASSERT_EQ(p_.slot_island.size(), p_.slot_offset.size());
    ASSERT_EQ(p_.slot_duplicate.size(), p_.slot_offset.size());
    std::vector<std::uint8_t> taken(p_.elements, 0);
    std::map<std::uint32_t, Ids> held;
    for (std::uint32_t slot = 0; slot < p_.slot_offset.size(); ++slot) {
      for (const std::uint32_t element : components(p_.slot_offset[slot])) {
        ASSERT_LT(element, p_.elements);
        EXPECT_EQ(taken[element]++, 0) << "two slots share element " << element;
      }
      slot_at_[p_.slot_offset[slot]] = slot;
      if (p_.slot_duplicate[slot] == 0) held[p_.slot_island[slot]].push_back(p_.slot_vertex[slot]);
    }
    ASSERT_EQ(held.size(), packed_.size());
    for (const std::uint32_t island : packed_) {
      Ids& vertices = held[island];
      std::sort(vertices.begin(), vertices.end());
      const auto wanted = islands_.vertices(island);
      Ids expected(wanted.begin(), wanted.end());
      std::sort(expected.begin(), expected.end());
      EXPECT_EQ(vertices, expected) << "island " << island;
      for (std::size_t slot = 0; slot < p_.slot_vertex.size(); ++slot)
        if (p_.slot_island[slot] == island) {
          EXPECT_TRUE(std::binary_search(vertices.begin(), vertices.end(), p_.slot_vertex[slot]));
        }
    }
  }

  void check_edges() const {
    std::map<std::uint32_t, std::uint32_t> times, repeats;
    for_lanes([&](std::uint32_t vector, std::uint32_t, std::uint32_t edge, std::uint32_t a, std::uint32_t b) {
      if (edge == none) {
        // Any element may hold padding's ends, but with an address per rod they are away from all particles.
        if (!by_row()) {
          EXPECT_TRUE(slot_at_[a] == none && slot_at_[b] == none);
        }
        return;
      }
      const std::uint32_t slot_a = slot_at_[a], slot_b = slot_at_[b];
      ASSERT_TRUE(slot_a != none && slot_b != none) << "edge " << edge << " ends where no particle is";
      const Edge ends{p_.slot_vertex[slot_a], p_.slot_vertex[slot_b]}, wanted = graph_.edges[edge];
      EXPECT_EQ(std::minmax(ends.a, ends.b), std::minmax(wanted.a, wanted.b)) << "edge " << edge;
      EXPECT_EQ(p_.slot_island[slot_a], p_.slot_island[slot_b]);
      const std::uint32_t movable_end = graph_.movable[ends.a] != 0 ? slot_a : slot_b;
      const bool repeat = p_.coupling == Coupling::independent && p_.slot_duplicate[movable_end] != 0;
      if (repeat) {
        EXPECT_EQ(vector / p_.position_vectors, p_.positions - 1) << "repeats fill up the last position";
      }
      ++(repeat ? repeats : times)[edge];
    });
    std::size_t edges = 0;
    for (const std::uint32_t island : packed_) {
      edges += islands_.edges(island).size();
      for (const std::uint32_t edge : islands_.edges(island)) EXPECT_EQ(times[edge], 1u) << "edge " << edge;
    }
    EXPECT_EQ(times.size(), edges) << "no other edges";
    if (p_.coupling != Coupling::independent) {
      EXPECT_TRUE(repeats.empty());
    }
  }

  /// Edges of one stage may be projected at once, those of other positions included. With an address per edge
  /// they may be on different threads, and share no place at all, a fixed particle's neither.
  void check_stages() const {
    for (std::size_t stage = 0; stage < p_.stages.size(); ++stage) {
      std::set<std::uint32_t> touched;
      for_lanes(
          [&](std::uint32_t vector, std::uint32_t, std::uint32_t edge, std::uint32_t a, std::uint32_t b) {
            const std::uint32_t in_position = vector % p_.position_vectors;
            if (edge == none || in_position < p_.stages[stage].begin ||
                in_position >= p_.stages[stage].begin + p_.stages[stage].count)
              return;
            for (const std::uint32_t end : {a, b})
              if (!by_row() || graph_.movable[p_.slot_vertex[slot_at_[end]]] != 0) {
                EXPECT_TRUE(touched.insert(end).second) << "stage " << stage << ", edge " << edge;
              }
          });
    }
  }

  std::uint32_t position_of(std::uint32_t element) const {
    // A stream's spare numbers count as its last position's.
    return std::min(element % p_.stream_pitch / p_.position_elements, p_.positions - 1);
  }

  /// Threads work on positions side by side, so no stage may touch another position, not even to add zero to
  /// it; across stages reach the next one.
  void check_positions() const {
    EXPECT_LE(std::uint64_t{p_.positions} * p_.position_elements, p_.stream_pitch);
    EXPECT_LE(std::uint64_t{p_.streams} * p_.stream_pitch, p_.elements);
    for (const std::uint32_t offset : p_.slot_offset)
      for (const std::uint32_t element : components(offset))
        EXPECT_EQ(position_of(element), position_of(offset));
    if (p_.coupling == Coupling::whole) {
      EXPECT_EQ(p_.positions, 1u);
    }
    for_lanes([&](std::uint32_t vector, std::uint32_t, std::uint32_t, std::uint32_t a, std::uint32_t b) {
      const std::uint32_t q = vector / p_.position_vectors;
      std::size_t stage = 0;
      while (vector % p_.position_vectors >= p_.stages[stage].begin + p_.stages[stage].count) ++stage;
      const bool across = p_.coupling == Coupling::neighbor && stage >= p_.within_stages;
      for (const std::uint32_t end : {a, b})
        for (const std::uint32_t element : components(end)) {
          EXPECT_GE(position_of(element), q);
          EXPECT_LE(position_of(element), across ? q + 1 : q);
        }
    });
  }

  const LocalGraph& graph_;
  const Islands& islands_;
  Packing p_;
  Ids packed_;
  Ids slot_at_;
};

/// Every island of a graph by id.
Piece piece_of(const Islands& islands, std::uint32_t island) {
  return {island, islands.vertices(island), islands.edges(island)};
}

struct Width {
  std::uint32_t lanes, element_bytes;
};
constexpr Width widths[] = {{16, 4}, {8, 8}};

class Packings : public testing::TestWithParam<unsigned> {
 protected:
  Random random{GetParam()};
};

TEST_P(Packings, ChainsInStreamsAndSegments) {
  LocalGraph chain = lattice(2 + below(random, 1500), 1);
  if (below(random, 3) == 0) chain = ring_through_anchor(2 + below(random, 200));
  if (below(random, 2) == 0) chain.movable.front() = 0;
  const LocalGraph g = renumbered(chain, random);
  const Islands islands = find_islands(g.view());
  ASSERT_EQ(islands.count(), 1u);
  const ShapeInfo shape = detect_shape(local_graph(g.view(), islands, 0).view());
  ASSERT_EQ(shape.shape, Shape::chain);
  for (const Width width : widths) {
    SCOPED_TRACE(testing::Message() << g.edges.size() << " rods in " << width.lanes << " lanes");
    Checker(g, islands, pack_streams(piece_of(islands, 0), shape, width.lanes, width.element_bytes), {0})
        .check();
    Checker(g, islands, pack_segments(piece_of(islands, 0), shape, width.lanes), {0}).check();
  }
}

TEST_P(Packings, GridsInStrips) {
  LocalGraph net = lattice(2 + below(random, 40), 2 + below(random, 70));
  if (below(random, 2) == 0 && net.movable.size() > 4) net.movable.front() = 0;
  const LocalGraph g = renumbered(net, random);
  const Islands islands = find_islands(g.view());
  const ShapeInfo shape = detect_shape(local_graph(g.view(), islands, 0).view());
  ASSERT_EQ(shape.shape, Shape::grid);
  for (const Width width : widths) {
    SCOPED_TRACE(testing::Message() << shape.width << " x " << shape.height << " in " << width.lanes
                                    << " lanes");
    Checker(g, islands, pack_strips(piece_of(islands, 0), shape, width.lanes), {0}).check();
  }
}

TEST_P(Packings, EqualIslandsInLanes) {
  // One island, not only a tree, its anchor last; then up to fifty of them.
  LocalGraph one;
  while (one.edges.empty() || find_islands(one.view()).count() != 1 ||
         find_islands(one.view()).vertices(0).size() != one.movable.size())
    one = random_graph(random, 2 + below(random, 8), 20);
  const LocalGraph g = copies(one, 1 + below(random, 50));
  const Islands islands = find_islands(g.view());
  const auto groups = group_equal_islands(g.view(), islands);
  ASSERT_EQ(groups.size(), 1u);
  const LocalGraph local = local_graph(g.view(), islands, 0);
  const Coloring coloring = color_by_shape(local.view(), detect_shape(local.view()));
  ASSERT_TRUE(is_valid(local.view(), coloring));
  std::vector<Piece> pieces;
  for (const std::uint32_t island : groups[0]) pieces.push_back(piece_of(islands, island));
  std::vector<std::uint8_t> common;
  for (std::size_t i = 0; i < local.edges.size(); ++i) common.push_back(below(random, 2) == 0 ? 0 : 1);
  for (const Width width : widths) {
    SCOPED_TRACE(testing::Message() << pieces.size() << " islands in " << width.lanes << " lanes");
    Packing packing = pack_lanes(pieces, local.view(), coloring, common, width.lanes);
    EXPECT_EQ(packing.positions, (pieces.size() + width.lanes - 1) / width.lanes);
    Checker(g, islands, std::move(packing), groups[0]).check();
  }
}

TEST_P(Packings, AnythingWithAnAddressPerRod) {
  const std::uint32_t n = 1 + below(random, 300);
  const LocalGraph g = random_graph(random, n, below(random, 3 * n));
  const Islands islands = find_islands(g.view());
  std::vector<LocalGraph> locals;
  for (std::uint32_t island = 0; island < islands.count(); ++island)
    locals.push_back(local_graph(g.view(), islands, island));
  std::vector<IndexedPiece> pieces;
  for (std::uint32_t island = 0; island < islands.count(); ++island) {
    const Graph local = locals[island].view();
    pieces.push_back({piece_of(islands, island), local, color_by_shape(local, detect_shape(local)), {}});
    if (below(random, 2) == 0) pieces.back().vertex_order = bandwidth_reducing_order(local);
  }
  std::vector<std::uint8_t> common;
  for (std::size_t i = 0; i < g.edges.size(); ++i) common.push_back(below(random, 2) == 0 ? 0 : 1);
  for (const Width width : widths)
    for (const Layout layout : {Layout::aos, Layout::soa, Layout::aosoa}) {
      SCOPED_TRACE(testing::Message() << n << " vertices, layout " << static_cast<int>(layout) << ", "
                                      << width.lanes << " lanes");
      Packing packing = pack_indexed(pieces, layout, common, width.lanes, width.element_bytes, "graph");
      for (const Stage& stage : packing.stages) {  // common rods have stages of their own, to be uniform
        std::set<std::uint8_t> kinds;
        for (std::uint32_t i = stage.begin * width.lanes; i < (stage.begin + stage.count) * width.lanes; ++i)
          if (packing.lane_edge[i] != none) kinds.insert(common[packing.lane_edge[i]]);
        EXPECT_EQ(kinds.size(), 1u);
      }
      Checker(g, islands, std::move(packing), identity(islands.count())).check();
    }
}

INSTANTIATE_TEST_SUITE_P(Seeds, Packings, testing::Range(0u, 40u));

}  // namespace
}  // namespace plumb::layouts::PLUMB_TEST_FILE
