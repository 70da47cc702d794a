#include "contact/relaxed/visits/contact_vectors.hpp"

#include <algorithm>
#include <bit>

#include "contact/relaxed/visits/share_ranges.hpp"

namespace plumb::detail {

namespace fields = simd::contact_fields;

template <class T>
void ContactVectors<T>::begin(const Crowd<T>& crowd) {
  // Nothing was taken where nothing got a colour.
  if (!color_.empty() || taken_.size() != crowd.places().particles())
    taken_.assign(crowd.places().particles(), 0);
  color_.clear();
  next_.fill(0);
  put_ = 0;
}

template <class T>
bool ContactVectors<T>::color(const Crowd<T>& crowd, std::span<const Term> terms) {
  std::array<std::uint64_t*, most_terms> masks;
  std::uint64_t taken = 0;
  std::uint32_t count = 0;
  for (std::size_t k = 0; k < terms.size(); ++k) {
    if (terms[k].move == 0) continue;
    if (count == most_terms) return false;
    for (std::size_t other = 0; other < k; ++other)
      if (terms[other].at == terms[k].at) return false;
    masks[count] = &taken_[crowd.places().particle_at(terms[k].at)];
    taken |= *masks[count++];
  }
  if (count == 0 || taken == ~std::uint64_t{0}) return false;
  const int color = std::countr_one(taken);
  for (std::uint32_t k = 0; k < count; ++k) *masks[k] |= std::uint64_t{1} << color;
  const auto number = static_cast<std::uint8_t>(classes * color + (count > 2));
  color_.push_back(number);
  ++next_[number];
  return true;
}

template <class T>
void ContactVectors<T>::reserve(const Crowd<T>& crowd) {
  ranges_.clear();
  std::uint32_t vectors = 0;
  for (std::uint32_t i = 0; i < next_.size(); ++i) {
    if (next_[i] == 0) continue;
    const std::uint32_t begin = vectors;
    vectors += (next_[i] + lanes - 1) / lanes;
    ranges_.push_back({begin, vectors, i % classes == 0 ? 2 : most_terms});
    next_[i] = begin * lanes;
  }
  const std::size_t size = std::size_t{vectors} * lanes;
  if (fields_.size() < size * fields::count) {
    const std::size_t room = size + size / 4;  // as contacts come one after the other
    fields_ = layouts::AlignedBuffer<T>(room * fields::count);
    at_.reserve(room * most_terms);
    pushes_.reserve(room);
  }
  at_.resize(size * most_terms);
  pushes_.resize(size);
  // Lanes that get no contact are in the last vectors of ranges. The others are written as a whole.
  for (const simd::ContactRange& range : ranges_) clear(crowd, range.end - 1);
}

/// Leaves a vector without contacts.
template <class T>
void ContactVectors<T>::clear(const Crowd<T>& crowd, std::size_t vector) {
  std::fill_n(&fields_[vector * fields::count * lanes], fields::count * lanes, T(0));
  std::fill_n(&at_[vector * most_terms * lanes], most_terms * lanes, crowd.places().numbers());
  std::fill_n(&pushes_[vector * lanes], lanes, Pushes{});
}

template <class T>
void ContactVectors<T>::put(const Crowd<T>& crowd, const Visited& contact, Pushes pushes) {
  const std::uint8_t color = color_[put_++];
  const std::size_t lane = next_[color]++;
  T* const own = &field(lane, 0);
  const auto set = [&](std::uint32_t number, double value) { own[number * lanes] = static_cast<T>(value); };
  const auto set3 = [&](std::uint32_t first, Vec3 value) {
    set(first, value.x);
    set(first + 1, value.y);
    set(first + 2, value.z);
  };
  set3(fields::normal, contact.normal);
  set(fields::gap, contact.gap);
  set3(fields::push, *pushes.push * contact.normal + *pushes.across);
  set(fields::over, contact.over);
  set(fields::moves, 1 / contact.over);
  set(fields::friction, contact.friction);
  // What a contact lacks of terms stands first, without weight, at the place of a term: that is written
  // later.
  const std::uint32_t room = color % classes == 0 ? 2 : most_terms;
  std::uint32_t k = room;
  Vec3 carried = contact.carried;
  std::uint32_t* const places = &at_[lane / lanes * most_terms * lanes + lane % lanes];
  const auto place = [&](std::uint32_t term) -> std::uint32_t& { return places[term * lanes]; };
  for (const Term& term : contact.terms) {
    if (term.move == 0) {  // goes where it goes, whatever pushes it
      carried -= term.weight * crowd.moved(term.at);
      continue;
    }
    --k;
    place(k) = term.at;
    set(fields::weight + k, term.weight);
    set(fields::move + k, term.move);
  }
  while (k > 0) {
    place(--k) = place(room - 1);
    set(fields::weight + k, 0);
    set(fields::move + k, 0);
  }
  set3(fields::carried, carried);
  pushes_[lane] = pushes;
}

template <class T>
void ContactVectors<T>::sweep(Crowd<T>& crowd, Team* team) {
  sweep_ranges(team, ranges_, kernels(crowd), view(crowd));
}

template <class T>
double ContactVectors<T>::measured_sweep(Crowd<T>& crowd, Team* team) {
  return measure_ranges(team, ranges_, kernels(crowd), view(crowd));
}

template <class T>
void ContactVectors<T>::write_back() {
  for (std::size_t lane = 0; lane < pushes_.size(); ++lane) {
    if (pushes_[lane].push == nullptr) continue;
    const Vec3 normal = vector(lane, fields::normal), push = vector(lane, fields::push);
    const double along = dot(push, normal);
    *pushes_[lane].push = std::max(along, 0.0);
    *pushes_[lane].across = push - along * normal;
  }
}

template class ContactVectors<float>;
template class ContactVectors<double>;

}  // namespace plumb::detail
