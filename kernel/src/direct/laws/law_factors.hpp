#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "math/elementary.hpp"
#include "plumb/scene.hpp"
#include "plumb/settings.hpp"
#include "simd/tree/tree_kernels.hpp"
#include "time/verlet.hpp"

namespace plumb::detail {

/// These factors make an equation of a law, see simd::law_factors.
struct LawFactors {
  double share = 0, kick = 0, kick_back = 0, kick_before = 0, rate = 0, substep = 0, substep_before = 0;

  /// Returns those of a substep of `h` (s) after one of `last` (s), or 0 after a velocity. Forces act on its
  /// displacement by `kick` (s^2), and the air by `drag` (1/s). Of a kick with drag, the half that the
  /// substep before has left and the half of this one decay one after the other, as composed substeps need.
  static LawFactors of(Gradient gradient, double kick, double last, double h, double drag) {
    if (gradient != Gradient::old)
      return {.share = gradient == Gradient::mid ? 0.5 : 1, .kick = kick, .rate = 1 / h};
    const double left = h * mean_decay(drag * last / 2) * detail::exp(-drag * h / 2);
    return {.share = 0.5,
            .kick = kick,
            .kick_back = last != 0 ? kick - h * (h / 2) * mean_decay(drag * h / 2) : 0,
            .kick_before = last != 0 ? left : 0,
            .rate = 1 / h,
            .substep = h,
            .substep_before = last};
  }
  /// Returns those of a projection of velocities, after a substep of `last` (s). Forces change them by `kick`
  /// (s), and so does the half kick that rods of gradient old keep.
  static LawFactors of_projection(double kick, double last) {
    return {.kick_before = last > 0 ? 2 * kick / last : 0, .substep = kick != 0 ? last : 0};
  }
  std::array<double, simd::law_factors::count> numbers() const {
    return {share, kick, kick_back, kick_before, rate, substep, substep_before};
  }
  /// Writes them for one of `lanes`.
  template <class T>
  void put(T* to, std::size_t lanes) const {
    const auto of = numbers();
    for (std::size_t c = 0; c < of.size(); ++c) to[c * lanes] = static_cast<T>(of[c]);
  }
  bool operator==(const LawFactors&) const = default;
};

/// Laws are made for masses in units of `unit` (kg). `give` is the sum of the inverse masses of a rod's ends,
/// in 1/kg.
struct LawMasses {
  double unit, give;
};
/// Returns tree_fields::law numbers of a rod.
inline std::array<double, simd::tree_fields::law> law_numbers(const RodLaw& law, const LawMasses& masses) {
  const auto [unit, give] = masses;
  const double strength = std::isfinite(law.strength) ? law.strength / unit : 0;
  if (!law.is_elastic()) return {0, 0, 1, law.one_sided ? 1.0 : 0.0, 0, strength};
  return {law.stiffness / unit,      law.damping / unit,   0,
          law.one_sided ? 1.0 : 0.0, law.stiffness * give, strength};
}

/// Rigid cables start Newton's method with at least this multiplier, in units of mass. One whose |C|/L^2 is
/// less than that starts as taut. Lines then come tight in few iterations, where each finds but the next taut
/// rod otherwise. Of 1,000 random hangings equally many frames were dear with 1e-3, 1e-4 and 1e-8.
inline constexpr double drawn_cable = 1e-4;

/// Gradient mid turns what a load has along a taut cable about, from a to -a, and back while the cable stays
/// taut. That takes an impulse of 2 m a from what bears the load. A substep that turned a to -a pulled with
/// that on top, so that a next one pulls with 4 m a less. Where m a, which a projection finds, is more than
/// this share of the last impulse, the cable was thrown back, and the next substep finds it slack.
inline constexpr double thrown_back = 0.25;

}  // namespace plumb::detail
