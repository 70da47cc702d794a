// This file finds where capsules of a crowd touch each other, and where they would pass through each other.

#include <algorithm>

#include "contact/relaxed/crowd_contacts.hpp"
#include "contact/rows.hpp"

namespace plumb::detail {

template <class T>
void CrowdContacts<T>::place_lines(const Crowd<T>& crowd) {
  const PairSearch search{settings_.margin, settings_.tolerance};
  lines_.clear();
  for (const Body& each : near_.bodies()) {
    const auto a = near_.terms_of(each.a), b = near_.terms_of(each.b);
    lines_.push_back(
        {{crowd.position(a), crowd.position(b), each.shape->radius}, crowd.moved(a), crowd.moved(b)});
    is_fast_ = is_fast_ || search.is_fast(moves_of(lines_.back()), each.shape->radius);
  }
}

template <class T>
void CrowdContacts<T>::place_ways(const Crowd<T>& crowd) {
  const PairSearch search{settings_.margin, settings_.tolerance};
  place_lines(crowd);
  ways_.clear();
  for (const MovingSegment& each : lines_)
    ways_.push_back(search.may_be_fast(moves_of(each), each.at.radius) ? bounds_of(each) : nowhere);
  for (std::uint32_t k = 0; k < near_.hulls().size(); ++k) {
    const Bounds way = bounds_of(hull_motion(crowd, k).hull);
    ways_.push_back({way.low - crowd.origin(), way.high - crowd.origin()});
  }
}

template <class T>
bool CrowdContacts<T>::outrun_hulls(const Crowd<T>& crowd) {
  constexpr double farthest = 0.5;  // of the way to the hull's middle
  if (near_.hull_pairs().empty()) return false;
  place_ways(crowd);
  const auto lines = static_cast<std::uint32_t>(lines_.size());
  return std::any_of(near_.hull_pairs().begin(), near_.hull_pairs().end(), [&](const Pair& pair) {
    if (pair.one >= lines || !ways_[pair.one].overlaps(ways_[pair.other])) return false;
    const MovingSegment& line = lines_[pair.one];
    const MovingHullShape hull = hull_motion(crowd, pair.other - lines);
    double most = 0;
    for (const Vec3 by : hull.hull.by) most = std::max({most, norm(by - line.p_by), norm(by - line.q_by)});
    return most > settings_.margin + farthest * (hull.shape.half_width + line.at.radius);
  });
}

template <class T>
bool CrowdContacts<T>::is_fast(const Pair& pair) const {
  const MovingSegment &a = lines_[pair.one], &b = lines_[pair.other];
  const PairSearch search{settings_.margin, settings_.tolerance};
  return search.is_fast(moves_between(a, b), a.at.radius + b.at.radius);
}

template <class T>
void CrowdContacts<T>::touch_pair(const Substep& in, const Pair& pair, const Touch& touch,
                                  std::uint64_t key) {
  const Body &a = near_.bodies()[pair.one], &b = near_.bodies()[pair.other];
  const Combination at_a = blend(a.shape->a, a.shape->b, touch.a),
                    at_b = blend(b.shape->a, b.shape->b, touch.b);
  add(in, {a.island, a.number, &at_a, &a.shape->surface}, {b.island, b.number, &at_b, &b.shape->surface},
      touch, key);
}

template <class T>
void CrowdContacts<T>::touch_pairs(const Substep& in) {
  constexpr std::uint32_t first = 3;  // the number after those of touches()
  const PairSearch search{settings_.margin, settings_.tolerance};
  place_lines(in.crowd);
  for (const Pair& pair : near_.pairs()) {
    const Body &a = near_.bodies()[pair.one], &b = near_.bodies()[pair.other];
    if (!in.crowd.is_moving(a.island) && !in.crowd.is_moving(b.island)) continue;
    const MovingSegment &line_a = lines_[pair.one], &line_b = lines_[pair.other];
    const auto key = [&](std::uint32_t n) {
      return contact_key(KeyKind::island, 4 * a.number + n, in.cluster[b.island]->number, b.number);
    };
    const bool fast = is_fast(pair);
    const double reach = fast ? search.reach(line_a.at.radius + line_b.at.radius) : INFINITY;
    const Touches near = touches(line_a.at, line_b.at);
    for (std::uint32_t n = 0; n < near.count; ++n)
      if (near.at[n].gap <= reach) touch_pair(in, pair, near.at[n], key(n));
    if (!fast) continue;
    if (const auto plane = search.first_touch(line_a, line_b)) {
      touch_pair(in, pair, *plane, key(first));
      is_struck_ = true;
    }
  }
}

/// Adds contacts between shapes that pass through each other, since others pushed them.
template <class T>
void CrowdContacts<T>::find_missed_pairs(const Substep& in) {
  const PairSearch search{settings_.margin, settings_.tolerance};
  place_ways(in.crowd);
  near_.follow(in.cluster, in.crowd, ways_);
  for (const Pair& pair : near_.pairs()) {
    if (!is_fast(pair)) continue;
    const auto plane = search.passed(lines_[pair.one], lines_[pair.other]);
    if (!plane) continue;
    is_struck_ = true;
    const std::uint32_t other = near_.bodies()[pair.other].island;
    touch_pair(in, pair, *plane,
               contact_key(KeyKind::island, std::uint64_t{1} << 40 | near_.bodies()[pair.one].number,
                           in.cluster[other]->number, contacts_.size()));
  }
}

template bool CrowdContacts<float>::outrun_hulls(const Crowd<float>&);
template bool CrowdContacts<double>::outrun_hulls(const Crowd<double>&);
template void CrowdContacts<float>::touch_pairs(const Substep&);
template void CrowdContacts<float>::find_missed_pairs(const Substep&);
template void CrowdContacts<double>::touch_pairs(const Substep&);
template void CrowdContacts<double>::find_missed_pairs(const Substep&);

}  // namespace plumb::detail
