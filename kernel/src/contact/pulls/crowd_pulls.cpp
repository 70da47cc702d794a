// This file adds up what a crowd's contacts push with.

#include "contact/relaxed/crowd_contacts.hpp"

namespace plumb::detail {

/// Adds the impulses of a contact to what pushed its shapes and the fixed particles of its islands.
template <class T>
void CrowdContacts<T>::count_impulses(std::span<LinkageState* const> cluster, const Crowd<T>& crowd,
                                      const Batch& batch, const Contact& contact, double h) const {
  const Rare& rare = batch.rare_of(contact);
  const Vec3 across = 1 / h * contact.across;
  const Vec3 along = (1 / h * contact.push + rare.kick) * contact.normal;
  for (int side = 0; side < 2; ++side) {
    const std::uint32_t island = contact.island[side];
    if (island == none) continue;
    LinkagePulls& pulls = cluster[island]->pulls;
    if (!pulls.counts || cluster[island]->asleep) continue;
    pulls.shapes[contact.shape[side]] += (side == 0 ? 1.0 : -1.0) * (along + across);
    if (side == 1 && island == contact.island[0]) continue;
    crowd.push_fixed(batch.terms_of(contact.terms), island, along, pulls);
    crowd.push_fixed(batch.sliding_of(contact), island, across, pulls);
    if (rare.turning == none) continue;
    const Turning& turning = batch.turnings[rare.turning];
    for (std::uint32_t k = turning.first; k < turning.end; ++k) {
      const TurnTerm& term = batch.turn_terms[k];
      const Term whole{term.at, 1, 0};
      if (term.island == island)
        crowd.push_fixed({&whole, 1}, island, 0.5 / h * cross(turning.push, term.gradient), pulls);
    }
  }
}

/// Adds what a contact did to its pair. It acts half way between surfaces where the substep ends. A sleeper
/// that holds what lies on it keeps what it touched before it slept, and the other one counts.
template <class T>
void CrowdContacts<T>::count_touch(std::span<LinkageState* const> cluster, const Crowd<T>& crowd,
                                   const Batch& batch, const Contact& contact, double h) const {
  const auto is_awake = [&](int side) {
    return contact.island[side] != none && !cluster[contact.island[side]]->asleep;
  };
  const int own = is_awake(0) ? 0 : 1, other = 1 - own;
  if (!is_awake(own)) return;
  const auto surface = [&](int side) {
    const std::span<const Term> all = batch.terms_of(contact.terms);
    const std::size_t first = contact.other_terms - contact.terms.first;
    const double sign = side == 0 ? 1 : -1;
    const double radius = cluster[contact.island[side]]->linkage->shape_of(contact.shape[side]).radius;
    const Vec3 middle = sign * crowd.position(side == 0 ? all.first(first) : all.subspan(first));
    return crowd.origin() + middle - sign * radius * contact.normal;
  };
  const bool on_ground = contact.island[1] == none;
  const Vec3 place = on_ground ? surface(0) : 0.5 * (surface(0) + surface(1));
  const double sign = own == 0 ? 1 : -1;
  const Rare& rare = batch.rare_of(contact);
  const Vec3 impulse = (contact.push / h + rare.kick) * contact.normal + 1 / h * contact.across;
  cluster[contact.island[own]]->pulls.touched.add(
      contact.shape[own], on_ground ? TouchedPair::ground : cluster[contact.island[other]]->number,
      contact.shape[other], {sign * impulse, place, sign * contact.normal, rare.approach});
}

template void CrowdContacts<float>::count_impulses(std::span<LinkageState* const>, const Crowd<float>&,
                                                   const Batch&, const Contact&, double) const;
template void CrowdContacts<float>::count_touch(std::span<LinkageState* const>, const Crowd<float>&,
                                                const Batch&, const Contact&, double) const;
template void CrowdContacts<double>::count_impulses(std::span<LinkageState* const>, const Crowd<double>&,
                                                    const Batch&, const Contact&, double) const;
template void CrowdContacts<double>::count_touch(std::span<LinkageState* const>, const Crowd<double>&,
                                                 const Batch&, const Contact&, double) const;

}  // namespace plumb::detail
