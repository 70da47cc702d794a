#pragma once

#include <cstdint>

#include "plumb/layouts/aligned_buffer.hpp"
#include "plumb/scene.hpp"
#include "plumb/settings.hpp"
#include "simd/tree/tree_kernels.hpp"

namespace plumb::detail {

/// These factors make an equation of a law, see simd::law_factors.
struct LawFactors {
  double damping = 0, share = 0, kick = 0, kick_before = 0, substep = 0;

  /// Returns those of a substep of `h` (s) after one of `last` (s), or 0 after a velocity. Forces act on its
  /// displacement by `kick` (s^2).
  static LawFactors of(Gradient gradient, double kick, double last, double h) {
    if (gradient == Gradient::mid) return {kick / h, 0.5, kick, 0, 0};
    if (gradient == Gradient::new_) return {kick / h, 1, kick, 0, 0};
    const double between = (h + last) / 2, own = kick * (h / 2) / between;
    return {own / h, 0.5, own, last != 0 ? kick / between : 0, h};
  }
  template <class T>
  void write(layouts::AlignedBuffer<T>& to, std::uint32_t lanes, std::uint32_t lane) const {
    const double numbers[simd::law_factors::count] = {damping, share, kick, kick_before, substep};
    for (std::uint32_t c = 0; c < simd::law_factors::count; ++c)
      to[std::size_t{c} * lanes + lane] = static_cast<T>(numbers[c]);
  }
};

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

  /// Writes the law of rod `i` of a lane into `rods` or `ties`. `unit` is that of mass, in kg. `give` is the
  /// sum of the inverse masses of its ends, in 1/kg.
  void put(layouts::AlignedBuffer<T>& to, std::size_t i, std::uint32_t lanes, std::uint32_t lane,
           const RodLaw& law, double unit, double give) {
    const bool elastic = law.is_elastic();
    const double numbers[simd::tree_fields::law] = {elastic ? law.stiffness / unit : 0, law.damping / unit,
                                                    elastic ? 0.0 : 1.0, law.one_sided ? 1.0 : 0.0,
                                                    elastic ? law.stiffness * give : 0};
    for (std::size_t c = 0; c < simd::tree_fields::law; ++c)
      to[(simd::tree_fields::law * i + c) * lanes + lane] = static_cast<T>(numbers[c]);
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
