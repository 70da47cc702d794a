#include "truth/integrators/bent_series.hpp"

#include <cmath>

namespace plumb::truth {
namespace {

/// Returns the sum of a_j b_{k-j} for j from `first` to k.
Real product(const Series& a, const Series& b, std::size_t k, std::size_t first = 0) {
  Real sum = 0;
  for (std::size_t j = first; j <= k; ++j) sum += a[j] * b[k - j];
  return sum;
}
Real product(const PointSeries& a, const PointSeries& b, std::size_t k) {
  return product(a.x, b.x, k) + product(a.y, b.y, k) + product(a.z, b.z, k);
}

PointSeries points(std::size_t powers) {
  return {Series(powers), Series(powers), Series(powers)};
}

}  // namespace

BentSeries::BentSeries(const Model& model, std::size_t powers) : model_(model) {
  const Series none(powers);
  for (std::size_t i = 0; i < model.bends.size(); ++i)
    bends_.push_back({points(powers), none, none, none, none, none, none});
  for (const ModelTwist& twist : model.twists) {
    Chain& chain = chains_.emplace_back(Chain{twist.stiffness, {}, none});
    const auto& particles = twist.particles;
    const std::size_t rods = twist.lengths.size();
    const bool is_ring = particles.front() == particles.back();
    for (std::size_t r = 0; r + 1 < rods || (is_ring && r < rods); ++r) {
      const std::size_t next = (r + 1) % rods;
      chain.joints.push_back({particles[r], particles[r + 1], particles[next + 1], twist.lengths[r],
                              twist.lengths[next], points(powers), points(powers), points(powers), none});
    }
  }
}

Point BentSeries::expand_bend(std::size_t k, const ModelBend& bend, BendTerms& terms) const {
  auto& [w, q, a, slope, kappa, share, factor] = terms;
  q[k] = product(w, w, k);
  a[k] = ((k == 0 ? 1 : 0) + product(q, a, k, 1) / 4) / (1 - q[0] / 4);
  slope[k] = product(a, a, k);
  factor[k] = slope[k];
  if (bend.rest > 0) {
    const Real square = product(q, a, k);
    kappa[k] = 0;
    kappa[k] = k == 0 ? std::sqrt(square) : (square - product(kappa, kappa, k)) / (2 * kappa[0]);
    share[k] = ((k == 0 ? bend.rest : 0) - product(kappa, share, k, 1)) / kappa[0];
    factor[k] -= product(slope, share, k);
  }
  return bend.stiffness * Point{product(factor, w.x, k), product(factor, w.y, k), product(factor, w.z, k)};
}

void BentSeries::expand_joint(std::size_t k, Joint& joint) {
  const auto& [a, b, c, first, second, d1, d2, across, inverse] = joint;
  // The sum m has the coefficients of d1.d2, and L1 L2 at the first.
  Real sum = k == 0 ? 1 : 0;
  for (std::size_t j = 1; j <= k; ++j) sum -= product(d1, d2, j) * inverse[k - j];
  joint.inverse[k] = sum / (first * second + product(d1, d2, 0));
  Point out;
  for (std::size_t j = 0; j <= k; ++j) {
    const Point normal{product(d1.y, d2.z, j) - product(d1.z, d2.y, j),
                       product(d1.z, d2.x, j) - product(d1.x, d2.z, j),
                       product(d1.x, d2.y, j) - product(d1.y, d2.x, j)};
    out += inverse[k - j] * normal;
  }
  set(joint.across, k, out);
}

Real BentSeries::twist_at(std::size_t twist, Real t) const {
  const Series& series = chains_[twist].twisted;
  Real sum = 0;
  for (std::size_t k = series.size() - 1; k-- > 0;) sum = sum * t + series[k];
  return sum;
}

}  // namespace plumb::truth
