#pragma once

#include <cstdint>
#include <vector>

#include "truth/model.hpp"

namespace plumb::truth {

/// Numbers have these coefficients, one for every power of t.
using Series = std::vector<Real>;
struct PointSeries {
  Series x, y, z;
};

/// The forces of bends and twists are power series in time, as TaylorSeries has them of positions. Every
/// coefficient follows from those of products and of a quotient: of a = 1/m from a m = 1, for example.
class BentSeries {
 public:
  /// Makes room for so many powers. The model must outlive the series.
  BentSeries(const Model& model, std::size_t powers);

  /// Finds coefficient k of all forces (N) and adds it to `f`. Positions have theirs up to k + 1, in m, by
  /// particle and power; the twist (rad) gets its own up to there. `start` has that at t = 0.
  template <class Position>
  void add_forces(std::size_t k, Position&& position, const State& start, std::vector<Point>& f);

  /// Returns how far a chain is twisted at t, in rad.
  Real twist_at(std::size_t twist, Real t) const;

 private:
  /// With P = stiffness g'(q) (1 - rest/kappa) w, a bend pulls its particles by -dw/dx P. g' is the square of
  /// a = 1/(1 - q/4), and kappa² = q a.
  struct BendTerms {
    PointSeries w;
    Series q, a, slope, kappa, share, factor;
  };
  /// With c = d1 x d2 and m = L1 L2 + d1.d2 the twist grows by c/m . (d1'/L1 + d2'/L2). Its torque pulls d1
  /// by -c/(m L1) and d2 by -c/(m L2).
  struct Joint {
    std::uint32_t a, b, c;
    Real first, second;
    PointSeries d1, d2, across;
    Series inverse;
  };
  struct Chain {
    Real stiffness;
    std::vector<Joint> joints;
    Series twisted;
  };

  Point expand_bend(std::size_t k, const ModelBend& bend, BendTerms& terms) const;
  static void expand_joint(std::size_t k, Joint& joint);

  const Model& model_;
  std::vector<BendTerms> bends_;
  std::vector<Chain> chains_;
};

/// Sets coefficient k.
inline void set(PointSeries& series, std::size_t k, const Point& value) {
  series.x[k] = value.x, series.y[k] = value.y, series.z[k] = value.z;
}
inline Point at(const PointSeries& series, std::size_t k) {
  return {series.x[k], series.y[k], series.z[k]};
}

template <class Position>
void BentSeries::add_forces(std::size_t k, Position&& position, const State& start, std::vector<Point>& f) {
  for (std::size_t i = 0; i < bends_.size(); ++i) {
    const auto& [a, b, c, first, second, stiffness, rest] = model_.bends[i];
    set(bends_[i].w, k,
        (1 / first) * (position(b, k) - position(a, k)) - (1 / second) * (position(c, k) - position(b, k)));
    const Point pull = expand_bend(k, model_.bends[i], bends_[i]);
    f[a] += (1 / first) * pull;
    f[b] -= (1 / first + 1 / second) * pull;
    f[c] += (1 / second) * pull;
  }
  for (std::size_t i = 0; i < chains_.size(); ++i) {
    Chain& chain = chains_[i];
    if (k == 0) chain.twisted[0] = start.twisted[i];
    Real growth = 0;
    for (Joint& joint : chain.joints) {
      for (const std::size_t power : {k, k + 1}) {
        set(joint.d1, power, position(joint.b, power) - position(joint.a, power));
        set(joint.d2, power, position(joint.c, power) - position(joint.b, power));
      }
      expand_joint(k, joint);
      Point force;
      for (std::size_t j = 0; j <= k; ++j) {
        const Real rate = static_cast<Real>(k - j + 1);
        growth += rate * dot(at(joint.across, j), (1 / joint.first) * at(joint.d1, k - j + 1) +
                                                      (1 / joint.second) * at(joint.d2, k - j + 1));
        force -= chain.stiffness * chain.twisted[k - j] * at(joint.across, j);
      }
      f[joint.a] -= (1 / joint.first) * force;
      f[joint.b] += (1 / joint.first - 1 / joint.second) * force;
      f[joint.c] += (1 / joint.second) * force;
    }
    chain.twisted[k + 1] = growth / static_cast<Real>(k + 1);
  }
}

}  // namespace plumb::truth
