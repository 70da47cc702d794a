// This file says how the rods of a block pulled in a substep, and breaks those that pulled too much.

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "relax/block.hpp"

namespace plumb::detail {

template <class T>
void Block<T>::count_pulls() {
  const std::size_t lanes = std::size_t{packing_.vectors()} * packing_.lanes;
  if (!gives_) moved_ = layouts::AlignedBuffer<T>(lanes * simd::moved_fields);
  pulls_.assign(lanes, 0);
  mass_of_move_.assign(lanes, 0);
}

template <class T>
void Block<T>::begin_pulls(std::uint32_t q0, std::uint32_t q1) {
  if (pulls_.empty()) return;
  const std::size_t size = std::size_t{packing_.position_vectors} * packing_.lanes;
  std::fill(pulls_.begin() + static_cast<std::ptrdiff_t>(q0 * size),
            pulls_.begin() + static_cast<std::ptrdiff_t>(q1 * size), 0.0);
}

template <class T>
void Block<T>::begin_moves(simd::Range range) {
  if (gives_) return;  // preparing rods that give forgets their moves
  const std::size_t size = std::size_t{simd::moved_fields} * packing_.lanes;
  std::fill(moved_.data() + range.begin * size, moved_.data() + range.end * size, T(0));
}

template <class T>
double Block<T>::impulse_of(std::size_t lane, double by) const {
  const std::size_t lanes = packing_.lanes, v = lane / lanes;
  const T* const moved = gives_ ? shift_.data() : moved_.data();
  static_assert(simd::law_fields::shift == simd::moved_fields);
  const auto vector_of = [&](const T* fields) {
    const T* const first = fields + lane % lanes;
    return Vec3{first[0], first[lanes], first[2 * lanes]};
  };
  const Vec3 move = vector_of(moved + v * simd::moved_fields * lanes);
  const double size = by * mass_of_move_[lane] * norm(move);
  return dot(move, vector_of(rod_.data() + v * simd::rod_fields * lanes)) > 0 ? size : -size;
}

template <class T>
void Block<T>::count_moves(simd::Range range, double by) {
  if (pulls_.empty()) return;
  const std::size_t lanes = packing_.lanes;
  for (std::size_t lane = range.begin * lanes; lane < range.end * lanes; ++lane)
    pulls_[lane] += impulse_of(lane, by);
}

template <class T>
void Block<T>::make_strengths(const Constants& constants) {
  const auto strength_of = [&](std::uint32_t edge) {
    return edge == layouts::none ? std::numeric_limits<double>::infinity() : constants.laws[edge].strength;
  };
  const Array<std::uint32_t>& edges = packing_.lane_edge;
  if (std::none_of(edges.begin(), edges.end(),
                   [&](std::uint32_t edge) { return std::isfinite(strength_of(edge)); }))
    return;
  std::set<std::uint32_t> seen;
  for (const std::uint32_t edge : edges) strengths_.push_back({strength_of(edge), seen.insert(edge).second});
  square_bounds_.assign(edges.size(), std::numeric_limits<double>::infinity());
  broken_.assign(edges.size(), 0);
  mass_of_move_.assign(edges.size(), 0);
}

template <class T>
void Block<T>::set_bound(std::size_t lane) {
  const double bound = strengths_[lane].strength / mass_of_move_[lane];
  square_bounds_[lane] = bound * bound;
}

/// Most vectors have no rod that is moved far enough, which the squares of moves tell.
template <class T>
bool Block<T>::may_break(std::size_t v, double square) const {
  constexpr std::size_t lanes = simd::logical_width<T>;
  const T* const moved = shift_.data() + v * simd::law_fields::shift * lanes;
  const double* const bounds = square_bounds_.data() + v * lanes;
  unsigned farther = 0;
  for (std::size_t i = 0; i < lanes; ++i) {
    const double x = moved[i], y = moved[lanes + i], z = moved[2 * lanes + i];
    farther |= x * x + y * y + z * z > square * bounds[i] ? 1u : 0u;
  }
  return farther != 0;
}

template <class T>
std::uint32_t Block<T>::break_rods(simd::Range range, double by, double h) {
  constexpr std::size_t lanes = simd::logical_width<T>;
  const double square = (h / by) * (h / by);
  std::uint32_t count = 0;
  for (std::size_t v = range.begin; v < range.end; ++v) {
    if (!may_break(v, square)) continue;
    const T* const kept = weight_.data() + (v * simd::weight_fields + 3) * lanes;
    for (std::size_t i = 0; i < lanes; ++i) {
      const std::size_t lane = v * lanes + i;
      const auto [strength, counts] = strengths_[lane];
      if (kept[i] == 0 || !(impulse_of(lane, by) > h * strength)) continue;  // 0 means that it is off
      switch_off(lane);
      broken_[lane] = 1;
      if (counts) ++count;
    }
  }
  return count;
}

template <class T>
void Block<T>::save_rods(SavedRods& to) const {
  if (!breaks()) return;
  to.weight.assign(weight_.data(), weight_.data() + weight_.size());
  to.law.assign(law_.data(), law_.data() + law_.size());
  to.mass_of_move = mass_of_move_;
  to.broken = broken_;
}

template <class T>
void Block<T>::restore_rods(const SavedRods& from) {
  if (from.broken == broken_) return;  // that is so if no rod may break
  std::copy(from.weight.begin(), from.weight.end(), weight_.data());
  std::copy(from.law.begin(), from.law.end(), law_.data());
  mass_of_move_ = from.mass_of_move;
  broken_ = from.broken;
  if (std::find(frozen_slots_.begin(), frozen_slots_.end(), 1) != frozen_slots_.end())
    retire_frozen_rods(0, packing_.positions);
}

#define PLUMB_INSTANTIATE(T)                                                \
  template void Block<T>::count_pulls();                                    \
  template void Block<T>::begin_pulls(std::uint32_t, std::uint32_t);        \
  template void Block<T>::begin_moves(simd::Range);                         \
  template void Block<T>::count_moves(simd::Range, double);                 \
  template void Block<T>::make_strengths(const Constants&);                 \
  template std::uint32_t Block<T>::break_rods(simd::Range, double, double); \
  template void Block<T>::save_rods(SavedRods&) const;                      \
  template void Block<T>::restore_rods(const SavedRods&);                   \
  template void Block<T>::set_bound(std::size_t);                           \
  template bool Block<T>::may_break(std::size_t, double) const;             \
  template double Block<T>::impulse_of(std::size_t, double) const;
PLUMB_INSTANTIATE(float)
PLUMB_INSTANTIATE(double)
#undef PLUMB_INSTANTIATE

}  // namespace plumb::detail
