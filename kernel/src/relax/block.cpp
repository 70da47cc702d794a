#include "relax/block.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "plumb/layouts/stores.hpp"

namespace plumb::detail {

using layouts::none;

template <class T>
Block<T>::Block(layouts::Packing packing, bool jacobi)
    : packing_(std::move(packing)),
      x_(packing_.elements),
      displacements_{layouts::AlignedBuffer<T>(packing_.elements),
                     layouts::AlignedBuffer<T>(packing_.elements)},
      kick_(packing_.elements),
      accumulator_(jacobi ? packing_.elements : 0),
      rod_(std::size_t{packing_.vectors()} * simd::rod_fields * packing_.lanes),
      weight_(std::size_t{packing_.vectors()} * simd::weight_fields * packing_.lanes),
      frozen_slots_(packing_.slot_offset.size(), 0) {
  kept_.reserve(packing_.lane_edge.size());
  rods_before_.push_back(0);
  for (std::uint32_t q = 0; q < packing_.positions; ++q) {
    const std::uint32_t begin = q * packing_.position_vectors;
    rods_before_.push_back(rods_before_.back() + distinct_rods(begin, begin + packing_.position_vectors));
  }
}

/// A rod may stand in several lanes of the last position, where islands are repeated to fill it.
template <class T>
std::uint32_t Block<T>::distinct_rods(std::uint32_t begin, std::uint32_t end) const {
  Array<std::uint32_t> seen;
  seen.reserve((end - begin) * std::size_t{packing_.lanes});
  for (std::size_t i = std::size_t{begin} * packing_.lanes; i < std::size_t{end} * packing_.lanes; ++i)
    if (packing_.lane_edge[i] != none) seen.push_back(packing_.lane_edge[i]);
  std::sort(seen.begin(), seen.end());
  return static_cast<std::uint32_t>(std::unique(seen.begin(), seen.end()) - seen.begin());
}

template <class T>
void Block<T>::set_weights(const Weighing& by) {
  const Constants& constants = by.constants;
  const std::uint32_t lanes = packing_.lanes;
  // Packings may turn a rod round, so its ends are looked up by address.
  const Array<std::uint32_t> slot_at = slots_by_element();
  moving_anchors_.reserve(static_cast<std::size_t>(
      std::count_if(packing_.slot_vertex.begin(), packing_.slot_vertex.end(),
                    [&](std::uint32_t vertex) { return constants.inverse_mass[vertex] == 0; })));

  make_laws(constants);
  omega_ = static_cast<T>(by.omega);
  std::map<std::pair<T, T>, std::uint32_t> candidates;
  for (std::size_t i = 0; i < packing_.lane_edge.size(); ++i) {
    if (packing_.lane_edge[i] == none || is_broken(i)) {
      switch_off(i);
      continue;
    }
    weigh_rod(i, slot_at[element_of_end(packing_.address_a, i)],
              slot_at[element_of_end(packing_.address_b, i)], by);
    const T* fields = weight_.data() + i / lanes * simd::weight_fields * lanes + i % lanes;
    if (!gives_ && fields[lanes] == fields[2 * lanes]) ++candidates[{fields[0], fields[lanes]}];
  }
  find_uniform_ranges(candidates);
  if (std::find(frozen_slots_.begin(), frozen_slots_.end(), 1) != frozen_slots_.end())
    retire_frozen_rods(0, packing_.positions);
  for (const Grabbed& each : grabbed_) weigh_grabbed(each, by);
  for (const ChangedRod& each : changed_) tell_apart(each.lane);
}

template <class T>
void Block<T>::switch_off(std::size_t lane) {
  const std::uint32_t lanes = packing_.lanes;
  T* fields = weight_.data() + lane / lanes * simd::weight_fields * lanes + lane % lanes;
  fields[0] = 1;
  fields[lanes] = fields[2 * lanes] = fields[3 * lanes] = 0;
  if (!mass_of_move_.empty()) mass_of_move_[lane] = 0;
  if (!gives_) return;
  // Without stiffness and damping it is neither rigid nor elastic.
  write_law(lane, {.stiffness = 0}, 1, 0, 1);
  half_kick_[lane] = 0;
}

template <class T>
void Block<T>::make_laws(const Constants& constants) {
  gives_ = !constants.laws.empty() &&
           std::any_of(packing_.lane_edge.begin(), packing_.lane_edge.end(),
                       [&](std::uint32_t edge) { return edge != none && !constants.laws[edge].is_rigid(); });
  if (!gives_ || law_.size() > 0) return;
  const auto make = [&](std::uint32_t fields) {
    return layouts::AlignedBuffer<T>(std::size_t{packing_.vectors()} * fields * packing_.lanes);
  };
  law_ = make(simd::law_fields::rod);
  law_start_ = make(simd::law_fields::start);
  shift_ = make(simd::law_fields::shift);
  half_kick_ = make(1);
  make_strengths(constants);
}

template <class T>
void Block<T>::write_law(std::size_t lane, const RodLaw& law, double length, double give, double split) {
  // Beyond this a rod is as good as rigid, and its square would overflow.
  constexpr double most = sizeof(T) == 4 ? 1e30 : 1e200;
  const bool rigid = !law.is_elastic();
  const double fields[simd::law_fields::rod] = {length,
                                                rigid ? 0 : std::min(most, law.stiffness * give),
                                                rigid ? 0 : std::min(most, law.damping * give),
                                                split,
                                                rigid ? 1.0 : 0.0,
                                                law.one_sided ? 1.0 : 0.0};
  const std::size_t lanes = packing_.lanes,
                    first = lane / lanes * simd::law_fields::rod * lanes + lane % lanes;
  for (std::size_t c = 0; c < std::size(fields); ++c) law_[first + c * lanes] = static_cast<T>(fields[c]);
}

template <class T>
simd::LawView<T> Block<T>::law_view(T* p, const simd::LawTerms<T>& terms) {
  return {view(p), law_.data(), law_start_.data(), shift_.data(), half_kick_.data(), terms, omega_};
}

template <class T>
Array<std::uint32_t> Block<T>::slots_by_element() const {
  Array<std::uint32_t> slot_at(packing_.elements, none);
  for (std::uint32_t slot = 0; slot < packing_.slot_offset.size(); ++slot)
    slot_at[packing_.slot_offset[slot]] = slot;
  return slot_at;
}

template <class T>
std::uint32_t Block<T>::element_of_end(const Array<std::uint32_t>& addresses, std::size_t lane) const {
  const std::uint32_t lanes = packing_.lanes;
  return packing_.access == layouts::Access::rows
             ? addresses[lane / lanes] + static_cast<std::uint32_t>(lane % lanes)
             : addresses[lane];
}

template <class T>
void Block<T>::retire_frozen_rods(std::uint32_t q0, std::uint32_t q1) {
  const bool is_apart = packing_.coupling == layouts::Coupling::independent;
  const std::uint32_t first = is_apart ? q0 * packing_.position_elements : 0,
                      end = is_apart ? q1 * packing_.position_elements : packing_.elements;
  Array<std::uint8_t> frozen_at(end - first, 0);
  const auto [slot0, slot1] = slots_in(q0, q1);
  for (std::uint32_t slot = slot0; slot < slot1; ++slot)
    frozen_at[packing_.slot_offset[slot] - first] = frozen_slots_[slot];
  const std::uint32_t lanes = packing_.lanes;
  const bool is_row = packing_.access == layouts::Access::rows;
  for (std::uint32_t q = q0; q < q1; ++q)
    for (std::size_t stage = 0; stage < packing_.stages.size(); ++stage) {
      const simd::Range r = range(q, stage);
      for (std::size_t i = std::size_t{r.begin} * lanes, v = r.begin; v < r.end; ++v)
        for (std::uint32_t lane = 0; lane < lanes; ++lane, ++i) {
          const std::uint32_t at = is_row ? packing_.address_a[v] + lane : packing_.address_a[i];
          if (packing_.lane_edge[i] == none || frozen_at[at - first] == 0) continue;
          switch_off(i);
          uniform_[q * packing_.stages.size() + stage] = 0;
        }
    }
}

template <class T>
void Block<T>::find_uniform_ranges(const std::map<std::pair<T, T>, std::uint32_t>& candidates) {
  uniform_.assign(packing_.positions * packing_.stages.size(), 0);
  uniform_rods_ = 0;
  if (candidates.empty()) return;
  const auto most = std::max_element(candidates.begin(), candidates.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  std::tie(uniform_length2_, uniform_share_) = most->first;

  const std::uint32_t lanes = packing_.lanes;
  const auto is_uniform = [&](std::size_t i) {
    const T* fields = weight_.data() + i / lanes * simd::weight_fields * lanes + i % lanes;
    return packing_.lane_edge[i] != none && fields[0] == uniform_length2_ &&
           fields[lanes] == uniform_share_ && fields[2 * lanes] == uniform_share_;
  };
  for (std::uint32_t q = 0; q < packing_.positions; ++q)
    for (std::size_t stage = 0; stage < packing_.stages.size(); ++stage) {
      const simd::Range r = range(q, stage);
      bool uniform = true;
      for (std::size_t i = std::size_t{r.begin} * lanes; uniform && i < std::size_t{r.end} * lanes; ++i)
        uniform = is_uniform(i);
      uniform_[q * packing_.stages.size() + stage] = uniform;
      if (uniform) uniform_rods_ += distinct_rods(r.begin, r.end);
    }
}

template <class T>
simd::BlockView<T> Block<T>::view(T* p) {
  return {
      .x = x_.data(),
      .p = p,
      .out = accumulator_.size() ? accumulator_.data() : p,
      .component_stride = packing_.component_stride,
      .rod = rod_.data(),
      .weight = weight_.data(),
      .address_a = packing_.address_a.data(),
      .address_b = packing_.address_b.data(),
      .uniform_length2 = uniform_length2_,
      .uniform_share = uniform_share_,
      .uniform_inverse_length2 = T(1) / uniform_length2_,
      .moved = moved_.data(),
  };
}

template <class T>
void Block<T>::write(T* field, std::uint32_t slot, Vec3 value) const {
  const layouts::StoreView<T> store{field, packing_.component_stride};
  const std::uint32_t at = packing_.slot_offset[slot];
  store.x(at) = static_cast<T>(value.x);
  store.y(at) = static_cast<T>(value.y);
  store.z(at) = static_cast<T>(value.z);
}

template <class T>
std::size_t Block<T>::bytes() const {
  return sizeof(T) *
             (x_.size() + 2 * displacements_[0].size() + kick_.size() + accumulator_.size() + rod_.size() +
              weight_.size() + law_.size() + law_start_.size() + shift_.size() + half_kick_.size()) +
         sizeof(std::uint32_t) * (packing_.address_a.size() + packing_.address_b.size());
}

/// Slots of independent positions are told apart by their addresses; other blocks are one whole.
template <class T>
bool Block<T>::is_within(std::uint32_t slot, std::uint32_t q0, std::uint32_t q1) const {
  const std::uint32_t at = packing_.slot_offset[slot];
  return packing_.coupling != layouts::Coupling::independent ||
         (at >= q0 * packing_.position_elements && at < q1 * packing_.position_elements);
}

template <class T>
void Block<T>::move_anchor(std::uint32_t slot, Vec3 move) {
  write(kick(), slot, move);
  moving_anchors_.push_back(slot);
}

template <class T>
void Block<T>::sort_moving_anchors() {
  std::sort(moving_anchors_.begin(), moving_anchors_.end(), [&](std::uint32_t a, std::uint32_t b) {
    return packing_.slot_offset[a] < packing_.slot_offset[b];
  });
}

template <class T>
void Block<T>::release_anchors() {
  settling_ = !moving_anchors_.empty();
  for (const std::uint32_t slot : moving_anchors_) write(kick(), slot, {});
  moving_anchors_.clear();
}

template <class T>
void Block<T>::rest_anchors(T* field, std::uint32_t q0, std::uint32_t q1) const {
  auto anchor = moving_anchors_.begin();
  if (packing_.coupling == layouts::Coupling::independent)
    anchor = std::partition_point(anchor, moving_anchors_.end(), [&](std::uint32_t slot) {
      return packing_.slot_offset[slot] < q0 * packing_.position_elements;
    });
  for (; anchor != moving_anchors_.end() && is_within(*anchor, q0, q1); ++anchor) write(field, *anchor, {});
}

template <class T>
void Block<T>::freeze_island(std::uint32_t of) {
  const bool is_apart = packing_.coupling == layouts::Coupling::independent;
  const std::uint32_t q0 = position_of(of), q1 = is_apart ? q0 + 1 : packing_.positions;
  const auto [slot0, slot1] = slots_in(q0, q1);
  for (std::uint32_t slot = slot0; slot < slot1; ++slot) {
    if (packing_.slot_island[slot] != packing_.slot_island[of]) continue;
    for (T* field : {displacement(0), displacement(1), kick()}) write(field, slot, {});
    frozen_slots_[slot] = 1;
  }
  retire_frozen_rods(q0, q1);
  forget_lengths_of_retired();
}

template <class T>
std::uint32_t Block<T>::freeze_broken_islands(T* last, T* current, std::uint32_t q0,
                                              std::uint32_t q1) noexcept {
  const auto breaks = [&](std::uint32_t slot) {
    const Vec3 next = read(x(), slot) + read(current, slot);
    return !std::isfinite(static_cast<T>(next.x)) || !std::isfinite(static_cast<T>(next.y)) ||
           !std::isfinite(static_cast<T>(next.z));
  };
  Array<std::uint32_t> broken;
  for (std::uint32_t slot = 0; slot < packing_.slot_offset.size(); ++slot) {
    if (!is_within(slot, q0, q1) || !breaks(slot)) continue;
    // A frozen island whose last finite state is too large to square breaks again in every solve.
    if (is_frozen(slot)) {
      write(current, slot, {});
    } else {
      broken.push_back(packing_.slot_island[slot]);
    }
  }
  if (broken.empty()) return 0;
  std::sort(broken.begin(), broken.end());
  broken.erase(std::unique(broken.begin(), broken.end()), broken.end());
  for (std::uint32_t slot = 0; slot < packing_.slot_offset.size(); ++slot) {
    if (!is_within(slot, q0, q1) ||
        !std::binary_search(broken.begin(), broken.end(), packing_.slot_island[slot]))
      continue;
    for (T* field : {last, current, kick()}) write(field, slot, {});
    frozen_slots_[slot] = 1;
  }
  retire_frozen_rods(q0, q1);
  return static_cast<std::uint32_t>(broken.size());
}

template class Block<float>;
template class Block<double>;

}  // namespace plumb::detail
