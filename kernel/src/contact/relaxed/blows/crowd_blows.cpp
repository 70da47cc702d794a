#include "contact/relaxed/blows/crowd_blows.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "interface/changes.hpp"

namespace plumb::detail {

template <class T>
bool CrowdBlows<T>::jumps(const LinkageState& state) {
  const auto anchors = std::span(state.v).subspan(state.linkage->movable());
  for (std::size_t i = 0; i < anchors.size(); ++i)
    if (velocity_changes(state.anchors_went[i], anchors[i])) return true;
  return state.lengths.jump();
}

template <class T>
bool CrowdBlows<T>::give(std::span<LinkageState* const> cluster, Crowd<T>& crowd, CrowdJoints<T>& joints,
                         const CrowdRules& rules) {
  is_struck_.assign(cluster.size(), 0);
  bool any = false;
  for (std::uint32_t i = 0; i < cluster.size(); ++i) {
    if (!crowd.is_moving(i) || !jumps(*cluster[i])) continue;
    is_struck_[i] = 1;
    any = true;
  }
  if (!any) return false;
  find_rods(cluster, crowd, rules);
  // What is left is compared with the blow itself, so that a rod alone takes two sweeps and not all.
  double first = 0;
  for (std::uint32_t i = 0; i < rules.stop.sweeps; ++i) {
    const double most = std::max(sweep(crowd), joints.sweep_velocities(cluster, is_struck_, crowd));
    if (i == 0) first = most;
    if (!(most > 4 * std::numeric_limits<T>::epsilon() * first)) break;
  }
  count_pulls(cluster, crowd);
  for (std::uint32_t i = 0; i < cluster.size(); ++i)
    if (is_struck_[i] != 0) cluster[i]->keep_given();
  return true;
}

template <class T>
void CrowdBlows<T>::find_rods(std::span<LinkageState* const> cluster, const Crowd<T>& crowd,
                              const CrowdRules& rules) {
  rods_.clear();
  const CrowdPlaces& places = crowd.places();
  for (std::uint32_t lane = 0; lane < places.rods().size(); ++lane) {
    const CrowdPlaces::Rod& rod = places.rods()[lane];
    if (rod.island == CrowdPlaces::none || is_struck_[rod.island] == 0) continue;
    const std::uint32_t first = places.first(rod.island);
    const double wa = crowd.inverse_mass(rod.island, rod.a - first),
                 wb = crowd.inverse_mass(rod.island, rod.b - first);
    const Vec3 apart = crowd.position(places.at(rod.a)) - crowd.position(places.at(rod.b));
    const double length = norm(apart);
    if (!(wa + wb > 0) || !(length > 0)) continue;
    const bool by_mass = rules.weights == Weights::mass;
    const double share_a = by_mass ? wa : (wa > 0 ? 1 : 0), share_b = by_mass ? wb : (wb > 0 ? 1 : 0);
    const double over = 1 / (share_a + share_b);
    const RodLengths::Change* const change = cluster[rod.island]->lengths.find(rod.number);
    rods_.push_back(
        {lane, 1 / length * apart, change ? change->rate : 0, over * share_a, over * share_b, 1 / (wa + wb)});
  }
}

/// Returns the largest change of a relative speed, m/s.
template <class T>
double CrowdBlows<T>::sweep(Crowd<T>& crowd) {
  double most = 0;
  const CrowdPlaces& places = crowd.places();
  for (Rod& rod : rods_) {
    const std::uint32_t a = places.at(places.rods()[rod.lane].a), b = places.at(places.rods()[rod.lane].b);
    const double by = rod.rate - dot(rod.along, crowd.velocity(a) - crowd.velocity(b));
    if (rod.share_a > 0) crowd.push_velocity(a, by * rod.share_a * rod.along);
    if (rod.share_b > 0) crowd.push_velocity(b, -by * rod.share_b * rod.along);
    rod.impulse -= by * rod.mass;
    most = std::max(most, std::abs(by));
  }
  return most;
}

template <class T>
void CrowdBlows<T>::count_pulls(std::span<LinkageState* const> cluster, const Crowd<T>& crowd) const {
  for (std::uint32_t i = 0; i < cluster.size(); ++i)
    if (is_struck_[i] != 0 && cluster[i]->pulls.counts)
      cluster[i]->lengths.begin_pulls(cluster[i]->pulls.rods);
  const CrowdPlaces& places = crowd.places();
  for (const Rod& each : rods_) {
    const CrowdPlaces::Rod& rod = places.rods()[each.lane];
    LinkagePulls& pulls = cluster[rod.island]->pulls;
    if (!pulls.counts) continue;
    pulls.rods[rod.number] += each.impulse;
    const std::uint32_t fixed = places.first(rod.island) + cluster[rod.island]->linkage->movable();
    if (rod.a >= fixed) pulls.fixed[rod.a - fixed] -= each.impulse * each.along;
    if (rod.b >= fixed) pulls.fixed[rod.b - fixed] += each.impulse * each.along;
  }
  for (std::uint32_t i = 0; i < cluster.size(); ++i)
    if (is_struck_[i] != 0 && cluster[i]->pulls.counts) cluster[i]->lengths.end_pulls(cluster[i]->pulls.rods);
}

template class CrowdBlows<float>;
template class CrowdBlows<double>;

}  // namespace plumb::detail
