#pragma once

#include <cstddef>
#include <cstdint>

#include "direct/laws/law_factors.hpp"
#include "plumb/layouts/aligned_buffer.hpp"

namespace plumb::detail {

/// Holds how the rods of `lanes` equal trees give, see simd::TreeView. Trees of rigid rods have none of it.
template <class T>
struct TreeLaws {
  bool any = false;     ///< Some rod is not rigid.
  bool cables = false;  ///< Some rod is one-sided.
  layouts::AlignedBuffer<T> rods, ties;      ///< They have tree_fields::law numbers per rod.
  layouts::AlignedBuffer<T> half_kick, tie_half_kick;  ///< They have one number per rod.

  /// Makes room for so many rods to parents and to anchors, lanes included, which are rigid.
  void make(std::size_t nodes, std::size_t tie_count) {
    any = true;
    if (rods.size() > 0) return;
    rods = layouts::AlignedBuffer<T>(simd::tree_fields::law * nodes);
    ties = layouts::AlignedBuffer<T>(simd::tree_fields::law * tie_count);
    half_kick = layouts::AlignedBuffer<T>(nodes);
    tie_half_kick = layouts::AlignedBuffer<T>(tie_count);
  }

  /// Writes the law of rod `i` of a lane into `rods` or `ties`, with what law_numbers() needs.
  void put(layouts::AlignedBuffer<T>& to, std::size_t i, std::uint32_t lanes, std::uint32_t lane,
           const RodLaw& law, double unit, double give) {
    const auto numbers = law_numbers(law, unit, give);
    for (std::size_t c = 0; c < numbers.size(); ++c)
      to[(numbers.size() * i + c) * lanes + lane] = static_cast<T>(numbers[c]);
    cables = cables || law.one_sided;
  }
};

/// These two visit the buffers of laws beside those of another, as f(field, ties' field, numbers per rod,
/// other's, other's): those that never change, and those that substeps change.
template <class Laws, class Other, class F>
void for_laws(Laws& laws, Other& other, F&& f) {
  f(laws.rods, laws.ties, simd::tree_fields::law, other.rods, other.ties);
}
template <class Laws, class Other, class F>
void for_law_motion(Laws& laws, Other& other, F&& f) {
  f(laws.half_kick, laws.tie_half_kick, 1u, other.half_kick, other.tie_half_kick);
}

}  // namespace plumb::detail
