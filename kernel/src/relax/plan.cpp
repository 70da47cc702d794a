#include "relax/plan.hpp"

#include <algorithm>
#include <map>
#include <tuple>

#include "plumb/layouts/aligned_buffer.hpp"
#include "plumb/layouts/islands.hpp"
#include "plumb/layouts/ordering.hpp"
#include "plumb/layouts/shapes.hpp"
#include "scene/refuse.hpp"

namespace plumb::detail {
namespace {

using namespace layouts;

// An island of more rods than this, alone in a block, can be pipelined through the cache. In lanes beside
// others it could not.
constexpr std::uint32_t longest_lane_island = 1024;

// A particle takes four numbers at most, and a packing adds less than this at the end of its streams.
constexpr std::uint64_t spare_numbers = std::uint64_t{1} << 20;
constexpr std::uint64_t most_particles = ((std::uint64_t{1} << 32) - spare_numbers) / 4;
constexpr std::uint64_t most_rods = (std::uint64_t{1} << 31) - 1;

class Planner {
 public:
  Planner(const IslandSets& sets, LayoutChoice choice, std::span<const std::uint8_t> common,
          std::uint32_t lanes, std::uint32_t element_bytes)
      : sets_(sets),
        islands_(sets.islands),
        choice_(choice),
        common_(common),
        lanes_(lanes),
        element_bytes_(element_bytes) {}

  Array<Packing> make() {
    for (const auto& set : sets_.sets) add_set(set);
    finish_indexed();
    return std::move(packings_);
  }

 private:
  Piece piece(std::uint32_t island) const {
    return {island, islands_.vertices(island), islands_.edges(island)};
  }

  void add_set(const Array<std::uint32_t>& set) {
    const LocalGraph local = local_graph(sets_.graph, islands_, set.front());
    const ShapeInfo shape = detect_shape(local.view());
    const auto count = static_cast<std::uint32_t>(set.size());
    if (wants_lanes(local.edges.size(), shape.shape, count)) return add_lanes(set, local, shape);
    if (shape.shape == Shape::chain && choice_ != LayoutChoice::aos) {
      // Many short chains as blocks of their own would be mostly padding.
      const bool worth_a_block = count < lanes_ || local.edges.size() >= longest_lane_island;
      const bool segments = worth_a_block && local.edges.size() < longest_segments;
      if (choice_ == LayoutChoice::aosoa || (choice_ == LayoutChoice::automatic && segments))
        return add_each(set, [&](const Piece& p) { return pack_segments(p, shape, lanes_); });
      if (worth_a_block)
        return add_each(set, [&](const Piece& p) { return pack_streams(p, shape, lanes_, element_bytes_); });
    }
    if (shape.shape == Shape::grid && wants_strips(shape)) {
      const std::uint64_t cells = std::uint64_t{round_up(shape.width, 2)} * rows_of_strip(shape) * lanes_;
      require_addressable(cells, 2 * cells);
      return add_each(set, [&](const Piece& p) { return pack_strips(p, shape, lanes_); });
    }
    add_indexed(set, local, shape);
  }

  bool wants_lanes(std::size_t edges, Shape shape, std::uint32_t count) const {
    if (choice_ == LayoutChoice::aos || choice_ == LayoutChoice::soa || count < 2) return false;
    if (shape != Shape::graph && edges >= longest_lane_island) return false;
    // With fewer islands than this most lanes would repeat work.
    return count * 4 >= lanes_ || choice_ == LayoutChoice::aosoa;
  }

  bool wants_strips(const ShapeInfo& grid) const {
    if (choice_ == LayoutChoice::aosoa) return true;
    if (choice_ != LayoutChoice::automatic) return false;
    return 2 * grid.height >= rows_of_strip(grid) * lanes_;  // at least half of the lanes then hold particles
  }
  std::uint32_t rows_of_strip(const ShapeInfo& grid) const {
    return round_up((grid.height + lanes_ - 1) / lanes_, 2);
  }

  template <class Pack>
  void add_each(const Array<std::uint32_t>& set, Pack&& pack) {
    for (const std::uint32_t island : set) packings_.push_back(pack(piece(island)));
  }

