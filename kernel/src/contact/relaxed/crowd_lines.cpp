// This file finds the contacts of capsules with each other.

#include <algorithm>
#include <cmath>

#include "contact/relaxed/crowd_contacts.hpp"
#include "contact/rows.hpp"

namespace plumb::detail {
namespace {

/// Returns what a push of one on a sum of terms moves it by, 1/kg.
template <class Term>
double moves_of(std::span<const Term> terms) {
  double out = 0;
  for (const Term& term : terms) out += term.weight * term.move;
  return out;
}

}  // namespace

template <class T>
bool CrowdContacts<T>::is_fast(const Pair& pair) const {
  const PlacedLine &a = placed_lines_[pair.one], &b = placed_lines_[pair.other];
  const double radii = a.radius + b.radius;
  // The first takes no roots, and most are not fast.
  return pair_search().is_fast(a.moves + b.moves, radii) &&
         pair_search().is_fast(moves_between(a.way(), b.way()), radii);
}

template <class T>
void CrowdContacts<T>::touch_pair(const Substep& in, const Pair& pair, const Touch& touch,
                                  std::uint64_t key) {
  const Body &a = near_.bodies()[pair.one], &b = near_.bodies()[pair.other];
  const Middle<T> at_a = middle_of(in, a, touch.a), at_b = middle_of(in, b, touch.b);
  add(in, side_of(a, at_a), side_of(b, at_b), touch, key);
}

template <class T>
std::uint64_t CrowdContacts<T>::key_of(const Substep& in, const Pair& pair, std::uint32_t which) const {
  const Body &a = near_.bodies()[pair.one], &b = near_.bodies()[pair.other];
  return contact_key(KeyKind::island, 4 * a.number + which, in.cluster[b.island]->number, b.number);
}

/// Finds the contacts of pairs, in their order. Lines are looked at many at once.
template <class T>
void CrowdContacts<T>::touch_pairs(const Substep& in, std::span<const Pair> pairs) {
  std::array<simd::LinePair, simd::most_line_pairs> lines;
  std::uint32_t count = 0;
  const auto flush = [&] {
    touch_lines(in, std::span(lines).first(count));
    count = 0;
  };
  for (const Pair& pair : pairs) {
    const Body &a = near_.bodies()[pair.one], &b = near_.bodies()[pair.other];
    if (!in.crowd.is_moving(a.island) && !in.crowd.is_moving(b.island)) continue;
    if (a.is_line() && b.is_line()) {
      lines[count++] = {pair.one, pair.other};
      if (count == lines.size()) flush();
    } else {
      flush();
      touch_shapes(in, pair);
    }
  }
  flush();
}

template <class T>
void CrowdContacts<T>::touch_lines(const Substep& in, std::span<const simd::LinePair> pairs) {
  if (pairs.empty()) return;
  std::array<simd::LineTouch, std::size_t{simd::most_line_touches} * simd::most_line_pairs> touches;
  const std::uint32_t count =
      kernels_->lines.find(&placed_lines_.front().p.x, pairs.data(), static_cast<std::uint32_t>(pairs.size()),
                           {settings_.margin, PairSearch::passes}, touches.data());
  for (const simd::LineTouch& touch : std::span(touches).first(count)) {
    const Pair pair{pairs[touch.pair].one, pairs[touch.pair].other};
    if (touch.which == simd::LineTouch::fast)
      touch_shapes(in, pair);
    else
      add_lines(in, pair, touch);
  }
}

/// Finds the contacts of a pair of any shapes, which may be fast.
template <class T>
void CrowdContacts<T>::touch_shapes(const Substep& in, const Pair& pair) {
  constexpr std::uint32_t first = simd::most_line_touches;  // the number after those of touches()
  const PairSearch search = pair_search();
  const PlacedLine &a = placed_lines_[pair.one], &b = placed_lines_[pair.other];
  const MovingSegment line_a = a.way(), line_b = b.way();
  // What is farther apart does not come about in the substep, see add(), nor does it meet in passing, since
  // it moves by less. Rounding is far below the share.
  const double comes = settings_.margin + 1.26 * (a.moves + b.moves);
  if (are_apart(line_a.at, line_b.at, comes)) return;
  const bool fast = is_fast(pair);
  const double reach = fast ? search.reach(a.radius + b.radius) : comes;
  const Touches near = touches(line_a.at, line_b.at, reach);
  for (std::uint32_t n = 0; n < near.count; ++n)
    if (near.at[n].gap <= reach) touch_pair(in, pair, near.at[n], key_of(in, pair, n));
  if (!fast) return;
  if (const auto plane = search.first_touch(line_a, line_b)) {
    touch_pair(in, pair, *plane, key_of(in, pair, first));
    in.to.is_struck = true;
  }
}

/// Adds a contact between two lines, as add() does. Most contacts of a crowd are such: they turn no bodies,
/// and no ground moves them, so that what they do not need is not computed.
template <class T>
void CrowdContacts<T>::add_lines(const Substep& in, const Pair& pair, const simd::LineTouch& touch) {
  const std::array<const Body*, 2> bodies{&near_.bodies()[pair.one], &near_.bodies()[pair.other]};
  const auto end_of = [&](TermRange end) -> const Term& { return near_.terms_of(end).front(); };
  const Middle<T> one(end_of(bodies[0]->a), end_of(bodies[0]->b), touch.a),
      other(end_of(bodies[1]->a), end_of(bodies[1]->b), touch.b);
  const double moves = moves_of(one.terms()) + moves_of(other.terms());
  if (!(1 / moves < INFINITY)) return;
  Batch& to = in.to;
  for (const Body* const body : bodies) {
    const LinkageState& state = *in.cluster[body->island];
    if (touch.gap + touch.closing < 0 && state.asleep && !state.frozen) to.woken.push_back(body->island);
  }
  Contact& contact = to.contacts.emplace_back();
  std::array<Term, 4> terms;
  std::uint32_t count = 0;
  for (const Term& term : one.terms()) terms[count++] = term;
  const auto first = static_cast<std::uint32_t>(to.terms.size());
  contact.other_terms = first + count;
  for (const Term& term : other.terms()) terms[count++] = {term.at, -term.weight, -term.move};
  contact.terms = {first, first + count};
  to.terms.insert(to.terms.end(), terms.begin(), terms.end());
  if (count < terms.size()) to.terms.resize(first + count);
  contact.normal = {touch.x, touch.y, touch.z};
  contact.over = 1 / moves;
  for (std::size_t i = 0; i < 2; ++i) {
    contact.island[i] = bodies[i]->island;
    contact.shape[i] = bodies[i]->number;
  }
  contact.key = key_of(in, pair, touch.which);
  contact.gap = recovered(touch.gap, settings_.slop, in.h * recovery_rate_);
  const Surface &surface = bodies[0]->shape->surface, &of_other = bodies[1]->shape->surface;
  contact.friction = std::sqrt(surface.friction * of_other.friction);
  const double restitution = std::max(surface.restitution, of_other.restitution);
  if (restitution > 0 || in.counts) {
    const double arriving = dot(contact.normal, in.crowd.velocity(to.terms_of(contact.terms)));
    contact.rare = static_cast<std::uint32_t>(to.rares.size());
    Rare& rare = to.rares.emplace_back();
    rare.approach = approach_of(touch.gap, touch.closing, arriving, in.h);
    rare.bounce = bounce_of(restitution, settings_.bounce_speed, rare.approach);
  }
  start_from_kept(in, contact);
}

template bool CrowdContacts<float>::is_fast(const Pair&) const;
template void CrowdContacts<float>::touch_pair(const Substep&, const Pair&, const Touch&, std::uint64_t);
template void CrowdContacts<float>::touch_pairs(const Substep&, std::span<const Pair>);
template bool CrowdContacts<double>::is_fast(const Pair&) const;
template void CrowdContacts<double>::touch_pair(const Substep&, const Pair&, const Touch&, std::uint64_t);
template void CrowdContacts<double>::touch_pairs(const Substep&, std::span<const Pair>);

}  // namespace plumb::detail
