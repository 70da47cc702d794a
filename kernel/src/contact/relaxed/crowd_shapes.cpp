// This file finds the contacts of capsules with each other that CrowdLines leaves.

#include <algorithm>
#include <cmath>

#include "contact/relaxed/crowd_contacts.hpp"
#include "contact/rows.hpp"

namespace plumb::detail {
template <class T>
bool CrowdContacts<T>::is_fast(const Pair& pair) const {
  const PlacedLine &a = placed_lines_[pair.one], &b = placed_lines_[pair.other];
  const double radii = a.radius + b.radius;
  // The first takes no roots, and most are not fast.
  return pair_search().is_fast(a.moves + b.moves, radii) &&
         pair_search().is_fast(moves_between(a.way(), b.way()), radii);
}

template <class T>
void CrowdContacts<T>::touch_pair(const Substep& in, const Pair& pair, const Touch& touch,
                                  std::uint64_t key) {
  const Body &a = near_.bodies()[pair.one], &b = near_.bodies()[pair.other];
  const Middle<T> at_a = middle_of(in, a, touch.a), at_b = middle_of(in, b, touch.b);
  add(in, side_of(a, at_a), side_of(b, at_b), touch, key);
}

template <class T>
std::uint64_t CrowdContacts<T>::key_of(const Substep& in, const Pair& pair, std::uint32_t which) const {
  const Body &a = near_.bodies()[pair.one], &b = near_.bodies()[pair.other];
  return contact_key(KeyKind::island, 4 * a.number + which, in.cluster[b.island]->number, b.number);
}

template <class T>
void CrowdContacts<T>::touch_pairs(const Substep& in, std::span<const Pair> pairs) {
  for (const Pair& pair : pairs) {
    const Body &a = near_.bodies()[pair.one], &b = near_.bodies()[pair.other];
    if (in.crowd.is_moving(a.island) || in.crowd.is_moving(b.island)) touch_shapes(in, pair);
  }
}

/// Finds the contacts of a pair of any shapes, which may be fast.
template <class T>
void CrowdContacts<T>::touch_shapes(const Substep& in, const Pair& pair) {
  constexpr std::uint32_t first = simd::most_line_touches;  // the number after those of touches()
  const PairSearch search = pair_search();
  const PlacedLine &a = placed_lines_[pair.one], &b = placed_lines_[pair.other];
  const MovingSegment line_a = a.way(), line_b = b.way();
  // What is farther apart does not come about in the substep, see add(), nor does it meet in passing, since
  // it moves by less. Rounding is far below the share.
  const double comes = settings_.margin + 1.26 * (a.moves + b.moves);
  if (are_apart(line_a.at, line_b.at, comes)) return;
  const bool fast = is_fast(pair);
  const double reach = fast ? search.reach(a.radius + b.radius) : comes;
  const Touches near = touches(line_a.at, line_b.at, reach);
  for (std::uint32_t n = 0; n < near.count; ++n)
    if (near.at[n].gap <= reach) touch_pair(in, pair, near.at[n], key_of(in, pair, n));
  if (!fast) return;
  if (const auto plane = search.first_touch(line_a, line_b)) {
    touch_pair(in, pair, *plane, key_of(in, pair, first));
    in.to.is_struck = true;
  }
}

template bool CrowdContacts<float>::is_fast(const Pair&) const;
template void CrowdContacts<float>::touch_pair(const Substep&, const Pair&, const Touch&, std::uint64_t);
template void CrowdContacts<float>::touch_pairs(const Substep&, std::span<const Pair>);
template bool CrowdContacts<double>::is_fast(const Pair&) const;
template void CrowdContacts<double>::touch_pair(const Substep&, const Pair&, const Touch&, std::uint64_t);
template void CrowdContacts<double>::touch_pairs(const Substep&, std::span<const Pair>);

}  // namespace plumb::detail
