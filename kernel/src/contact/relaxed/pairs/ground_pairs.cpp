// This file finds which shapes of a crowd may touch ground.

#include <algorithm>
#include <cmath>
#include <iterator>

#include "contact/relaxed/pairs/crowd_pairs.hpp"
#include "contact/relaxed/pairs/ways.hpp"

namespace plumb::detail {

/// Lists the plain ends that may touch plain ground now, and those that were not listed before.
template <class T>
void CrowdPairs<T>::find_more_plain_ends(const Crowd<T>& crowd, const Surroundings& surroundings,
                                         const GroundNow& ground) {
  more_.clear();
  find_plain_ends(crowd, surroundings, ground, more_);
  more_plain_ends_.clear();
  std::set_difference(more_.begin(), more_.end(), plain_ends_.begin(), plain_ends_.end(),
                      std::back_inserter(more_plain_ends_), is_before_by_ground);
  plain_ends_.swap(more_);
}

/// Finds what ends may touch where there are no lines to follow, if one goes where it was not looked for.
template <class T>
void CrowdPairs<T>::follow_ends(std::span<LinkageState* const> cluster, const Crowd<T>& crowd,
                                const Surroundings& surroundings, const GroundNow& ground) {
  if (are_in_bounds(crowd)) return;
  slack_ = -1;
  for (const Ball& each : balls_) fastest_ = std::max(fastest_, norm(crowd.velocity(place_of(each))));
  bound_particles(cluster, crowd, left_, left_ * fastest_);
  for (std::uint32_t i = 0; i < balls_.size(); ++i)
    include(ball_bounds_[i], grown(particle_bounds(place_of(balls_[i])), balls_[i].ball->radius));
  find_more_plain_ends(crowd, surroundings, ground);
}

/// Finds who may touch planes, and ground that may move.
template <class T>
void CrowdPairs<T>::find_on_moving(const Crowd<T>& crowd, const GroundNow& ground, double dt) {
  on_planes_.clear();
  on_boxes_.clear();
  on_segments_.clear();
  /// Returns a box that holds all that ground of this rate meets, though it stays where it is.
  const auto met = [&](const Bounds& bounds, const GroundRate* rate) {
    return rate == nullptr ? bounds : grown(bounds, dt * fastest(rate, bounds, dt));
  };
  for (std::uint32_t p = 0; p < ground.planes().size(); ++p) {
    const Plane& plane = ground.planes()[p];
    const bool is_plain = ground.rate_of_plane(p) == nullptr;
    for (std::uint32_t i = 0; i < balls_.size(); ++i) {
      if (balls_[i].is_plain && is_plain) continue;
      const Bounds at = moved_by(ball_bounds_[i], crowd.origin());
      if (height(met(at, ground.rate_of_plane(p)), plane) <= 0 &&
          plumb::may_touch(balls_[i].ball->filter, plane.filter))
        on_planes_.push_back({i, p});
    }
  }
  std::sort(on_planes_.begin(), on_planes_.end(), is_before);
  if (ground.boxes().empty() && ground.segments().empty()) return;
  for (std::uint32_t i = 0; i < bounds_.size(); ++i) {
    if (!crowd.is_moving(island_of(i))) continue;
    const Bounds at = moved_by(bounds_[i], crowd.origin());
    const Filter& filter = filter_of(i);
    for (std::uint32_t b = 0; b < ground.boxes().size(); ++b) {
      const Surroundings::Solid& box = ground.boxes()[b];
      if (box.motion.platform && box.bounds.overlaps(met(at, ground.rate_of_box(b))) &&
          plumb::may_touch(filter, box.filter))
        on_boxes_.push_back({i, b});
    }
    for (std::uint32_t s = 0; s < ground.segments().size(); ++s) {
      const Segment& middle = ground.segments()[s];
      if (grown(met(at, ground.rate_of_segment(s)), middle.radius).overlaps(box_around(middle.p, middle.q)) &&
          plumb::may_touch(filter, ground.shapes()[s].filter))
        on_segments_.push_back({i, s});
    }
  }
}

/// Finds which plain ends may touch plain ground, sorted by ground.
template <class T>
void CrowdPairs<T>::find_plain_ends(const Crowd<T>& crowd, const Surroundings& surroundings,
                                    const GroundNow& ground, Array<Pair>& to) const {
  const auto planes = static_cast<std::uint32_t>(ground.planes().size());
  const auto add = [&](std::uint32_t number, const Filter& filter, auto&& reaches_into) {
    for (std::uint32_t i = 0; i < balls_.size(); ++i)
      if (balls_[i].is_plain && reaches_into(moved_by(ball_bounds_[i], crowd.origin())) &&
          plumb::may_touch(balls_[i].ball->filter, filter))
        to.push_back({i, number});
  };
  for (std::uint32_t p = 0; p < planes; ++p)
    if (const Plane& plane = ground.planes()[p]; ground.rate_of_plane(p) == nullptr)
      add(p, plane.filter, [&](const Bounds& at) { return height(at, plane) <= 0; });
  for (std::uint32_t k = 0; k < surroundings.shapes.size(); ++k)
    if (const GroundShape& shape = surroundings.shapes[k]; shape.capsule())
      add(planes + k, surroundings.shapes[k].filter(),
          [&](const Bounds& at) { return shape.reaches_into(at); });
}

/// Returns whether a line, as long as it is now, cannot go deeper than its ends by more than the slop.
/// Between them the distance from what is round sags by no more than l²/(8 R), with R from its middle line to
/// that of the shape.
template <class T>
bool CrowdPairs<T>::is_kept_out_by_ends(const Crowd<T>& crowd, const Body& body, double radius) const {
  if (!body.is_plain() || body.turns) return false;
  const Vec3 along = crowd.position(body.at[1]) - crowd.position(body.at[0]);
  return dot(along, along) <= 8 * (radius + body.radius) * slop_;
}

/// Returns whether all that a crowd may touch as its lines move slowly is plain ground, by plain ends.
template <class T>
bool CrowdPairs<T>::are_kept_out_by_ends(const Crowd<T>& crowd, const Surroundings& surroundings,
                                         const GroundNow& ground) const {
  if (!are_lines_plain_ || !ground.boxes().empty() || !ground.segments().empty()) return false;
  for (std::uint32_t p = 0; p < ground.planes().size(); ++p)
    if (ground.rate_of_plane(p) != nullptr) return false;
  double least = INFINITY;
  for (const GroundShape& shape : surroundings.shapes) {
    const auto round = shape.capsule();
    if (!round) return false;
    least = std::min(least, round->radius);
  }
  if (!std::all_of(balls_.begin(), balls_.end(), [](const Ball& each) { return each.is_plain; }))
    return false;
  return std::isinf(least) || std::all_of(bodies_.begin(), bodies_.end(), [&](const Body& body) {
           return is_kept_out_by_ends(crowd, body, least);
         });
}

/// Finds who may touch all other ground.
template <class T>
void CrowdPairs<T>::find_on_ground(const Crowd<T>& crowd, const Surroundings& surroundings) {
  on_ground_.clear();
  ends_on_ground_.clear();
  hulls_on_ground_.clear();
  if (surroundings.tree.is_empty() || !follows_lines_) return;
  for (std::uint32_t i = 0; i < balls_.size(); ++i)
    if (balls_[i].body != none) find_end_on_ground(crowd, surroundings, i, ends_on_ground_);
  const auto lines = static_cast<std::uint32_t>(bodies_.size());
  for (std::uint32_t i = 0; i < bounds_.size(); ++i) {
    if (!crowd.is_moving(island_of(i))) continue;
    if (i < lines)
      find_line_on_ground(crowd, surroundings, i, on_ground_);
    else
      find_hull_on_ground(crowd, surroundings, i, hulls_on_ground_);
  }
}

/// Adds what of such ground a body may touch, unless its ends keep it out.
template <class T>
void CrowdPairs<T>::find_line_on_ground(const Crowd<T>& crowd, const Surroundings& surroundings,
                                        std::uint32_t body, Array<Pair>& to) {
  find_on_ground(crowd, surroundings, bounds_[body], filter_of(body), [&](std::uint32_t shape) {
    if (!is_kept_out_by_ends(crowd, bodies_[body], surroundings.shapes[shape])) to.push_back({body, shape});
  });
}

/// Adds what of such ground the end of a body may touch, unless both are plain.
template <class T>
void CrowdPairs<T>::find_end_on_ground(const Crowd<T>& crowd, const Surroundings& surroundings,
                                       std::uint32_t ball, Array<Pair>& to) {
  const Ball& each = balls_[ball];
  find_on_ground(crowd, surroundings, bounds_[each.body], each.ball->filter, [&](std::uint32_t shape) {
    if (!each.is_plain || !surroundings.shapes[shape].capsule()) to.push_back({ball, shape});
  });
}

/// Calls add(shape) for what of such ground reaches into a box, from the crowd's origin.
template <class T>
template <class Add>
void CrowdPairs<T>::find_on_ground(const Crowd<T>& crowd, const Surroundings& surroundings,
                                   const Bounds& around, const Filter& filter, Add&& add) {
  const Bounds at = moved_by(around, crowd.origin());
  if (!surroundings.tree.bounds().overlaps(at)) return;
  surroundings.find(at, near_);
  for (const std::uint32_t shape : near_)
    if (surroundings.shapes[shape].reaches_into(at) &&
        plumb::may_touch(filter, surroundings.shapes[shape].filter()))
      add(shape);
}

/// Adds what of such ground a hull may touch, whose number follows those of bodies.
template <class T>
void CrowdPairs<T>::find_hull_on_ground(const Crowd<T>& crowd, const Surroundings& surroundings,
                                        std::uint32_t number, Array<Pair>& to) {
  const auto hull = number - static_cast<std::uint32_t>(bodies_.size());
  find_on_ground(crowd, surroundings, bounds_[number], filter_of(number), [&](std::uint32_t shape) {
    to.push_back({hull, shape});
  });
}

template bool CrowdPairs<float>::is_kept_out_by_ends(const Crowd<float>&, const Body&, double) const;
template bool CrowdPairs<float>::are_kept_out_by_ends(const Crowd<float>&, const Surroundings&,
                                                      const GroundNow&) const;
template void CrowdPairs<float>::find_plain_ends(const Crowd<float>&, const Surroundings&, const GroundNow&,
                                                 Array<Pair>&) const;
template void CrowdPairs<float>::find_more_plain_ends(const Crowd<float>&, const Surroundings&,
                                                      const GroundNow&);
template void CrowdPairs<float>::follow_ends(std::span<LinkageState* const>, const Crowd<float>&,
                                             const Surroundings&, const GroundNow&);
template void CrowdPairs<float>::find_on_moving(const Crowd<float>&, const GroundNow&, double);
template void CrowdPairs<float>::find_on_ground(const Crowd<float>&, const Surroundings&);
template void CrowdPairs<float>::find_line_on_ground(const Crowd<float>&, const Surroundings&, std::uint32_t,
                                                     Array<Pair>&);
template void CrowdPairs<float>::find_end_on_ground(const Crowd<float>&, const Surroundings&, std::uint32_t,
                                                    Array<Pair>&);
template void CrowdPairs<float>::find_hull_on_ground(const Crowd<float>&, const Surroundings&, std::uint32_t,
                                                     Array<Pair>&);
template bool CrowdPairs<double>::is_kept_out_by_ends(const Crowd<double>&, const Body&, double) const;
template bool CrowdPairs<double>::are_kept_out_by_ends(const Crowd<double>&, const Surroundings&,
                                                       const GroundNow&) const;
template void CrowdPairs<double>::find_plain_ends(const Crowd<double>&, const Surroundings&, const GroundNow&,
                                                  Array<Pair>&) const;
template void CrowdPairs<double>::find_more_plain_ends(const Crowd<double>&, const Surroundings&,
                                                       const GroundNow&);
template void CrowdPairs<double>::follow_ends(std::span<LinkageState* const>, const Crowd<double>&,
                                              const Surroundings&, const GroundNow&);
template void CrowdPairs<double>::find_on_moving(const Crowd<double>&, const GroundNow&, double);
template void CrowdPairs<double>::find_on_ground(const Crowd<double>&, const Surroundings&);
template void CrowdPairs<double>::find_line_on_ground(const Crowd<double>&, const Surroundings&,
                                                      std::uint32_t, Array<Pair>&);
template void CrowdPairs<double>::find_end_on_ground(const Crowd<double>&, const Surroundings&, std::uint32_t,
                                                     Array<Pair>&);
template void CrowdPairs<double>::find_hull_on_ground(const Crowd<double>&, const Surroundings&,
                                                      std::uint32_t, Array<Pair>&);

}  // namespace plumb::detail
