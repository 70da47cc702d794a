// This file bounds how far elastics throw an island from where it is.

#include <algorithm>
#include <cmath>
#include <utility>

#include "contact/linkage/linkage_state.hpp"
#include "contact/solved/cluster_limits.hpp"

namespace plumb::detail {
namespace {

/// Returns the number of an elastic and how it changes. Most are distances, whose root both share.
std::pair<double, ElasticSlope> number_and_slope(const LinkageState& state, std::size_t i) {
  const Linkage& linkage = *state.linkage;
  const Elastic& elastic = linkage.elastics()[i];
  if (elastic.kind != Elastic::Kind::distance)
    return {linkage.number(elastic, state.x, state.elastic_numbers[i]), linkage.slope(elastic, state.x)};
  const Vec3 apart = elastic.sums[0].of(state.x);
  const double length = norm(apart);
  return {length, {length > 0 ? (1 / length) * apart : Vec3{}}};
}

}  // namespace

/// Finds what elastics pull particles with (N), and what those of each may give (J). Dampers only brake, and
/// what is rigid gives nothing.
double LinkageState::find_elastic_pulls() const {
  double all = 0;
  pulls_.assign(linkage->movable(), Vec3{});
  energies_.assign(linkage->movable(), 0);
  for (std::size_t i = 0; i < laws.size(); ++i) {
    const ElasticLaw& law = laws[i];
    if (std::isinf(law.stiffness) || (law.stiffness == 0 && law.force == 0)) continue;
    const auto [number_now, slope] = number_and_slope(*this, i);
    const double off = number_now - law.rest, pull = law.stiffness * off + law.force;
    if (pull == 0 || (law.one_sided && off <= 0)) continue;
    linkage->push_along(linkage->elastics()[i], slope, -pull, pulls_);
    const double given = 0.5 * pull * pull / law.stiffness;  // That of a constant pull has no bound.
    all += given;
    for (const std::uint32_t k : linkage->elastics()[i].touched) energies_[k] += given;
  }
  return all;
}

/// No constraint lets pulls give more energy to motion than they give to particles alone, nor more than
/// elastics hold, and no place that constraints hold moves by more than all of that lets it.
double LinkageState::throw_by_elastics(double dt) const {
  if (laws.empty() || dt == 0) return 0;
  const double most_held = 2 * dt * dt * find_elastic_pulls();
  double held = 0;  // kg m²
  const auto square_of_throw = [&](std::uint32_t k) {
    const double mass = linkage->mass_of(k), share = 0.5 * dt * dt / mass;
    // They may bear weight, and the box has room for that.
    const Vec3 borne = pulls_[k] + mass * linkage->gravity() + force[k];
    const double pull = std::min(dot(pulls_[k], pulls_[k]), dot(borne, borne));
    return std::min(share * share * pull, 4 * share * energies_[k]);
  };
  for (std::uint32_t k = 0; k < linkage->movable(); ++k) {
    energies_[k] = square_of_throw(k);
    if (linkage->is_held(k)) held += linkage->mass_of(k) * energies_[k];
  }
  held = std::min(held, most_held);
  double most = 0;
  for (const Linkage::Ball& ball : linkage->balls()) {
    double loose = 0, square = 0;
    for (const auto& [k, weight] : ball.center) {
      if (k >= linkage->movable()) continue;
      if (linkage->is_held(k))
        square += weight * weight / linkage->mass_of(k);
      else
        loose += std::abs(weight) * std::sqrt(energies_[k]);
    }
    most = std::max(most, loose + std::sqrt(held * square));
  }
  // Farther throws would only join islands into clusters that cannot be solved.
  return std::min(most, contact_limits::farthest_throw * linkage->size());
}

}  // namespace plumb::detail
