#pragma once

#include "direct/loops/loop_newton.hpp"
#include "direct/loops/loop_vectors.hpp"

namespace plumb::detail {

/// A segment pulls its first end along -force, and its length grows along `gradient`. Both have no unit.
/// `slope` is the derivative of force by what the ends come apart, but for force itself, in 1/m.
struct Pull {
  Vec3 force, gradient;
  double slope, growth;  ///< growth of the length, in m
};

/// Returns that of a segment whose ends come apart by e. With theta 1/2 force . e is the growth, so that the
/// work of a cord is its pull times that.
Pull pull_along(const TackleWorkspace::Segment& segment, Vec3 e, double theta);

/// Walks along the cords of an island at the present displacements.
class Cords {
 public:
  /// Unless the island moves, cords lie where the substep starts.
  Cords(const LoopState& state, const LoopWorkspace& work, double theta, bool moves = true)
      : state_(state), work_(work), theta_(theta), moves_(moves) {}

  std::uint32_t count() const { return static_cast<std::uint32_t>(state_.topology->tackles.size()); }
  const LoopTackle& tackle(std::uint32_t t) const { return state_.topology->tackles[t]; }
  std::uint32_t multiplier(std::uint32_t t) const {
    return static_cast<std::uint32_t>(state_.topology->rods.size()) + t;
  }
  /// Returns the number of the multiplier of a segment.
  std::uint32_t multiplier(std::uint32_t t, std::uint32_t segment) const {
    const LoopTackle& of = tackle(t);
    return of.rubs && segment > 0 ? multiplier(count()) + of.first_pulley + segment - 1 : multiplier(t);
  }

  /// Calls f(segment, first vertex, second vertex, pull) along tackle `t`.
  template <class F>
  void along(std::uint32_t t, F&& f) const {
    const LoopTackle& of = tackle(t);
    const auto* segment = work_.tackles.segments.data() + of.first;
    for (std::uint32_t s = 0; s < of.segments(); ++s, ++segment) {
      const std::uint32_t a = of.vertices[s], b = of.vertices[s + 1];
      const Vec3 apart = moves_ ? at(work_.delta, a) - at(work_.delta, b) : Vec3{};
      f(s, a, b, pull_along(*segment, apart, theta_));
    }
  }

  TackleIterate iterate(std::uint32_t t) const {
    const double start = work_.tackles.starts[t] - work_.tackles.lengths[t];
    double growth = 0;
    along(t, [&](std::uint32_t, std::uint32_t, std::uint32_t, const Pull& pull) { growth += pull.growth; });
    const double paid =
        state_.tackle_laws[t].is_rigid ? 0 : work_.tackles.lengths[t] - state_.tackles[t].length;
    return {start, start + growth, state_.mu[multiplier(t)], paid};
  }
  TackleRow row(std::uint32_t t, double soft) const {
    const LawFactors& factors = work_.laws.factors;
    if (soft > 0) return giving_tackle_row(state_.tackle_laws[t], factors.kick, 2 * soft, iterate(t));
    return tackle_row(state_.tackle_laws[t], {factors.kick, factors.rate, theta_}, iterate(t));
  }

 private:
  const LoopState& state_;
  const LoopWorkspace& work_;
  double theta_;
  bool moves_;
};

}  // namespace plumb::detail
