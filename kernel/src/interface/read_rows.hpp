#pragma once

#include <cstddef>
#include <cstdint>

#include "interface/place.hpp"
#include "plumb/vec3.hpp"

namespace plumb::detail {

/// Says where a run's numbers are: x of its first particle, from that to y and from y to z, and to x of the
/// next one. Rows are in lanes side by side.
template <class T>
struct RowsAt {
  const T* first;
  std::ptrdiff_t component, next;
};

/// Reads three numbers of each particle of a run to its place in `out`, row after row. Memory is then written
/// in turn, while the lanes that rows share stay in the cache.
template <class T>
void read_rows(const Run& run, const RowsAt<T>& from, Vec3* out) {
  out += run.first;
  for (std::uint32_t row = 0; row < run.rows; ++row, out += run.row_first) {
    Vec3* to = out;
    const T* x = from.first + row;
    for (std::uint32_t i = 0; i < run.count; ++i, x += from.next, to += run.every)
      *to = {x[0], x[from.component], x[2 * from.component]};
  }
}

}  // namespace plumb::detail
