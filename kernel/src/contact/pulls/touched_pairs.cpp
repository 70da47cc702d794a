// This file adds up what an island's shapes touched.

#include "contact/pulls/touched_pairs.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

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
}

void TouchedPairs::add(std::uint32_t shape, std::uint32_t island, std::uint32_t other,
                       const TouchPush& push) {
  if (!counts || !(norm(push.impulse) > 0) || !is_finite(push.impulse) || !is_finite(push.place)) return;
  pairs_.push_back({.shape = shape, .island = island, .other = other, .order = added_++});
  pairs_.back().add(push);
  if (pairs_.size() >= few_) merge();
}

void TouchedPairs::renumber(std::span<const std::uint32_t> now) {
  std::erase_if(pairs_, [&](TouchedPair& each) {
    if (each.island == TouchedPair::ground) return false;
    each.island = now[each.island];
    return each.island == none;
  });
}

void TouchedPairs::merge() {
  for (std::uint32_t i = 0; i < pairs_.size(); ++i) {
    const TouchedPair& each = pairs_[i];
    keys_.push_back({each.shape, std::uint64_t{each.island} << 32 | each.other, each.order, i});
  }
  std::sort(keys_.begin(), keys_.end(), [](const Key& a, const Key& b) {
    return std::tie(a.own, a.other, a.order) < std::tie(b.own, b.other, b.order);
  });
  for (std::size_t k = 0; k < keys_.size(); ++k) {
    const TouchedPair& each = pairs_[keys_[k].index];
    if (k > 0 && std::tie(keys_[k - 1].own, keys_[k - 1].other) == std::tie(keys_[k].own, keys_[k].other))
      merged_.back().add(each);
    else
      merged_.push_back(each);
  }
  std::swap(pairs_, merged_);
  merged_.clear();
  keys_.clear();
  few_ = std::max(least, 4 * pairs_.size());
}

}  // namespace plumb::detail
