#pragma once

#include <cstdint>
#include <span>
#include <utility>

#include "plumb/layouts/memory.hpp"
#include "step/places.hpp"

namespace plumb::detail {

/// Cords are rods by their numbers, and from this number on reels and then tackles. So rods may be added, and
/// tackles behind the reels.
constexpr std::uint32_t first_line = 0x80000000;
constexpr bool is_line(std::uint32_t cord) {
  return cord >= first_line;
}

/// Holds something of each cord.
template <class T>
class CordTable {
 public:
  CordTable() = default;
  CordTable(Array<T> rods, Array<T> lines) : rods_(std::move(rods)), lines_(std::move(lines)) {}

  const T& operator[](std::uint32_t cord) const {
    return is_line(cord) ? lines_[cord - first_line] : rods_[cord];
  }
  T& operator[](std::uint32_t cord) { return is_line(cord) ? lines_[cord - first_line] : rods_[cord]; }
  std::size_t rods() const { return rods_.size(); }
  std::size_t lines() const { return lines_.size(); }
  /// Takes at least so many cords.
  void grow(std::size_t rods, std::size_t lines) {
    if (rods > rods_.size()) rods_.resize(rods);
    if (lines > lines_.size()) lines_.resize(lines);
  }

 private:
  Array<T> rods_, lines_;
};

/// Leads from cords to places.
struct CordPlaces {
  Places rods, lines;

  std::span<const Place> of(std::uint32_t cord) const {
    return is_line(cord) ? lines.of(cord - first_line) : rods.of(cord);
  }
  void replace(std::uint32_t cord, std::span<const Place> by) {
    is_line(cord) ? lines.replace(cord - first_line, by) : rods.replace(cord, by);
  }
};

}  // namespace plumb::detail
