#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// Holds a list for each of many numbers, all lists in one array. A list may be replaced in time that does
/// not depend on how many numbers there are. Where it grows, it moves to the end, and gaps are closed once
/// they are half of the array.
template <class T>
class Rows {
 public:
  struct Entry {
    std::uint32_t row;
    T item;
  };
  struct Range {
    std::uint32_t begin = 0, count = 0;
    std::uint32_t room = 0;  ///< so many items fit without a move
  };

  Rows() = default;
  /// Sorts the entries by row in linear time. The items of a row keep the order of `entries`.
  Rows(std::uint32_t rows, std::span<const Entry> entries) : ranges_(rows), items_(entries.size()) {
    for (const Entry& entry : entries) ++ranges_[entry.row].room;
    for (std::size_t i = 1; i < rows; ++i) ranges_[i].begin = ranges_[i - 1].begin + ranges_[i - 1].room;
    for (const Entry& entry : entries) {
      Range& range = ranges_[entry.row];
      items_[range.begin + range.count++] = entry.item;
    }
  }

  std::uint32_t count() const { return static_cast<std::uint32_t>(ranges_.size()); }
  const Range& range(std::uint32_t row) const { return ranges_[row]; }
  std::span<const T> items() const { return items_; }
  std::span<const T> of(std::uint32_t row) const {
    return std::span(items_).subspan(ranges_[row].begin, ranges_[row].count);
  }

  /// Adds rows that are empty, up to so many.
  void grow(std::uint32_t rows) {
    if (rows > count()) ranges_.resize(rows);
  }
  /// `by` must be no part of this.
  void replace(std::uint32_t row, std::span<const T> by) {
    Range& range = ranges_[row];
    const auto size = static_cast<std::uint32_t>(by.size());
    if (size > range.room) {
      gaps_ += range.room;
      range = {static_cast<std::uint32_t>(items_.size()), 0, size};
      items_.resize(items_.size() + size);
    }
    range.count = size;
    std::copy(by.begin(), by.end(), items_.begin() + range.begin);
    if (gaps_ > items_.size() / 2) close_gaps();
  }

 private:
  void close_gaps() {
    const Array<T> before = std::exchange(items_, {});
    items_.reserve(before.size() - gaps_);
    for (Range& range : ranges_) {
      const auto first = before.begin() + range.begin;
      range.begin = static_cast<std::uint32_t>(items_.size());
      items_.insert(items_.end(), first, first + range.room);
    }
    gaps_ = 0;
  }

  Array<Range> ranges_;  ///< by row
  Array<T> items_;
  std::size_t gaps_ = 0;  ///< items that are in no range's room
};

}  // namespace plumb::detail
