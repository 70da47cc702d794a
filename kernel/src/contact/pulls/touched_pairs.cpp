// This file adds up what an island's shapes touched.

#include "contact/pulls/touched_pairs.hpp"

#include <algorithm>
#include <tuple>

namespace plumb::detail {

void TouchedPair::add(const TouchPush& push) {
  const double size = norm(push.impulse);
  impulse += push.impulse;
  weight += size;
  place += size * push.place;
  normal += size * push.normal;
  approach = std::max(approach, push.approach);
}

void TouchedPair::add(const TouchedPair& of_same) {
  impulse += of_same.impulse;
  weight += of_same.weight;
  place += of_same.place;
  normal += of_same.normal;
  approach = std::max(approach, of_same.approach);
}

void TouchedPairs::begin_step() {
  pairs_.clear();
  added_ = 0;
  few_ = least;
}

void TouchedPairs::add(std::uint32_t shape, std::uint32_t island, std::uint32_t other,
                       const TouchPush& push) {
  if (!counts || push.impulse == Vec3{} || !is_finite(push.impulse) || !is_finite(push.place)) return;
  pairs_.push_back({.shape = shape, .island = island, .other = other, .order = added_++});
  pairs_.back().add(push);
  if (pairs_.size() < few_) return;
  merge();
  few_ = std::max(least, 2 * pairs_.size());
}

void TouchedPairs::merge() {
  const auto numbers = [](const TouchedPair& each) {
    return std::tuple(each.shape, each.island, each.other);
  };
  std::sort(pairs_.begin(), pairs_.end(), [&](const TouchedPair& a, const TouchedPair& b) {
    return std::tuple(numbers(a), a.order) < std::tuple(numbers(b), b.order);
  });
  std::size_t kept = 0;
  for (const TouchedPair& each : pairs_) {
    if (kept > 0 && numbers(pairs_[kept - 1]) == numbers(each))
      pairs_[kept - 1].add(each);
    else
      pairs_[kept++] = each;
  }
  pairs_.resize(kept);
}

}  // namespace plumb::detail
