#pragma once

#include <type_traits>
#include <utility>

#include "plumb/layouts/packing.hpp"
#include "plumb/layouts/stores.hpp"

namespace plumb::layouts::detail {

/// Fills a Packing's parallel arrays in step with each other.
class PackingBuilder {
 public:
  PackingBuilder(std::string_view shape, Layout layout, Access access, Coupling coupling,
                 std::uint32_t lanes) {
    packing_.shape = shape;
    packing_.layout = layout;
    packing_.access = access;
    packing_.coupling = coupling;
    packing_.lanes = lanes;
  }

  void add_slot(std::uint32_t offset, std::uint32_t vertex, std::uint32_t island, bool duplicate = false) {
    packing_.slot_offset.push_back(offset);
    packing_.slot_vertex.push_back(vertex);
    packing_.slot_island.push_back(island);
    packing_.slot_duplicate.push_back(duplicate);
  }

  /// Opens the next stage of the position that is being written; only the first position defines stages.
  void begin_stage() { stage_begin_ = vector_in_position_; }
  void end_stage() {
    if (position_ > 0 || vector_in_position_ == stage_begin_) return;
    packing_.stages.push_back({stage_begin_, vector_in_position_ - stage_begin_});
  }

  /// One vector of edges with one address for each end; `edge_of_lane(lane)` may be `none`.
  template <class EdgeOfLane>
  void add_row(std::uint32_t a, std::uint32_t b, EdgeOfLane&& edge_of_lane) {
    packing_.address_a.push_back(a);
    packing_.address_b.push_back(b);
    for (std::uint32_t lane = 0; lane < packing_.lanes; ++lane)
      packing_.lane_edge.push_back(edge_of_lane(lane));
    ++vector_in_position_;
  }

  /// One edge of a vector with an address per lane.
  void add_indexed(std::uint32_t a, std::uint32_t b, std::uint32_t edge) {
    packing_.address_a.push_back(a);
    packing_.address_b.push_back(b);
    packing_.lane_edge.push_back(edge);
    if (packing_.lane_edge.size() % packing_.lanes == 0) ++vector_in_position_;
  }

  void end_position() {
    packing_.position_vectors = vector_in_position_;
    vector_in_position_ = 0;
    ++position_;
  }

  std::size_t edges_added() const { return packing_.lane_edge.size(); }

  /// `across` of the stages join a position to the next. Of several positions, each owns `position_elements`
  /// numbers of every stream; one position owns the whole array.
  template <ParticleStore Store>
  Packing finish(const Store& store, std::uint32_t colors, std::uint32_t across = 0,
                 std::uint32_t position_elements = 0) {
    packing_.positions = position_;
    packing_.colors = colors;
    packing_.within_stages = static_cast<std::uint32_t>(packing_.stages.size()) - across;
    packing_.elements = store.elements();
    packing_.component_stride = store.component_stride();
    packing_.stream_pitch = packing_.position_elements = store.elements();
    if (position_ > 1) {
      packing_.position_elements = position_elements;
      if constexpr (std::is_same_v<Store, SoaStore>) {
        packing_.streams = store.streams();
        packing_.stream_pitch = store.component_stride();
      }
    }
    return std::move(packing_);
  }

 private:
  Packing packing_;
  std::uint32_t position_ = 0;
  std::uint32_t vector_in_position_ = 0;
  std::uint32_t stage_begin_ = 0;
};

}  // namespace plumb::layouts::detail
