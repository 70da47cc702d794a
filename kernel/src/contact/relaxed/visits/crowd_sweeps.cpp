// This file visits the contacts of a crowd, alone or with a team.

#include <algorithm>
#include <cmath>
#include <numeric>

#include "contact/relaxed/blows/rigid_velocities.hpp"
#include "contact/relaxed/crowd_contacts.hpp"

namespace plumb::detail {

/// Adds a contact of a rigid body. Returns its number, or none if it has none that moves freely.
template <class T>
std::uint32_t CrowdContacts<T>::add_rigid(const Crowd<T>& crowd, const Batch& batch, const Contact& contact) {
  const std::span<const Term> terms = batch.terms_of(contact.terms);
  const std::size_t own = contact.other_terms - contact.terms.first;
  std::array<typename RigidContacts<T>::Side, 2> sides;
  for (std::size_t i = 0; i < 2; ++i) {
    if (contact.island[i] == none) continue;
    sides[i] = {contact.island[i], body_under(near_, contact.island[i], contact.shape[i]),
                i == 0 ? terms.first(own) : terms.subspan(own)};
  }
  return rigid_.add(crowd, sides, contact.normal);
}

/// Sorts contacts into vectors. Those of rigid bodies, those whose friction acts elsewhere than their normal
/// push, and those that resist turning stay alone. Rigid bodies are visited from the last contact to the
/// first, so that what a sweep leaves is not in the ground, which comes first.
template <class T>
void CrowdContacts<T>::lay_out(const Crowd<T>& crowd) {
  alone_.clear();
  heap_ends_.clear();
  rigid_.clear();
  rigid_places_.clear();
  is_revisited_ = false;
  vectors_.begin(crowd);
  for (std::uint32_t b = 0; b < batches_.size(); ++b)
    for (std::uint32_t k = 0; k < batches_[b].contacts.size(); ++k) {
      Contact& contact = batches_[b].contacts[k];
      const Rare& rare = batches_[b].rare_of(contact);
      const bool is_plain = !rare.slides_apart && rare.turning == none;
      contact.rigid = is_plain ? add_rigid(crowd, batches_[b], contact) : none;
      contact.in_vectors =
          is_plain && contact.rigid == none && vectors_.color(crowd, batches_[b].terms_of(contact.terms));
      if (contact.rigid != none)
        rigid_places_.push_back({b, k});
      else if (!contact.in_vectors)
        alone_.push_back({b, k});
    }
  alone_.insert(alone_.end(), rigid_places_.rbegin(), rigid_places_.rend());
  vectors_.reserve(crowd);
  for_contacts([&](Batch& batch, Contact& contact) {
    if (contact.in_vectors)
      vectors_.put(crowd,
                   {batch.terms_of(contact.terms), contact.normal, batch.rare_of(contact).carried,
                    contact.gap, contact.over, contact.friction},
                   {&contact.push, &contact.across});
  });
}

/// Calls visit(batch, contact, heap) for all contacts that are not in vectors. Heaps are visited by several
/// threads if there is a team.
template <class T>
template <class Visit>
void CrowdContacts<T>::for_heaps(Crowd<T>& crowd, Team* team, Visit&& visit) {
  changes_.assign(1, 0);
  if (alone_.empty()) return;
  if (team == nullptr) {
    for (const Place& place : alone_)
      visit(batches_[place.batch], batches_[place.batch].contacts[place.number], changes_[0]);
    return;
  }
  if (heap_ends_.empty()) find_heaps(crowd.islands());
  const auto heaps = static_cast<std::uint32_t>(heap_ends_.size());
  changes_.assign(heaps, 0);
  team->for_each(heaps, [&](std::uint32_t heap, unsigned) {
    for (std::uint32_t k = heap == 0 ? 0 : heap_ends_[heap - 1]; k < heap_ends_[heap]; ++k) {
      Batch& batch = batches_[in_heaps_[k].batch];
      visit(batch, batch.contacts[in_heaps_[k].number], changes_[heap]);
    }
  });
}

// What ground holds comes first in a sweep, and lines that lie on it after that: heaps on triangles come to
// rest in half the time that they take the other way round.
template <class T>
void CrowdContacts<T>::sweep(Crowd<T>& crowd, Team* team) {
  ends_.sweep(crowd);
  vectors_.sweep(crowd, team);
  lines_.sweep(crowd, team);
  for_heaps(crowd, team, [&](Batch& batch, Contact& contact, double&) { visit(crowd, batch, contact); });
}

template <class T>
bool CrowdContacts<T>::list_swept(Array<SweptNumbers<T>>& to) {
  to.insert(to.end(), {ends_.swept(), vectors_.swept(), lines_.swept()});
  return alone_.empty();
}

template <class T>
double CrowdContacts<T>::measured_sweep(Crowd<T>& crowd, Team* team) {
  // One after the other: compilers differ in which argument of a call they evaluate first.
  const double of_ends = ends_.measured_sweep(crowd);
  const double of_vectors = vectors_.measured_sweep(crowd, team);
  const double before = std::max({of_ends, of_vectors, lines_.measured_sweep(crowd, team)});
  for_heaps(crowd, team, [&](Batch& batch, Contact& contact, double& most) {
    const Change change = visit(crowd, batch, contact);
    if (!change.is_none()) most = std::max(most, size_of(change, batch, contact));
  });
  return std::max(before, *std::max_element(changes_.begin(), changes_.end()));
}

/// Returns how far (m) a change moves places.
template <class T>
double CrowdContacts<T>::size_of(const Change& change, const Batch& batch, const Contact& contact) {
  const Rare& rare = batch.rare_of(contact);
  if (!rare.slides_apart) return norm(change.along + change.across) / contact.over;
  return std::max(norm(change.along) / contact.over, norm(change.across) / rare.over_sliding);
}

/// Sorts contacts that are not in vectors by heaps. Those of a heap stay in their order, so that the bits are
/// those of one thread.
template <class T>
void CrowdContacts<T>::find_heaps(std::size_t islands) {
  const auto contact_at = [&](const Place& place) -> const Contact& {
    return batches_[place.batch].contacts[place.number];
  };
  heap_of_.resize(islands);
  std::iota(heap_of_.begin(), heap_of_.end(), 0u);
  for (const Place& place : alone_) {
    const Contact& contact = contact_at(place);
    if (contact.island[1] == none) continue;
    const std::uint32_t a = heap_of(contact.island[0]), b = heap_of(contact.island[1]);
    heap_of_[std::max(a, b)] = std::min(a, b);
  }
  heap_number_.assign(islands, none);
  heap_ends_.clear();
  for (const Place& place : alone_) {
    std::uint32_t& number = heap_number_[heap_of(contact_at(place).island[0])];
    if (number == none) {
      number = static_cast<std::uint32_t>(heap_ends_.size());
      heap_ends_.push_back(0);
    }
    ++heap_ends_[number];
  }
  // Ends are starts until contacts are put there.
  std::exclusive_scan(heap_ends_.begin(), heap_ends_.end(), heap_ends_.begin(), 0u);
  in_heaps_.resize(alone_.size());
  for (const Place& place : alone_)
    in_heaps_[heap_ends_[heap_number_[heap_of(contact_at(place).island[0])]]++] = place;
}

template <class T>
std::uint32_t CrowdContacts<T>::heap_of(std::uint32_t island) {
  while (heap_of_[island] != island) island = heap_of_[island] = heap_of_[heap_of_[island]];
  return island;
}

/// Sets the pushes of a contact to what its places ask for. Returns what changes.
template <class T>
auto CrowdContacts<T>::visit(Crowd<T>& crowd, Batch& batch, Contact& contact) -> Change {
  const std::span<const Term> terms = batch.terms_of(contact.terms), sliding = batch.sliding_of(contact);
  const Rare& rare = batch.rare_of(contact);
  if (contact.rigid != none) {
    const double before = contact.push;
    const Vec3 across_before = contact.across;
    rigid_.visit(crowd,
                 {contact.rigid, terms, contact.other_terms - contact.terms.first, contact.normal,
                  rare.carried, contact.gap, contact.friction},
                 contact.push, contact.across);
    return {(contact.push - before) * contact.normal, contact.across - across_before};
  }
  const bool is_one = !rare.slides_apart;
  const Vec3 moved = crowd.moved(terms) - rare.carried;
  const double along = dot(contact.normal, moved);
  const double push = std::max(0.0, contact.push - contact.over * (contact.gap + along));
  const Vec3 slid = is_one ? moved : crowd.moved(sliding) - rare.carried;
  const double over_sliding = is_one ? contact.over : rare.over_sliding;
  Vec3 across = contact.across - over_sliding * (slid - dot(contact.normal, slid) * contact.normal);
  // What the normal push turned by since it was kept would pull along the normal.
  across = across - dot(across, contact.normal) * contact.normal;
  const double bound = contact.friction * push, square = dot(across, across);
  if (square > bound * bound) across = bound / std::sqrt(square) * across;
  const Change by{(push - contact.push) * contact.normal, across - contact.across};
  contact.push = push;
  contact.across = across;
  if (rare.turning != none) resist(crowd, batch, contact);
  if (by.is_none()) return by;
  if (is_one) {
    crowd.push(terms, by.along + by.across);
  } else {
    crowd.push(terms, by.along);
    crowd.push(sliding, by.across);
  }
  return by;
}

/// Turns the particles of bodies as a torque (kg m²) does.
template <class T>
void CrowdContacts<T>::turn(Crowd<T>& crowd, const Batch& batch, const Turning& turning, Vec3 by) const {
  for (std::uint32_t k = turning.first; k < turning.end; ++k) {
    const TurnTerm& term = batch.turn_terms[k];
    crowd.push(term.at, 0.5 * term.inverse_mass * cross(by, term.gradient));
  }
}

/// Sets the torque that resists turning, within what the normal push allows.
template <class T>
void CrowdContacts<T>::resist(Crowd<T>& crowd, Batch& batch, const Contact& contact) {
  Turning& turning = batch.turnings[batch.rare_of(contact).turning];
  Vec3 turned = -1.0 * turning.carried;
  for (std::uint32_t k = turning.first; k < turning.end; ++k)
    turned += 0.5 * cross(batch.turn_terms[k].gradient, crowd.moved(batch.turn_terms[k].at));
  const Vec3 wanted = turning.push - turning.over * turned;
  const double most_spinning = turning.spinning * contact.push, most_rolling = turning.rolling * contact.push;
  const double spinning = dot(wanted, contact.normal);
  Vec3 rolling = wanted - spinning * contact.normal;
  const double square = dot(rolling, rolling);
  if (square > most_rolling * most_rolling) rolling = most_rolling / std::sqrt(square) * rolling;
  const Vec3 push = rolling + std::clamp(spinning, -most_spinning, most_spinning) * contact.normal;
  turn(crowd, batch, turning, push - turning.push);
  turning.push = push;
}

/// Returns how deep (m) a contact goes into what it should stay out of.
template <class T>
double CrowdContacts<T>::depth(const Crowd<T>& crowd, const Batch& batch, const Contact& contact) const {
  const Vec3 moved = crowd.moved(batch.terms_of(contact.terms)) - batch.rare_of(contact).carried;
  return -contact.gap - dot(contact.normal, moved);
}

template <class T>
double CrowdContacts<T>::depth(const Crowd<T>& crowd) const {
  double most = std::max(ends_.depth(crowd), lines_.depth(crowd));
  for_contacts([&](const Batch& batch, const Contact& contact) {
    most = std::max(most, depth(crowd, batch, contact));
  });
  return most;
}

template <class T>
bool CrowdContacts<T>::leave_ground(Crowd<T>& crowd) {
  // A substep takes a tenth of an overlap back, so that what is pressed on and on stays half out of ground.
  constexpr double harmless = 0.05;
  constexpr int rounds = 4;
  if (!hold_islands()) return false;
  const auto is_deep = [&](const Batch& batch, const Contact& contact, double share, double least) {
    return contact.island[1] == none && depth(crowd, batch, contact) > std::max(least, share * contact.width);
  };
  bool any = true;
  for (int i = 0; i < rounds && any; ++i) {
    any = ends_.sweep_deep(crowd, harmless, settings_.tolerance);
    for_contacts([&](Batch& batch, Contact& contact) {
      if (!is_deep(batch, contact, harmless, settings_.tolerance)) return;
      visit(crowd, batch, contact);
      any = is_revisited_ = true;
    });
  }
  if (!any) return false;
  bool is_below = ends_.any_deep(crowd, 1, settings_.margin);
  for_contacts([&](const Batch& batch, const Contact& contact) {
    is_below = is_below || is_deep(batch, contact, 1, settings_.margin);
  });
  return is_below;
}

template <class T>
bool CrowdContacts<T>::bounce(Crowd<T>& crowd) {
  constexpr int sweeps = 4, sweeps_of_bodies = 20;
  const auto for_bounces = [&](auto&& f) {
    for (Batch& batch : batches_) {
      if (batch.rares.empty()) continue;
      for (const Contact& contact : batch.contacts)
        if (batch.rare_of(contact).bounce > 0 && contact.push > 0)
          f(batch, contact, batch.rares[contact.rare]);
    }
  };
  bool any = ends_.any_bounces() || lines_.any_bounces();
  bool any_body = false;
  for_bounces([&](const Batch&, const Contact& contact, const Rare&) {
    any = true;
    for (std::size_t k = 0; k < 2 && contact.island[k] != none; ++k)
      any_body = any_body || body_under(near_, contact.island[k], contact.shape[k]) != nullptr;
  });
  for (int i = 0; any && i < (any_body ? sweeps_of_bodies : sweeps); ++i) {
    ends_.bounce(crowd);
    lines_.bounce(crowd);
    for_bounces([&](const Batch& batch, const Contact& contact, Rare& rare) {
      const std::span<const Term> terms = batch.terms_of(contact.terms);
      const double leaves = dot(contact.normal, crowd.velocity(terms)) - rare.carried_at_end;
      const double kick = std::max(0.0, rare.kick + contact.over * (rare.bounce - leaves));
      crowd.push_velocity(terms, (kick - rare.kick) * contact.normal);
      rare.kick = kick;
      for (std::size_t k = 0; k < 2 && contact.island[k] != none; ++k)
        if (const auto* const body = body_under(near_, contact.island[k], contact.shape[k]))
          make_rigid(crowd, contact.island[k], *body);
    });
  }
  return any;
}

template void CrowdContacts<float>::lay_out(const Crowd<float>&);
template void CrowdContacts<float>::sweep(Crowd<float>&, Team*);
template bool CrowdContacts<float>::list_swept(Array<SweptNumbers<float>>&);
template double CrowdContacts<float>::measured_sweep(Crowd<float>&, Team*);
template void CrowdContacts<float>::turn(Crowd<float>&, const Batch&, const Turning&, Vec3) const;
template double CrowdContacts<float>::depth(const Crowd<float>&) const;
template bool CrowdContacts<float>::leave_ground(Crowd<float>&);
template bool CrowdContacts<float>::bounce(Crowd<float>&);
template void CrowdContacts<double>::lay_out(const Crowd<double>&);
template void CrowdContacts<double>::sweep(Crowd<double>&, Team*);
template bool CrowdContacts<double>::list_swept(Array<SweptNumbers<double>>&);
template double CrowdContacts<double>::measured_sweep(Crowd<double>&, Team*);
template void CrowdContacts<double>::turn(Crowd<double>&, const Batch&, const Turning&, Vec3) const;
template double CrowdContacts<double>::depth(const Crowd<double>&) const;
template bool CrowdContacts<double>::leave_ground(Crowd<double>&);
template bool CrowdContacts<double>::bounce(Crowd<double>&);

}  // namespace plumb::detail
