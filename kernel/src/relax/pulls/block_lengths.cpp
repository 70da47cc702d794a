// This file lets rods of a block change their lengths.

#include <algorithm>
#include <cmath>

#include "relax/block.hpp"

namespace plumb::detail {

/// Returns the number of the first changed rod in this lane or behind it.
template <class T>
std::size_t Block<T>::first_changed(std::size_t lane) const {
  const auto at = std::partition_point(changed_.begin(), changed_.end(),
                                       [&](const ChangedRod& each) { return each.lane < lane; });
  return static_cast<std::size_t>(at - changed_.begin());
}

template <class T>
double Block<T>::rate(std::size_t lane) const {
  const std::size_t at = first_changed(lane);
  return at < changed_.size() && changed_[at].lane == lane ? changed_[at].rate : 0;
}

template <class T>
void Block<T>::set_length(std::size_t lane, double length, double rate) {
  changed_length2_.resize(packing_.lane_edge.size());
  const std::size_t at = first_changed(lane);
  if (at == changed_.size() || changed_[at].lane != lane)
    changed_.insert(changed_.begin() + static_cast<std::ptrdiff_t>(at), {lane, length, rate});
  changed_[at] = {lane, length, rate};
  write_length(lane, length);
  tell_apart(lane);
}

template <class T>
void Block<T>::follow_lengths(std::uint32_t q0, std::uint32_t q1, double t) {
  const std::size_t lanes_of_position = std::size_t{packing_.position_vectors} * packing_.lanes;
  for (std::size_t i = first_changed(q0 * lanes_of_position);
       i < changed_.size() && changed_[i].lane < q1 * lanes_of_position; ++i)
    if (changed_[i].rate != 0) write_length(changed_[i].lane, changed_[i].length + t * changed_[i].rate);
}

/// Writes a length to where sweeps read it. What is switched off stays so.
template <class T>
void Block<T>::write_length(std::size_t lane, double length) {
  changed_length2_[lane] = length * length;
  const std::size_t lanes = packing_.lanes, vector = lane / lanes, column = lane % lanes;
  T* const fields = weight_.data() + vector * simd::weight_fields * lanes + column;
  if (fields[3 * lanes] == 0) return;
  fields[0] = static_cast<T>(length * length);
  fields[3 * lanes] = static_cast<T>(1 / (length * length));
  if (gives_) law_[vector * simd::law_fields::rod * lanes + column] = static_cast<T>(length);
}

/// Sweeps of rigid rods divide by squared lengths, which are those that a substep leaves. A slack cable is
/// not off its length, and a rod that gives is as its law says.
template <class T>
T Block<T>::keep_violations(simd::Range range, const Keeping<T>& by) {
  const std::size_t lanes = packing_.lanes;
  T largest = 0;
  for (std::size_t v = range.begin; v < range.end; ++v) {
    T* const violations = rod_.data() + (v * simd::rod_fields + 3) * lanes;
    T* const fields = weight_.data() + v * simd::weight_fields * lanes;
    T* const excess = gives_ ? law_start_.data() + (v * simd::law_fields::start + 4) * lanes : nullptr;
    const T* const is_rigid = gives_ ? law_.data() + (v * simd::law_fields::rod + 4) * lanes : nullptr;
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const T off = violations[lane], inverse = fields[3 * lanes + lane];
      T& kept = kept_[v * lanes + lane];
      const bool is_loose =
          is_rigid != nullptr && (is_rigid[lane] == 0 || (is_rigid[lanes + lane] != 0 && off < 0));
      if (is_loose || off == 0 || !std::isfinite(off)) {
        kept = 0;
        continue;
      }
      kept = by.of(off, kept);
      largest = std::max(largest, std::abs(kept) * inverse);
      violations[lane] = off - kept;
      fields[lane] += kept;
      if (excess != nullptr) excess[lane] *= violations[lane] / off;
    }
  }
  return largest;
}

template <class T>
void Block<T>::restore_lengths(simd::Range range, const Constants& constants) {
  const std::size_t lanes = packing_.lanes;
  for (std::size_t lane = range.begin * lanes; lane < range.end * lanes; ++lane) {
    T* const fields = weight_.data() + lane / lanes * simd::weight_fields * lanes + lane % lanes;
    fields[0] = fields[3 * lanes] == 0 ? T(1) : static_cast<T>(length2_of(lane, constants));
  }
}

/// Nobody asks for the lengths of rods that are switched off.
template <class T>
void Block<T>::forget_lengths_of_retired() {
  const std::size_t lanes = packing_.lanes;
  std::erase_if(changed_, [&](const ChangedRod& each) {
    return weight_[(each.lane / lanes * simd::weight_fields + 3) * lanes + each.lane % lanes] == 0;
  });
}

template <class T>
double Block<T>::length2_of(std::size_t lane, const Constants& constants) const {
  const bool has_changed = !changed_length2_.empty() && changed_length2_[lane] > 0;
  return has_changed ? changed_length2_[lane] : constants.length2[packing_.lane_edge[lane]];
}

template <class T>
void Block<T>::tell_apart(std::size_t lane) {
  const auto vector = static_cast<std::uint32_t>(lane / packing_.lanes);
  const std::uint32_t q = vector / packing_.position_vectors;
  for (std::size_t stage = 0; stage < packing_.stages.size(); ++stage)
    if (const simd::Range r = range(q, stage); vector >= r.begin && vector < r.end)
      uniform_[q * packing_.stages.size() + stage] = 0;
}

#define PLUMB_INSTANTIATE(T)                                                    \
  template std::size_t Block<T>::first_changed(std::size_t) const;              \
  template void Block<T>::set_length(std::size_t, double, double);              \
  template double Block<T>::rate(std::size_t) const;                            \
  template void Block<T>::follow_lengths(std::uint32_t, std::uint32_t, double); \
  template void Block<T>::write_length(std::size_t, double);                    \
  template T Block<T>::keep_violations(simd::Range, const Keeping<T>&);         \
  template void Block<T>::restore_lengths(simd::Range, const Constants&);       \
  template double Block<T>::length2_of(std::size_t, const Constants&) const;    \
  template void Block<T>::forget_lengths_of_retired();                          \
  template void Block<T>::tell_apart(std::size_t);
PLUMB_INSTANTIATE(float)
PLUMB_INSTANTIATE(double)
#undef PLUMB_INSTANTIATE

}  // namespace plumb::detail
