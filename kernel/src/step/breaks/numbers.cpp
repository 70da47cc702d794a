#include "step/breaks/numbers.hpp"

#include <algorithm>

namespace plumb::detail {

std::uint32_t Numbers::find(std::uint32_t size) const {
  for (const auto& [first, room] : free_)
    if (room >= size || first + room == count_) return first;
  return count_;
}

void Numbers::take(std::uint32_t first, std::uint32_t size) {
  if (size == 0) return;
  const std::uint32_t end = first + size;
  if (end > count_) {
    count_ = end;
    if (!generations_.empty()) generations_.resize(end, 0);
  }
  const auto range =
      std::find_if(free_.begin(), free_.end(), [&](const auto& of) { return of.first == first; });
  if (range != free_.end()) {
    if (range->second <= size)
      free_.erase(range);
    else
      *range = {end, range->second - size};
  }
  if (generations_.empty()) return;
  for (std::uint32_t number = first; number < end; ++number) ++generations_[number];
}

void Numbers::reserve(std::uint32_t size) {
  if (size == 0) return;
  if (generations_.empty()) generations_.assign(count_, 1);
  generations_.resize(count_ + size, 0);
  if (!free_.empty() && free_.back().first + free_.back().second == count_)
    free_.back().second += size;
  else
    free_.emplace_back(count_, size);
  count_ += size;
}

void Numbers::give_back(std::span<const std::uint32_t> numbers) {
  if (numbers.empty()) return;
  if (generations_.empty()) generations_.assign(count_, 1);
  for (std::size_t i = 0; i < numbers.size();) {
    const std::uint32_t first = numbers[i];
    std::uint32_t size = 0;
    for (; i < numbers.size() && numbers[i] == first + size; ++i, ++size) ++generations_[numbers[i]];
    auto next = std::lower_bound(free_.begin(), free_.end(), std::pair(first, 0u));
    if (next != free_.begin() && std::prev(next)->first + std::prev(next)->second == first)
      (--next)->second += size;
    else
      next = free_.insert(next, {first, size});
    const auto after = std::next(next);
    if (after == free_.end() || next->first + next->second != after->first) continue;
    next->second += after->second;
    free_.erase(after);
  }
}

void Numbers::list_free() {
  free_.clear();
  for (std::uint32_t number = 0; number < generations_.size(); ++number) {
    if (has(number)) continue;
    if (!free_.empty() && free_.back().first + free_.back().second == number)
      ++free_.back().second;
    else
      free_.emplace_back(number, 1);
  }
}

}  // namespace plumb::detail
