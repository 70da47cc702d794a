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
///
/// Equal ones, as of ropes side by side in lanes, are rows of one run if they are evenly apart, too.
struct Run {
  std::uint32_t first;                    ///< the first of the particles
  std::uint32_t every;                    ///< from one to the next: 1, or 2 where even and odd ones lie apart
  std::uint32_t count;                    ///< in a row
  std::uint32_t solver;                   ///< or `nowhere` of particles without a place
  std::uint32_t slot, slot_stride;        ///< the first, and from one to the next
  std::uint32_t address, address_stride;  ///< likewise
  std::uint32_t rows = 1;
  std::uint32_t row_first = 0, row_slot = 0, row_address = 0;  ///< from one row to the next

  static constexpr std::uint32_t nowhere = ~std::uint32_t{0};
  bool is_in_turn() const { return rows == 1 && every == 1 && slot_stride == 1; }
  std::uint32_t last_slot() const { return slot + (count - 1) * slot_stride; }
  /// Calls f(particle) for each.
  template <class F>
  void for_particles(F&& f) const {
    for (std::uint32_t row = 0; row < rows; ++row)
      for (std::uint32_t i = 0; i < count; ++i) f(first + row * row_first + i * every);
  }
  /// Writes what read(slot) returns of each to its particle in `out`.
  template <class Number, class Read>
  void read_slots(Number* out, Read&& read) const {
    read_each(slot, slot_stride, row_slot, out, read);
  }
  /// Writes what read(address) returns of each likewise.
  template <class Number, class Read>
  void read_addresses(Number* out, Read&& read) const {
    read_each(address, address_stride, row_address, out, read);
  }
  /// Makes the rows of another run those after its own, if they are. Returns whether they are.
  bool takes(const Run& next) {
    if (next.solver != solver || next.count != count || next.every != every ||
        next.slot_stride != slot_stride || next.address_stride != address_stride || next.rows != 1)
      return false;
    if (rows == 1) {
      row_first = next.first - first;
      row_slot = next.slot - slot;
      row_address = next.address - address;
    } else if (next.first != first + rows * row_first || next.slot != slot + rows * row_slot ||
               next.address != address + rows * row_address) {
      return false;
    }
    ++rows;
    return true;
  }

 private:
  template <class Number, class Read>
  void read_each(std::uint32_t at, std::uint32_t stride, std::uint32_t row_stride, Number* out,
                 Read& read) const {
    out += first;
    for (std::uint32_t row = 0; row < rows; ++row, at += row_stride, out += row_first) {
      Number* to = out;
      for (std::uint32_t i = 0, next = at; i < count; ++i, next += stride, to += every) *to = read(next);
    }
  }
};

}  // namespace plumb::detail
