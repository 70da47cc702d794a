// This file finds where capsules of a crowd touch each other, and where they would pass through each other or
// through planes.

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "contact/relaxed/crowd_contacts.hpp"
#include "contact/relaxed/pairs/ways.hpp"
#include "contact/rows.hpp"

namespace plumb::detail {
namespace {

double square(Vec3 v) {
  return dot(v, v);
}

}  // namespace

/// Places lines if others may touch them, and lists those that are fast and may come to ground.
template <class T>
void CrowdContacts<T>::see_fast(const Crowd<T>& crowd, const Surroundings& surroundings, Team* team) {
  may_be_fast_ = moved_ > near_.least_fast(settings_.margin, PairSearch::passes);
  fast_lines_.clear();
  if (near_.may_meet() || has_hulls()) place_lines(crowd, team);
  if (!may_be_fast_) return;
  const auto bodies = near_.bodies();
  is_fast_ =
      is_fast_ || near_.are_alike() ||
      std::any_of(bodies.begin(), bodies.end(), [&](const Body& body) { return is_fast(crowd, body); });
  if (!surroundings.tree.is_empty()) list_fast(crowd, surroundings);
}

/// Returns whether an end of a body moves far for how thick it is.
template <class T>
bool CrowdContacts<T>::is_fast(const Crowd<T>& crowd, const Body& body) const {
  const double least = settings_.margin + PairSearch::passes * body.radius;
  const auto moves = [&](std::uint32_t at, TermRange terms) {
    return square(body.is_plain() ? crowd.moved(at) : crowd.moved(near_.terms_of(terms)));
  };
  return std::max(moves(body.at[0], body.a), moves(body.at[1], body.b)) > least * least;
}

/// Lists fast lines but for those between particles of which none is fast and may come to ground. All of such
/// a line is within its length of each of its ends.
template <class T>
void CrowdContacts<T>::list_fast(const Crowd<T>& crowd, const Surroundings& surroundings) {
  if (longest_ < 0) longest_ = near_.longest_line(crowd);
  // Since then no line has become longer by more than twice what particles went in the step. Rounding of
  // bounds is far below the margin.
  const double reach = longest_ + 2 * way_ + moved_ + near_.largest_radius() + settings_.margin;
  const Bounds box = moved_by(grown(surroundings.tree.bounds(), reach), -1.0 * crowd.origin());
  marks_.assign(near_.bodies().size() / 64 + 1, 0);
  const auto mark = [&](std::uint32_t line) { marks_[line / 64] |= std::uint64_t{1} << line % 64; };
  // No float of a line that is fast is as slow as that.
  const double least = (1 - 1e-6) * near_.least_fast(settings_.margin, PairSearch::passes);
  const bool are_few = surroundings.shapes.size() <= few_shapes;
  const auto is_near = [&](std::uint32_t at) {
    const Vec3 there = crowd.origin() + crowd.position(at);
    return std::any_of(surroundings.shapes.begin(), surroundings.shapes.end(),
                       [&](const GroundShape& each) { return each.may_reach(there, reach); });
  };
  for (const std::uint32_t at : crowd.list_fast(box, least, fast_places_))
    if (!are_few || is_near(at))
      for (const std::uint32_t line : near_.lines_at(crowd.places().particle_at(at))) mark(line);
  for (const std::uint32_t line : near_.other_lines()) mark(line);
  for (std::uint32_t i = 0; i < marks_.size(); ++i)
    for (std::uint64_t left = marks_[i]; left != 0; left &= left - 1) {
      const std::uint32_t line = 64 * i + static_cast<std::uint32_t>(std::countr_zero(left));
      if (is_fast(crowd, near_.bodies()[line])) fast_lines_.push_back(line);
    }
}

/// Places the lines of bodies where the substep begins, with their displacements of now.
template <class T>
void CrowdContacts<T>::place_lines(const Crowd<T>& crowd, Team* team) {
  const auto count = static_cast<std::uint32_t>(near_.bodies().size());
  const unsigned parts = team == nullptr ? 1 : team->parts();
  placed_lines_.resize(count);
  part_is_fast_.assign(parts, 0);
  auto place = [&](unsigned part) {
    bool any_fast = false;
    for (std::uint32_t i = Team::begin_of(count, part, parts); i < Team::begin_of(count, part + 1, parts);
         ++i) {
      const Body& body = near_.bodies()[i];
      PlacedLine& line = placed_lines_[i];
      line.radius = body.shape->radius;
      if (body.is_plain()) {
        const auto [p, q] = body.at;
        line.p = crowd.position(p), line.q = crowd.position(q);
        line.p_by = crowd.moved(p), line.q_by = crowd.moved(q);
      } else {
        const auto a = near_.terms_of(body.a), b = near_.terms_of(body.b);
        line.p = crowd.position(a), line.q = crowd.position(b);
        line.p_by = crowd.moved(a), line.q_by = crowd.moved(b);
      }
      line.moves = moves_of(line.way());
      any_fast = any_fast || pair_search().is_fast(line.moves, body.shape->radius);
    }
    part_is_fast_[part] = any_fast ? 1 : 0;
  };
  if (team == nullptr)
    place(0);
  else
    team->for_parts(place);
  is_fast_ = is_fast_ || std::find(part_is_fast_.begin(), part_is_fast_.end(), 1) != part_is_fast_.end();
}

/// Finds what those pass through in the substep that may be fast.
template <class T>
void CrowdContacts<T>::place_ways(const Crowd<T>& crowd) {
  ways_.clear();
  for (const PlacedLine& each : placed_lines_)
    ways_.push_back(pair_search().may_be_fast(each.moves, each.radius) ? bounds_of(each.way()) : nowhere);
  for (std::uint32_t k = 0; k < near_.hulls().size(); ++k) {
    const Bounds way = bounds_of(hull_motion(crowd, k).hull);
    ways_.push_back({way.low - crowd.origin(), way.high - crowd.origin()});
  }
}

template <class T>
bool CrowdContacts<T>::outrun_hulls(const Crowd<T>& crowd) {
  constexpr double farthest = 0.5;  // of the way to the hull's middle
  const auto lines = static_cast<std::uint32_t>(placed_lines_.size());
  return std::any_of(near_.hull_pairs().begin(), near_.hull_pairs().end(), [&](const Pair& pair) {
    const MovingHullShape hull = hull_motion(crowd, pair.other - lines);
    const auto outruns = [&](std::span<const Vec3> moves, double width) {
      double square = 0;
      for (const Vec3 by : hull.hull.by)
        for (const Vec3 other : moves) square = std::max(square, dot(by - other, by - other));
      return std::sqrt(square) > settings_.margin + farthest * (hull.shape.half_width + width);
    };
    if (pair.one >= lines) {
      if (!ways_[pair.one].overlaps(ways_[pair.other])) return false;
      const MovingHullShape other = hull_motion(crowd, pair.one - lines);
      return outruns(other.hull.by, other.shape.half_width);
    }
    // A slow line has none of ways_, and what is fast passes it all the same.
    const MovingSegment line = placed_lines_[pair.one].way();
    if (!bounds_of(line).overlaps(ways_[pair.other])) return false;
    return outruns(std::array{line.p_by, line.q_by}, line.at.radius);
  });
}

/// Adds contacts between shapes that pass through each other, since others pushed them.
template <class T>
void CrowdContacts<T>::find_missed_pairs(const Substep& in, Team* team) {
  moved_ = in.crowd.most_moved();
  see_fast(in.crowd, in.surroundings, team);
  if (!near_.may_meet() && !has_hulls()) return;
  place_ways(in.crowd);
  near_.follow(in.cluster, in.crowd, in.surroundings, in.ground, ways_);
  ends_.add_thrown(in.cluster, in.crowd, near_, in.surroundings, in.ground, in.h * recovery_rate_);
  for (const Pair& pair : near_.pairs()) {
    if (!is_fast(pair)) continue;
    const auto plane = pair_search().passed(placed_lines_[pair.one].way(), placed_lines_[pair.other].way());
    if (!plane) continue;
    in.to.is_struck = true;
    const std::uint32_t other = near_.bodies()[pair.other].island;
    touch_pair(in, pair, *plane,
               contact_key(KeyKind::island, std::uint64_t{1} << 40 | near_.bodies()[pair.one].number,
                           in.cluster[other]->number, count_contacts()));
  }
}

/// Adds contacts of ends with planes that they go into, since others pushed them. CrowdEnds watches plain
/// ones.
template <class T>
void CrowdContacts<T>::find_missed_on_planes(const Substep& in) {
  for (const Pair& pair : near_.on_planes()) {
    const Ball& each = near_.balls()[pair.one];
    const Plane& plane = in.ground.planes()[pair.other];
    const GroundRate* const rate = in.ground.rate_of_plane(pair.other);
    const Vec3 at = in.crowd.origin() + in.crowd.position(near_.terms_of(each.center));
    Vec3 by = in.crowd.moved(near_.terms_of(each.center));
    if (rate != nullptr) by -= rate->moved(at - each.ball->radius * plane.normal, plane.normal, in.h);
    const double gap = dot(plane.normal, at) - plane.offset - each.ball->radius;
    if (dot(plane.normal, by) + std::max(gap, 0.0) >= -settings_.slop) continue;
    const std::uint64_t key = contact_key(KeyKind::plane, each.number, 0, pair.other);
    const auto is_it = [&](const Contact& contact) {
      return contact.key == key && contact.island[0] == each.island;
    };
    if (!any_of(is_it)) touch_planes(in, {&pair, 1});
  }
}

template bool CrowdContacts<float>::outrun_hulls(const Crowd<float>&);
template bool CrowdContacts<double>::outrun_hulls(const Crowd<double>&);
template void CrowdContacts<float>::see_fast(const Crowd<float>&, const Surroundings&, Team*);
template void CrowdContacts<double>::see_fast(const Crowd<double>&, const Surroundings&, Team*);
template void CrowdContacts<float>::place_lines(const Crowd<float>&, Team*);
template void CrowdContacts<double>::place_lines(const Crowd<double>&, Team*);
template void CrowdContacts<float>::find_missed_pairs(const Substep&, Team*);
template void CrowdContacts<float>::find_missed_on_planes(const Substep&);
template void CrowdContacts<double>::find_missed_pairs(const Substep&, Team*);
template void CrowdContacts<double>::find_missed_on_planes(const Substep&);

}  // namespace plumb::detail
