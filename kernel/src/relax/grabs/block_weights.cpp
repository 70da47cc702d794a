// This file lets rods of a block see particles that are heavier than they are, since something grabs them.

#include <algorithm>
#include <cmath>

#include "relax/block.hpp"

namespace plumb::detail {

template <class T>
void Block<T>::add_grabbed(std::uint32_t slot, double inverse_mass) {
  Grabbed added{slot, inverse_mass, {}};
  const Array<std::uint32_t> slot_at = slots_by_element();
  for (std::size_t i = 0; i < packing_.lane_edge.size(); ++i) {
    if (packing_.lane_edge[i] == layouts::none) continue;
    const std::uint32_t a = slot_at[element_of_end(packing_.address_a, i)],
                        b = slot_at[element_of_end(packing_.address_b, i)];
    if (a == slot || b == slot) added.rods.push_back({i, a, b});
  }
  grabbed_.push_back(std::move(added));
}

template <class T>
void Block<T>::remove_grabbed(std::uint32_t slot) {
  std::erase_if(grabbed_, [&](const Grabbed& each) { return each.slot == slot; });
}

template <class T>
void Block<T>::set_grabbed(std::uint32_t slot, double inverse_mass, const Weighing& by) {
  for (Grabbed& each : grabbed_) {
    if (each.slot != slot || each.inverse_mass == inverse_mass) continue;
    each.inverse_mass = inverse_mass;
    weigh_grabbed(each, by);
  }
}

template <class T>
double Block<T>::grabbed_inverse_mass(std::uint32_t slot) const {
  return std::find_if(grabbed_.begin(), grabbed_.end(),
                      [&](const Grabbed& each) { return each.slot == slot; })
      ->inverse_mass;
}

template <class T>
double Block<T>::inverse_mass_of(std::uint32_t slot, const Constants& constants) const {
  for (const Grabbed& each : grabbed_)
    if (each.slot == slot) return each.inverse_mass;
  return constants.inverse_mass[packing_.slot_vertex[slot]];
}

/// Weighs the rods of a grabbed particle, whose ranges are not uniform any more.
template <class T>
void Block<T>::weigh_grabbed(const Grabbed& of, const Weighing& by) {
  for (const auto& [lane, a, b] : of.rods) {
    if (is_broken(lane) || is_frozen(a) || is_frozen(b)) continue;
    weigh_rod(lane, a, b, by);
    tell_apart(lane);
  }
}

template <class T>
void Block<T>::weigh_rod(std::size_t i, std::uint32_t slot_a, std::uint32_t slot_b, const Weighing& by) {
  const auto& [constants, weights, order, omega] = by;
  const std::uint32_t lanes = packing_.lanes, edge = packing_.lane_edge[i];
  T* fields = weight_.data() + i / lanes * simd::weight_fields * lanes + i % lanes;
  // With Jacobi every rod sees a particle with its mass divided by the number of rods at it. All of them can
  // then be corrected at once without moving it too far, and momentum stays (mass splitting, Tonge et al.
  // 2012).
  const auto rods_sharing = [&](std::uint32_t slot) {
    return by.order == SweepOrder::jacobi
               ? static_cast<double>(by.constants.valence[packing_.slot_vertex[slot]])
               : 1.0;
  };
  const double own_a = inverse_mass_of(slot_a, constants), own_b = inverse_mass_of(slot_b, constants);
  // Equal weights are of particles as they are: what is grabbed gives way by so much less.
  const auto share = [&](std::uint32_t slot, double w) {
    if (by.weights != Weights::equal) return w;
    return w > 0 ? w / by.constants.inverse_mass[packing_.slot_vertex[slot]] : 0.0;
  };
  const double wa = share(slot_a, own_a), wb = share(slot_b, own_b);
  const double sum = rods_sharing(slot_a) * wa + rods_sharing(slot_b) * wb;
  const double scale = (gives_ ? 1 : omega / 4) / sum, give = own_a + own_b;
  const double length2 = length2_of(i, constants);
  fields[0] = static_cast<T>(length2);
  fields[lanes] = static_cast<T>(scale * wa);
  fields[2 * lanes] = static_cast<T>(scale * wb);
  fields[3 * lanes] = static_cast<T>(1 / length2);
  if (!mass_of_move_.empty()) {
    const double split = sum / (wa + wb);
    mass_of_move_[i] = (gives_ ? 1 : omega / 4) / (split * give);
    if (breaks()) set_bound(i);
  }
  if (gives_) write_law(i, constants.laws[edge], std::sqrt(length2), give, sum / (wa + wb));
}

#define PLUMB_INSTANTIATE(T)                                                        \
  template void Block<T>::add_grabbed(std::uint32_t, double);                       \
  template void Block<T>::remove_grabbed(std::uint32_t);                            \
  template void Block<T>::set_grabbed(std::uint32_t, double, const Weighing&);      \
  template double Block<T>::grabbed_inverse_mass(std::uint32_t) const;              \
  template double Block<T>::inverse_mass_of(std::uint32_t, const Constants&) const; \
  template void Block<T>::weigh_grabbed(const Grabbed&, const Weighing&);           \
  template void Block<T>::weigh_rod(std::size_t, std::uint32_t, std::uint32_t, const Weighing&);
PLUMB_INSTANTIATE(float)
PLUMB_INSTANTIATE(double)
#undef PLUMB_INSTANTIATE

}  // namespace plumb::detail
