// Sums of particles that contacts keep apart, in vectors of lanes. contact_lanes.hpp and
// line_contact_lanes.hpp include it, and it has internal linkage as they have.

#pragma once

#include "simd/relax/visit_lanes.hpp"

namespace plumb::simd {
namespace {

/// Says whether terms are summed up record by record, and sums alone are transposed. Where a record of
/// doubles fills a register that takes a fifth off a visit. Where two do, whole terms are transposed as fast.
template <class Access, class T>
constexpr bool sums_records =
    std::is_same_v<Access, RecordAccess>&& std::is_same_v<T, double>&& width<T> == 4;

/// The terms of contacts of one machine vector: where each has its particles. Of numbers that every term has,
/// those of a term follow those of the one before after `step`.
template <class Access, class T>
struct TermLanes {
  const std::uint32_t* at;
  std::size_t stride;  ///< of components

  PLUMB_INLINE Triple<T> load(const T* data, std::uint32_t term) const {
    if constexpr (std::is_same_v<Access, RecordAccess>)
      return Access::load(data, at + term * logical_width<T>);
    else
      return Access::load(data, at + term * logical_width<T>, stride);
  }
  PLUMB_INLINE void store(const Triple<T>& value, T* data, std::uint32_t term) const {
    if constexpr (std::is_same_v<Access, RecordAccess>)
      Access::store(value, data, at + term * logical_width<T>);
    else
      Access::store(value, data, at + term * logical_width<T>, stride);
  }

  /// Returns the sums of terms, made record by record.
  template <std::uint32_t terms, std::uint32_t step>
  PLUMB_INLINE Triple<T> sum_records(const T* weights, const T* data) const {
    Record<T> sums[width<T>];
    for (std::uint32_t lane = 0; lane < width<T>; ++lane) {
      sums[lane] = Record<T>{};
      for (std::uint32_t k = 0; k < terms; ++k)
        sums[lane] += weights[k * step + lane] * load_record(data + place(k, lane));
    }
    Columns<T, width<T>> columns;
    to_columns(sums, columns);
    return {Batch<T>(columns.x), Batch<T>(columns.y), Batch<T>(columns.z)};
  }
  /// Moves the terms by their shares of `by`, kg m. A place that two terms share is written last by the one
  /// that has a weight.
  template <std::uint32_t terms, std::uint32_t step>
  PLUMB_INLINE void move_records(const T* moves, const Triple<T>& by, T* data) const {
    Record<T> records[width<T>];
    to_records(Columns<T, width<T>>{by.x.data, by.y.data, by.z.data}, records);
    for (std::uint32_t lane = 0; lane < width<T>; ++lane) {
      Record<T> p[terms];
      for (std::uint32_t k = 0; k < terms; ++k) p[k] = load_record(data + place(k, lane));
      for (std::uint32_t k = 0; k < terms; ++k)
        store_record(p[k] + moves[k * step + lane] * records[lane], data + place(k, lane));
    }
  }

  PLUMB_INLINE std::uint32_t place(std::uint32_t term, std::uint32_t lane) const {
    return at[term * logical_width<T> + lane];
  }
};

}  // namespace
}  // namespace plumb::simd
