// This file says how hard lines of a crowd hit each other, for bounces and for those who count touches.

#include <algorithm>
#include <cmath>

#include "contact/relaxed/lines/crowd_lines.hpp"
#include "contact/rows.hpp"

namespace plumb::detail {

namespace fields = simd::line_contact_fields;

/// Returns the weights of the ends in the sum that a contact keeps open.
template <class T>
auto CrowdLines<T>::weights(std::size_t lane) const -> std::array<double, ends> {
  const double a = field(lane, fields::a), b = field(lane, fields::b);
  return {1 - a, a, b - 1, -b};
}

template <class T>
template <class Of>
Vec3 CrowdLines<T>::between(std::size_t lane, Of&& of) const {
  const std::array<double, ends> weight = weights(lane);
  Vec3 out{};
  for (std::uint32_t k = 0; k < ends; ++k) out += weight[k] * of(at(lane, k));
  return out;
}

/// Finds how fast contacts are about to hit, and what they leave with.
template <class T>
void CrowdLines<T>::see_blows(const Crowd<T>& crowd, const CrowdPairs<T>& near, double h) {
  blows_.assign(slots_.size(), {});
  for_contacts([&](std::size_t lane) {
    const auto& [one, other] = pairs_[slots_[lane] / places];
    const Surface &a = near.bodies()[one].shape->surface, &b = near.bodies()[other].shape->surface;
    const Vec3 normal = vector(lane, fields::normal);
    const double closing =
        dot(normal, between(lane, [&](std::uint32_t place) { return crowd.moved(place); }));
    const double arriving =
        dot(normal, between(lane, [&](std::uint32_t place) { return crowd.velocity(place); }));
    Blow& blow = blows_[lane];
    blow.approach = relaxed_approach_of(field(lane, fields::gap), closing, arriving, h);
    blow.bounce = bounce_of(std::max(a.restitution, b.restitution), settings_.bounce_speed, blow.approach);
  });
}

template <class T>
double CrowdLines<T>::depth(const Crowd<T>& crowd) const {
  double most = 0;
  for_contacts([&](std::size_t lane) {
    const Vec3 moved = between(lane, [&](std::uint32_t place) { return crowd.moved(place); });
    most = std::max(most, -field(lane, fields::gap) - dot(vector(lane, fields::normal), moved));
  });
  return most;
}

template <class T>
bool CrowdLines<T>::any_bounces() const {
  bool any = false;
  if (sees_blows_)
    for_contacts([&](std::size_t lane) { any = any || (blows_[lane].bounce > 0 && is_pushed(lane)); });
  return any;
}

template <class T>
void CrowdLines<T>::bounce(Crowd<T>& crowd) {
  if (!sees_blows_) return;
  for_contacts([&](std::size_t lane) {
    Blow& blow = blows_[lane];
    if (!(blow.bounce > 0 && is_pushed(lane))) return;
    const auto& [one, other] = pairs_[slots_[lane] / places];
    const Vec3 normal = vector(lane, fields::normal);
    const std::array<double, ends> weight = weights(lane);
    std::array<double, ends> move;
    double moves = 0;
    for (std::uint32_t k = 0; k < ends; ++k) {
      move[k] = weight[k] * lines_[k < 2 ? one : other].over_mass[k % 2];
      moves += weight[k] * move[k];
    }
    const double leaves =
        dot(normal, between(lane, [&](std::uint32_t place) { return crowd.velocity(place); }));
    const double kick = std::max(0.0, blow.kick + (blow.bounce - leaves) / moves);
    for (std::uint32_t k = 0; k < ends; ++k)
      crowd.push_velocity(at(lane, k), move[k] * (kick - blow.kick) * normal);
    blow.kick = kick;
  });
}

/// Adds what a contact did to its pair. It acts half way between surfaces where the substep ends.
template <class T>
void CrowdLines<T>::count_push(std::span<LinkageState* const> cluster, const Crowd<T>& crowd,
                               const CrowdPairs<T>& near, std::size_t lane, double h) const {
  const auto& [one, other] = pairs_[slots_[lane] / places];
  const auto &a = near.bodies()[one], &b = near.bodies()[other];
  const Vec3 normal = vector(lane, fields::normal);
  const Vec3 impulse = 1 / h * vector(lane, fields::push) + blows_[lane].kick * normal;
  LinkagePulls &own = cluster[a.island]->pulls, &of_other = cluster[b.island]->pulls;
  if (own.counts) own.shapes[a.number] += impulse;
  if (of_other.counts) of_other.shapes[b.number] -= impulse;
  const std::array<double, ends> weight = weights(lane);
  Vec3 middles{};
  for (std::uint32_t k = 0; k < ends; ++k) middles += std::abs(weight[k]) * crowd.position(at(lane, k));
  const Vec3 place = crowd.origin() + 0.5 * (middles - (a.radius - b.radius) * normal);
  own.touched.add(a.number, cluster[b.island]->number, b.number,
                  {impulse, place, normal, blows_[lane].approach});
}

template auto CrowdLines<float>::weights(std::size_t) const -> std::array<double, ends>;
template void CrowdLines<float>::see_blows(const Crowd<float>&, const CrowdPairs<float>&, double);
template double CrowdLines<float>::depth(const Crowd<float>&) const;
template bool CrowdLines<float>::any_bounces() const;
template void CrowdLines<float>::bounce(Crowd<float>&);
template void CrowdLines<float>::count_push(std::span<LinkageState* const>, const Crowd<float>&,
                                            const CrowdPairs<float>&, std::size_t, double) const;
template auto CrowdLines<double>::weights(std::size_t) const -> std::array<double, ends>;
template void CrowdLines<double>::see_blows(const Crowd<double>&, const CrowdPairs<double>&, double);
template double CrowdLines<double>::depth(const Crowd<double>&) const;
template bool CrowdLines<double>::any_bounces() const;
template void CrowdLines<double>::bounce(Crowd<double>&);
template void CrowdLines<double>::count_push(std::span<LinkageState* const>, const Crowd<double>&,
                                             const CrowdPairs<double>&, std::size_t, double) const;

}  // namespace plumb::detail