  void add_lanes(const Array<std::uint32_t>& set, const LocalGraph& local, const ShapeInfo& shape) {
    const std::uint64_t islands = (set.size() + lanes_ - 1) / lanes_ * lanes_;
    require_addressable(islands * local.movable.size(), islands * local.edges.size());
    Array<Piece> pieces;
    Array<std::uint8_t> common(local.edges.size(), 1);
    for (const std::uint32_t island : set) {
      pieces.push_back(piece(island));
      for (std::size_t i = 0; i < common.size(); ++i) common[i] &= common_[pieces.back().edges[i]];
    }
    packings_.push_back(
        pack_lanes(pieces, local.view(), color_by_shape(local.view(), shape), common, lanes_));
  }

  void add_indexed(const Array<std::uint32_t>& set, const LocalGraph& local, const ShapeInfo& shape) {
    // Pending::local is an index into locals_; views are made once that stops growing.
    IndexedPiece indexed{{}, {}, color_by_shape(local.view(), shape), {}};
    indexed.vertex_order =
        shape.shape == Shape::graph ? bandwidth_reducing_order(local.view()) : shape.vertex_order;
    // A chain between two ends at the same fixed particle lists it twice; in memory it stands once.
    if (indexed.vertex_order.size() > local.movable.size()) indexed.vertex_order.pop_back();
    locals_.push_back(local);
    for (const std::uint32_t island : set) {
      indexed.piece = piece(island);
      pieces_.push_back({locals_.size() - 1, indexed});
    }
  }

  void finish_indexed() {
    Array<IndexedPiece> pieces;
    for (auto& [local, indexed] : pieces_) {
      indexed.local = locals_[local].view();
      pieces.push_back(std::move(indexed));
    }
    if (pieces.empty()) return;
    std::uint64_t particles = 0, rods = 0, colors = 0;
    for (const IndexedPiece& each : pieces) {
      particles += each.local.vertices;
      rods += each.local.edges.size();
      colors = std::max<std::uint64_t>(colors, each.coloring.colors);
    }
    // Common and other rods of each colour are filled to whole vectors.
    require_addressable(particles, rods + 2 * colors * (lanes_ - 1));
    const Layout layout = choice_ == LayoutChoice::soa     ? Layout::soa
                          : choice_ == LayoutChoice::aosoa ? Layout::aosoa
                                                           : Layout::aos;
    packings_.push_back(pack_indexed(pieces, layout, common_, lanes_, element_bytes_, "graph"));
  }

  struct Pending {
    std::size_t local;
    IndexedPiece indexed;
  };

  const IslandSets& sets_;
  const Islands& islands_;
  LayoutChoice choice_;
  std::span<const std::uint8_t> common_;
  std::uint32_t lanes_;
  std::uint32_t element_bytes_;
  Array<LocalGraph> locals_;
  Array<Pending> pieces_;
  Array<Packing> packings_;
};

}  // namespace

void require_addressable(std::uint64_t particles, std::uint64_t rods) {
  if (particles > most_particles)
    refuse(particles, " particles, with those that the layout adds, are too many: at most ", most_particles,
           " have 32-bit places");
  if (rods > most_rods)
    refuse(rods, " rods, with those that the layout adds, are too many: at most ", most_rods,
           " have 32-bit places");
}

Array<std::uint8_t> common_rods(const Scene& scene, const Constants& constants) {
  using Key = std::tuple<double, double, double>;
  const auto key = [&](std::size_t i) {
    return Key{constants.length2[i], constants.inverse_mass[scene.rods[i].a],
               constants.inverse_mass[scene.rods[i].b]};
  };
  std::map<Key, std::uint32_t> counts;
  for (std::size_t i = 0; i < scene.rods.size(); ++i) {
    const Key k = key(i);
    if (std::get<1>(k) == std::get<2>(k)) ++counts[k];
  }
  Array<std::uint8_t> common(scene.rods.size(), 0);
  if (counts.empty()) return common;
  const Key most = std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) {
                     return a.second < b.second;
                   })->first;
  for (std::size_t i = 0; i < scene.rods.size(); ++i) common[i] = key(i) == most;
  return common;
}

Array<Packing> plan_blocks(const IslandSets& sets, LayoutChoice layout, std::span<const std::uint8_t> common,
                           std::uint32_t lanes, std::uint32_t element_bytes) {
  return Planner(sets, layout, common, lanes, element_bytes).make();
}

}  // namespace plumb::detail
