#pragma once

#include <cmath>
#include <cstdint>

#include "contact/linkage/linkage_state.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// Finds boxes near each other in time that grows linearly with their number. Space is a grid of cells, whose
/// lists share a hash table.
///
/// A box is listed in every cell that it reaches into. A box much larger than a cell, or too far away for
/// cells to have numbers, is kept aside. Such a box is always found, and finds others by a walk through the
/// whole table.
class SpatialHash {
 public:
  void start(double cell, std::size_t expected) {
    over_ = 1 / cell;
    std::size_t size = 64;
    while (size < 2 * expected) size *= 2;
    heads_.assign(size, none);
    entries_.clear();
    free_ = none;
    large_.clear();
    count_ = 0;
  }

  bool is_empty() const { return count_ == 0; }

  void insert(std::uint32_t id, const Bounds& bounds) {
    ++count_;
    if (is_large(bounds)) return large_.push_back(id);
    for_cells(bounds, [&](std::size_t cell) { put(id, cell); });
  }

  /// Does what find() and then insert() would do, in one walk. Two cells of a box may share a list, so an id
  /// may come twice.
  template <class F>
  void find_and_insert(std::uint32_t id, const Bounds& bounds, F&& f) {
    if (is_large(bounds)) {
      find(bounds, f);
      return insert(id, bounds);
    }
    ++count_;
    for (const std::uint32_t other : large_) f(other);
    for_cells(bounds, [&](std::size_t cell) {
      for (std::uint32_t at = heads_[cell]; at != none; at = entries_[at].next)
        if (entries_[at].id != id) f(entries_[at].id);
      put(id, cell);
    });
  }

  /// Takes out an id that was inserted with the same bounds.
  void remove(std::uint32_t id, const Bounds& bounds) {
    --count_;
    if (is_large(bounds)) {
      std::erase(large_, id);
      return;
    }
    for_cells(bounds, [&](std::size_t cell) {
      for (std::uint32_t* link = &heads_[cell]; *link != none; link = &entries_[*link].next) {
        if (entries_[*link].id != id) continue;
        const std::uint32_t at = *link;
        *link = entries_[at].next;
        entries_[at].next = free_;
        free_ = at;
        break;
      }
    });
  }

  /// Calls f(id) for all boxes that may overlap `bounds`. An id may come several times.
  template <class F>
  void find(const Bounds& bounds, F&& f) const {
    for (const std::uint32_t id : large_) f(id);
    if (is_large(bounds)) {
      for (const std::uint32_t head : heads_)
        for (std::uint32_t at = head; at != none; at = entries_[at].next) f(entries_[at].id);
      return;
    }
    for_cells(bounds, [&](std::size_t cell) {
      for (std::uint32_t at = heads_[cell]; at != none; at = entries_[at].next) f(entries_[at].id);
    });
  }

 private:
  static constexpr std::uint32_t none = 0xffffffff;
  static constexpr double most_cells = 64;
  static constexpr double farthest_cell = 1e18;  ///< coordinates in cells beyond which cells have no numbers

  struct Entry {
    std::uint32_t id, next;
  };

  void put(std::uint32_t id, std::size_t cell) {
    std::uint32_t at = free_;
    if (at == none) {
      at = static_cast<std::uint32_t>(entries_.size());
      entries_.emplace_back();
    } else {
      free_ = entries_[at].next;
    }
    entries_[at] = {id, heads_[cell]};
    heads_[cell] = at;
  }

  bool is_large(const Bounds& b) const {
    const Vec3 size = over_ * (b.high - b.low);
    // These comparisons are written so that infinities fail them, too.
    const auto is_numbered = [&](Vec3 p) {
      return std::abs(p.x * over_) < farthest_cell && std::abs(p.y * over_) < farthest_cell &&
             std::abs(p.z * over_) < farthest_cell;
    };
    return !((size.x + 1) * (size.y + 1) * (size.z + 1) <= most_cells) || !is_numbered(b.low) ||
           !is_numbered(b.high);
  }

  template <class F>
  void for_cells(const Bounds& bounds, F&& f) const {
    const auto cell = [&](double x) { return static_cast<std::int64_t>(std::floor(x * over_)); };
    for (std::int64_t x = cell(bounds.low.x); x <= cell(bounds.high.x); ++x)
      for (std::int64_t y = cell(bounds.low.y); y <= cell(bounds.high.y); ++y)
        for (std::int64_t z = cell(bounds.low.z); z <= cell(bounds.high.z); ++z) {
          std::uint64_t hash = static_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15u ^
                               static_cast<std::uint64_t>(y) * 0xc2b2ae3d27d4eb4fu ^
                               static_cast<std::uint64_t>(z) * 0x165667b19e3779f9u;
          hash ^= hash >> 29;
          f(static_cast<std::size_t>(hash) & (heads_.size() - 1));
        }
  }

  double over_ = 1;
  Array<std::uint32_t> heads_;
  Array<Entry> entries_;
  std::uint32_t free_ = none;
  Array<std::uint32_t> large_;
  std::size_t count_ = 0;
};

}  // namespace plumb::detail
