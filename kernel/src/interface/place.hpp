#pragma once

#include <cstdint>

namespace plumb::detail {

/// Says where the numbers of a particle or a rod are: the solver, and the slot in it.
struct Place {
  std::uint32_t solver;
  std::uint32_t slot;

  friend bool operator==(const Place&, const Place&) = default;
};

/// Says where many particles of a solver are: in slots, and at addresses (Solver::address()), that are evenly
/// apart. Strides may wrap round, backwards.
struct Run {
  std::uint32_t first;  ///< the first of the particles
  std::uint32_t every;  ///< from one to the next: 1, or 2 where even and odd ones lie apart
  std::uint32_t count;
  std::uint32_t solver;
  std::uint32_t slot, slot_stride;        ///< the first, and from one to the next
  std::uint32_t address, address_stride;  ///< likewise

  std::uint32_t last_slot() const { return slot + (count - 1) * slot_stride; }
  /// Writes what read(slot) returns of each to its particle in `out`.
  template <class Number, class Read>
  void read_slots(Number* out, Read&& read) const {
    read_each(slot, slot_stride, out, read);
  }
  /// Writes what read(address) returns of each likewise.
  template <class Number, class Read>
  void read_addresses(Number* out, Read&& read) const {
    read_each(address, address_stride, out, read);
  }

 private:
  template <class Number, class Read>
  void read_each(std::uint32_t at, std::uint32_t stride, Number* out, Read& read) const {
    out += first;
    for (std::uint32_t i = 0; i < count; ++i, at += stride, out += every) *out = read(at);
  }
};

}  // namespace plumb::detail
