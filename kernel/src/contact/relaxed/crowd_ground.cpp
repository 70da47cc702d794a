// This file finds where a crowd touches ground that is not a plane, and where its hulls touch.

#include <algorithm>
#include <cmath>
#include <utility>

#include "contact/ground/ground_search.hpp"
#include "contact/relaxed/crowd_contacts.hpp"

namespace plumb::detail {
namespace {

/// Returns whether a line that moves cannot come to something round.
bool passes_by(const MovingSegment& moving, const GroundShape& ground) {
  const auto round = ground.capsule();
  return round && are_apart(moving.at, *round, moves_of(moving));
}

}  // namespace

template <class T>
void CrowdContacts<T>::touch_moving(const Substep& in, std::uint32_t hull, const Convex& solid,
                                    const Side& other, KeyKind kind, std::uint32_t ground) {
  const PlacedShape each{placed_hulls_, hull};
  const std::uint32_t island = near_.hulls()[hull].island;
  const double moves = hull_motion(in.crowd, hull).moves() + in.h * fastest(other.rate, each.bounds(0), in.h);
  for_touches_with_moving(each, solid, settings_.margin + moves, kind, ground,
                          [&](std::uint64_t key, const Combination& place, const Touch& touch) {
                            const Middle<T> at(in.crowd, *in.cluster[island]->linkage, island, place);
                            add(in, {island, each.number, at.terms(), each.surface}, other, touch, key);
                          });
}

template <class T>
void CrowdContacts<T>::touch_boxes(const Substep& in, std::span<const Pair> pairs) {
  for (const Pair& pair : pairs) {
    const Surroundings::Solid& box = in.ground.boxes()[pair.other];
    const Side other{.shape = in.surroundings.numbers.of_box(pair.other),
                     .surface = &box.surface,
                     .rate = in.ground.rate_of_box(pair.other)};
    if (const auto hull = near_.hull(pair.one)) {
      touch_moving(in, *hull, in.ground.solid_of_box(pair.other), other, KeyKind::box, pair.other);
      continue;
    }
    const Body& each = near_.bodies()[pair.one];
    const Vec3 off = in.crowd.origin() - box.center;
    const Vec3 p = box.frame.to_local(off + in.crowd.position(near_.terms_of(each.a)));
    const Vec3 q = box.frame.to_local(off + in.crowd.position(near_.terms_of(each.b)));
    for_touches_with_box(p, q, each.shape->radius, box,
                         [&](std::uint64_t which, double t, const Touch& touch) {
                           const Middle<T> at = middle_of(in, each, t);
                           add(in, side_of(each, at), other, touch,
                               contact_key(KeyKind::box, 16 * each.number + which, 0, pair.other));
                         });
  }
}

template <class T>
void CrowdContacts<T>::touch_segments(const Substep& in, std::span<const Pair> pairs) {
  for (const Pair& pair : pairs) {
    const Linkage::Shape& anchored = in.ground.shapes()[pair.other];
    const Side other{.shape = in.surroundings.numbers.of_anchored(pair.other),
                     .surface = &anchored.surface,
                     .rate = in.ground.rate_of_segment(pair.other)};
    if (const auto hull = near_.hull(pair.one)) {
      const Hull& each = near_.hulls()[*hull];
      if (!hang_together(*in.cluster[each.island], each.shape->number, anchored))
        touch_moving(in, *hull, in.ground.solid_of_segment(pair.other), other, KeyKind::segment, pair.other);
      continue;
    }
    const Body& each = near_.bodies()[pair.one];
    if (hang_together(*in.cluster[each.island], each.number, anchored)) continue;
    const Segment own{in.crowd.origin() + in.crowd.position(near_.terms_of(each.a)),
                      in.crowd.origin() + in.crowd.position(near_.terms_of(each.b)), each.shape->radius};
    const Touches near = touches(own, in.ground.segments()[pair.other]);
    for (std::uint32_t n = 0; n < near.count; ++n) {
      const Middle<T> at = middle_of(in, each, near.at[n].a);
      add(in, side_of(each, at), other, near.at[n],
          contact_key(KeyKind::segment, 4 * each.number + n, 0, pair.other));
    }
  }
}

template <class T>
void CrowdContacts<T>::place_hulls(const Crowd<T>& crowd) {
  placed_hulls_.clear();
  for (const Hull& hull : near_.hulls()) {
    Vectors particles;
    for (std::size_t k = 0; k < 4; ++k) particles[k] = crowd.origin() + crowd.position(hull.at[k]);
    placed_hulls_.add(*hull.shape, particles);
  }
}

template <class T>
MovingSegment CrowdContacts<T>::motion_of(const Crowd<T>& crowd, const Body& body) const {
  if (const auto [p, q] = body.at; body.is_plain())
    return {{crowd.origin() + crowd.position(p), crowd.origin() + crowd.position(q), body.radius},
            crowd.moved(p),
            crowd.moved(q)};
  return {{crowd.origin() + crowd.position(near_.terms_of(body.a)),
           crowd.origin() + crowd.position(near_.terms_of(body.b)), body.shape->radius},
          crowd.moved(near_.terms_of(body.a)),
          crowd.moved(near_.terms_of(body.b))};
}

template <class T>
MovingHullShape CrowdContacts<T>::hull_motion(const Crowd<T>& crowd, std::uint32_t hull) {
  Vectors by;
  for (std::size_t k = 0; k < 4; ++k) by[k] = crowd.moved(near_.hulls()[hull].at[k]);
  return placed_hulls_.moving(hull, by);
}

template <class T>
std::uint32_t CrowdContacts<T>::cuts(const Crowd<T>& crowd, double h) const {
  constexpr double farthest = 0.2, most_cuts = 1024;
  double most = 1;
  const auto see = [&](const Hull& hull) {
    if (!crowd.is_moving(hull.island)) return;
    Vectors velocities;
    for (std::size_t k = 0; k < 4; ++k) velocities[k] = crowd.velocity(hull.at[k]);
    for (const std::array<double, 4>& corner : hull.shape->corners)
      most = std::max(most, h * norm(weighted(corner, velocities)) / (farthest * hull.shape->half_width));
  };
  const auto see_numbered = [&](std::uint32_t number) {
    if (const auto hull = near_.hull(number)) see(near_.hulls()[*hull]);
  };
  for (const Pair& pair : near_.hulls_on_ground()) see(near_.hulls()[pair.one]);
  for (const std::span<const Pair> pairs : {near_.on_boxes(), near_.on_segments()})
    for (const Pair& pair : pairs) see_numbered(pair.one);
  for (const Pair& pair : near_.hull_pairs())
    for (const std::uint32_t i : {pair.one, pair.other}) see_numbered(i);
  const Hull* last = nullptr;  // corners of a hull follow each other
  for (const Pair& pair : near_.on_planes())
    if (const Ball& ball = near_.balls()[pair.one]; ball.body == none)
      if (const Hull* const hull = near_.hull_of(ball.island, ball.ball->shape);
          hull && hull != std::exchange(last, hull))
        see(*hull);
  return static_cast<std::uint32_t>(std::ceil(std::min(most, most_cuts)));
}

template <class T>
auto CrowdContacts<T>::ground_side(const Substep& in, std::uint32_t ground) -> Side {
  const GroundShape& shape = in.surroundings.shapes[ground];
  const GroundRate* const rate =
      shape.box() == GroundShape::none ? nullptr : in.ground.rate_of_box(shape.box());
  return {.shape = in.surroundings.number_of(ground), .surface = &shape.surface(), .rate = rate};
}

template <class T>
void CrowdContacts<T>::touch_lines_and_ground(const Substep& in, std::span<const Pair> pairs) {
  const Surroundings& surroundings = in.surroundings;
  const Crowd<T>& crowd = in.crowd;
  const GroundSearch search{settings_.margin, settings_.tolerance};
  for (const auto& [number, ground] : pairs) {
    const Body& each = near_.bodies()[number];
    const Side other = ground_side(in, ground);
    for_line_touches(surroundings, ground, motion_of(crowd, each), each.number, search,
                     [&](std::uint64_t key, const Touch& touch) {
                       const Middle<T> at = middle_of(in, each, touch.a);
                       add(in, side_of(each, at), other, touch, key);
                     });
  }
}

/// Finds the planes in which lines touch first that move fast past ground that else their ends keep them out
/// of.
template <class T>
void CrowdContacts<T>::touch_in_passing(const Substep& in) {
  const GroundSearch search{settings_.margin, settings_.tolerance};
  for (const std::uint32_t number : fast_lines_) {
    const Body& each = near_.bodies()[number];
    if (!in.crowd.is_moving(each.island)) continue;
    const MovingSegment moving = motion_of(in.crowd, each);
    for_ground_near(in, moving, [&](std::uint32_t ground, const GroundShape& shape) {
      if (!near_.is_kept_out_by_ends(in.crowd, each, shape) ||
          !plumb::may_touch(each.shape->filter, in.surroundings.shapes[ground].filter()))
        return;
      const Side other = ground_side(in, ground);
      for_first_touches(in.surroundings, ground, moving, search,
                        [&](std::uint64_t which, const Touch& plane, double) {
                          const Middle<T> at = middle_of(in, each, plane.a);
                          add(in, side_of(each, at), other, plane,
                              ground_key(GroundPart::first_of_line, each.number, ground, which));
                        });
    });
  }
}

template <class T>
void CrowdContacts<T>::touch_ends_and_ground(const Substep& in, std::span<const Pair> pairs) {
  const Surroundings& surroundings = in.surroundings;
  const Crowd<T>& crowd = in.crowd;
  const GroundSearch search{settings_.margin, settings_.tolerance};
  for (const auto& [number, ground] : pairs) {
    const Ball& each = near_.balls()[number];
    const Side other = ground_side(in, ground);
    const auto [line, p_by, q_by] = motion_of(crowd, near_.bodies()[each.body]);
    const MovingEnd end{crowd.origin() + crowd.position(near_.terms_of(each.center)), 0.5 * (line.p + line.q),
                        each.ball->radius, norm(crowd.moved(near_.terms_of(each.center)))};
    for_end_touches(
        surroundings, ground, end, each.number, search,
        [&](std::uint64_t key, const Touch& touch) { add(in, side_of(each), other, touch, key); });
  }
}

template <class T>
void CrowdContacts<T>::touch_hulls_and_ground(const Substep& in) {
  const Surroundings& surroundings = in.surroundings;
  const Crowd<T>& crowd = in.crowd;
  const GroundSearch search{settings_.margin, settings_.tolerance};
  for (const auto& [number, ground] : near_.hulls_on_ground()) {
    const Hull& each = near_.hulls()[number];
    const Side other = ground_side(in, ground);
    for_hull_touches(
        surroundings, ground, hull_motion(crowd, number), search,
        [&](std::uint64_t key, const Combination& place, const Touch& touch) {
          const Middle<T> at(crowd, *in.cluster[each.island]->linkage, each.island, place);
          add(in, {each.island, each.shape->number, at.terms(), &each.shape->surface}, other, touch, key);
        });
  }
}

template <class T>
PlacedShape CrowdContacts<T>::placed(const Crowd<T>& crowd, std::uint32_t number) {
  if (const auto hull = near_.hull(number)) return {placed_hulls_, *hull};
  const Body& body = near_.bodies()[number];
  const Segment line = motion_of(crowd, body).at;
  return {*body.shape, body.number, line.p, line.q};
}

template <class T>
void CrowdContacts<T>::touch_hull_pairs(const Substep& in) {
  const Crowd<T>& crowd = in.crowd;
  const auto lines = static_cast<std::uint32_t>(near_.bodies().size());
  const auto moves = [&](std::uint32_t i) {
    return i < lines ? moves_of(motion_of(crowd, near_.bodies()[i])) : hull_motion(crowd, i - lines).moves();
  };
  for (const auto& [one, two] : near_.hull_pairs()) {
    const std::uint32_t i = near_.island_of(one), j = near_.island_of(two);
    if (!crowd.is_moving(i) && !crowd.is_moving(j)) continue;
    const PlacedShape a = placed(crowd, one), b = placed(crowd, two);
    for_pair_touches(
        a, b, settings_.margin + moves(one) + moves(two), in.cluster[j]->number,
        [&](std::uint64_t key, const Combination& on_a, const Combination& on_b, const Touch& touch) {
          const Middle<T> at_a(crowd, *in.cluster[i]->linkage, i, on_a),
              at_b(crowd, *in.cluster[j]->linkage, j, on_b);
          add(in, {i, a.number, at_a.terms(), a.surface}, {j, b.number, at_b.terms(), b.surface}, touch, key);
        });
  }
}

template <class T>
bool CrowdContacts<T>::find_missed(std::span<LinkageState* const> cluster, Crowd<T>& crowd,
                                   const Surroundings& surroundings, const GroundNow& ground, double h,
                                   Team* team) {
  // All that is found now goes behind what was found before.
  Batch& last = batches_.back();
  const std::size_t before = last.contacts.size();
  for (Batch& batch : batches_) {
    const auto comes = [&](const Contact& contact) {
      const Vec3 moved = crowd.moved(batch.terms_of(contact.terms)) - batch.rare_of(contact).carried;
      if (contact.gap + dot(contact.normal, moved) > -settings_.slop) return false;
      last.contacts.push_back(&batch == &last ? contact : copied(batch, contact, last));
      return true;
    };
    batch.left_out.erase(std::remove_if(batch.left_out.begin(), batch.left_out.end(), comes),
                         batch.left_out.end());
  }
  const Substep in{cluster, crowd, surroundings, ground, h, last, is_counted(cluster)};
  find_missed_pairs(in, team);
  find_missed_on_planes(in);
  if (!surroundings.tree.is_empty()) {
    find_missed_bodies(in);
    find_missed_hulls(in);
  }
  const bool are_ends_missed = ends_.find_missed(crowd, h);
  if (last.contacts.size() != before || (are_ends_missed && is_revisited_)) lay_out(crowd);
  return last.contacts.size() != before || are_ends_missed;
}

/// Returns a contact of one batch for another one, which gets all that it refers to.
template <class T>
auto CrowdContacts<T>::copied(const Batch& from, const Contact& contact, Batch& to) -> Contact {
  Contact out = contact;
  const auto copy = [&](TermRange range) {
    const auto first = static_cast<std::uint32_t>(to.terms.size());
    to.terms.insert(to.terms.end(), from.terms.begin() + range.first, from.terms.begin() + range.end);
    return TermRange{first, static_cast<std::uint32_t>(to.terms.size())};
  };
  out.terms = copy(contact.terms);
  out.other_terms = out.terms.first + (contact.other_terms - contact.terms.first);
  if (contact.rare == none) return out;
  out.rare = static_cast<std::uint32_t>(to.rares.size());
  Rare& rare = to.rares.emplace_back(from.rare_of(contact));
  if (rare.slides_apart) rare.sliding = copy(rare.sliding);
  if (rare.turning == none) return out;
  Turning turning = from.turnings[rare.turning];
  const auto first = static_cast<std::uint32_t>(to.turn_terms.size());
  to.turn_terms.insert(to.turn_terms.end(), from.turn_terms.begin() + turning.first,
                       from.turn_terms.begin() + turning.end);
  turning.first = first;
  turning.end = static_cast<std::uint32_t>(to.turn_terms.size());
  rare.turning = static_cast<std::uint32_t>(to.turnings.size());
  to.turnings.push_back(turning);
  return out;
}

/// Adds a contact with what a shape went into, if that was not expected. `width` (m) is half of the shape's.
template <class T>
void CrowdContacts<T>::miss(const Substep& in, const Side& side, std::uint32_t ground, double width,
                            const Touch& plane, double time) {
  // What sweeps leave may be a share of a shape.
  constexpr double harmless = 0.25;
  if (is_missed(plane, time, std::max(settings_.tolerance, std::min(settings_.margin, harmless * width))) &&
      plumb::may_touch(shape_of(in, side).filter, in.surroundings.shapes[ground].filter()))
    add(in, side, ground_side(in, ground), plane,
        ground_key(GroundPart::missed, side.shape, ground, count_contacts()));
}

/// Calls f(number, shape) for ground that stands still and that a moving line may come to.
template <class T>
template <class F>
void CrowdContacts<T>::for_ground_near(const Substep& in, const MovingSegment& moving, F&& f) {
  const Array<GroundShape>& shapes = in.surroundings.shapes;
  if (shapes.size() <= few_shapes) {
    for (std::uint32_t k = 0; k < shapes.size(); ++k)
      if (!passes_by(moving, shapes[k]) && shapes[k].bounds().overlaps(bounds_of(moving))) f(k, shapes[k]);
    return;
  }
  const Bounds way = bounds_of(moving);
  if (!in.surroundings.tree.bounds().overlaps(way)) return;
  in.surroundings.find(way, near_ground_);
  for (const std::uint32_t ground : near_ground_)
    if (const GroundShape& shape = in.surroundings.shapes[ground]; !passes_by(moving, shape))
      f(ground, shape);
}

template <class T>
void CrowdContacts<T>::find_missed_bodies(const Substep& in) {
  const GroundSearch search{settings_.margin, settings_.tolerance};
  for (const std::uint32_t number : fast_lines_) {
    const Body& each = near_.bodies()[number];
    if (!in.crowd.is_moving(each.island)) continue;
    const MovingSegment moving = motion_of(in.crowd, each);
    for_ground_near(in, moving, [&](std::uint32_t ground, const GroundShape&) {
      for_first_touches(in.surroundings, ground, moving, search,
                        [&](std::uint64_t, const Touch& plane, double time) {
                          const Middle<T> at = middle_of(in, each, plane.a);
                          miss(in, side_of(each, at), ground, each.shape->radius, plane, time);
                        });
    });
  }
}

template <class T>
void CrowdContacts<T>::find_missed_hulls(const Substep& in) {
  const GroundSearch search{settings_.margin, settings_.tolerance};
  for (std::uint32_t k = 0; k < near_.hulls().size(); ++k) {
    const Hull& each = near_.hulls()[k];
    if (!in.crowd.is_moving(each.island)) continue;
    const MovingHullShape moving = hull_motion(in.crowd, k);
    if (!search.is_fast(moving.moves(), each.shape->half_width)) continue;
    in.surroundings.find(bounds_of(moving.hull), near_ground_);
    for (const std::uint32_t ground : near_ground_)
      for_first_touches(in.surroundings, ground, moving, search,
                        [&](std::uint64_t, const Combination& place, const Touch& plane, double time) {
                          const Middle<T> at(in.crowd, *in.cluster[each.island]->linkage, each.island, place);
                          miss(in, {each.island, each.shape->number, at.terms(), &each.shape->surface},
                               ground, each.shape->half_width, plane, time);
                        });
  }
}

template void CrowdContacts<float>::touch_boxes(const Substep&, std::span<const Pair>);
template void CrowdContacts<float>::touch_segments(const Substep&, std::span<const Pair>);
template std::uint32_t CrowdContacts<float>::cuts(const Crowd<float>&, double) const;
template void CrowdContacts<float>::place_hulls(const Crowd<float>&);
template void CrowdContacts<float>::touch_lines_and_ground(const Substep&, std::span<const Pair>);
template void CrowdContacts<float>::touch_in_passing(const Substep&);
template void CrowdContacts<double>::touch_in_passing(const Substep&);
template void CrowdContacts<float>::touch_ends_and_ground(const Substep&, std::span<const Pair>);
template void CrowdContacts<float>::touch_hulls_and_ground(const Substep&);
template void CrowdContacts<float>::touch_hull_pairs(const Substep&);
template bool CrowdContacts<float>::find_missed(std::span<LinkageState* const>, Crowd<float>&,
                                                const Surroundings&, const GroundNow&, double, Team*);
template void CrowdContacts<double>::touch_boxes(const Substep&, std::span<const Pair>);
template void CrowdContacts<double>::touch_segments(const Substep&, std::span<const Pair>);
template std::uint32_t CrowdContacts<double>::cuts(const Crowd<double>&, double) const;
template void CrowdContacts<double>::place_hulls(const Crowd<double>&);
template void CrowdContacts<double>::touch_lines_and_ground(const Substep&, std::span<const Pair>);
template void CrowdContacts<double>::touch_ends_and_ground(const Substep&, std::span<const Pair>);
template void CrowdContacts<double>::touch_hulls_and_ground(const Substep&);
template void CrowdContacts<double>::touch_hull_pairs(const Substep&);
template bool CrowdContacts<double>::find_missed(std::span<LinkageState* const>, Crowd<double>&,
                                                 const Surroundings&, const GroundNow&, double, Team*);

}  // namespace plumb::detail
