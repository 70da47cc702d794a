#include "contact/relaxed/crowd_pairs.hpp"

#include <algorithm>
#include <iterator>

#include "contact/linkage/linkage_bounds.hpp"
#include "scene/barycentric.hpp"

namespace plumb::detail {
namespace {

/// A place may go this much farther in a step than it would at its velocity, because something pushes it.
constexpr double further = 1.25;

Bounds passed_through(Vec3 from, Vec3 by, double radius) {
  Bounds out = nowhere;
  include(out, from, radius);
  include(out, from + further * by, radius);
  return out;
}

void include(Bounds& bounds, const Bounds& other) {
  include(bounds, other.low, 0);
  include(bounds, other.high, 0);
}

/// Returns how far (m) something falls in dt (s).
double fall_in(const Linkage& linkage, double dt) {
  return 0.5 * dt * dt * norm(linkage.gravity());
}

Bounds moved_by(const Bounds& bounds, Vec3 by) {
  return {bounds.low + by, bounds.high + by};
}

/// Orders pairs by their first, then by their second number.
constexpr auto is_before = [](const auto& a, const auto& b) {
  return a.one != b.one ? a.one < b.one : a.other < b.other;
};

/// Sorts pairs and leaves each of them once.
template <class Pair>
void sort(std::vector<Pair>& pairs) {
  std::sort(pairs.begin(), pairs.end(), is_before);
  const auto is_same = [](const Pair& a, const Pair& b) { return a.one == b.one && a.other == b.other; };
  pairs.erase(std::unique(pairs.begin(), pairs.end(), is_same), pairs.end());
}

}  // namespace

template <class T>
void CrowdPairs<T>::find(std::span<LinkageState* const> cluster, const Crowd<T>& crowd,
                         const Surroundings& surroundings, const GroundNow& ground, double dt,
                         double margin) {
  margin_ = margin;
  left_ = dt;
  find_shapes(cluster, crowd, surroundings, dt, margin);
  find_hulls(cluster, crowd, surroundings, dt, margin);
  find_pairs(cluster);
  find_on_moving(crowd, ground, dt);
  find_on_ground(crowd, surroundings);
}

template <class T>
void CrowdPairs<T>::find_shapes(std::span<LinkageState* const> cluster, const Crowd<T>& crowd,
                                const Surroundings& surroundings, double dt, double margin) {
  ends_.clear();
  bodies_.clear();
  balls_.clear();
  bounds_.clear();
  ball_bounds_.clear();
  // A blow may make any of them as fast as the fastest. To look at planes costs little.
  fastest_ = 0;
  for (std::uint32_t i = 0; i < cluster.size(); ++i)
    if (crowd.is_moving(i)) fastest_ = std::max(fastest_, top_speed(*cluster[i]));
  for (std::uint32_t i = 0; i < cluster.size(); ++i) {
    const Linkage& linkage = *cluster[i]->linkage;
    const auto first_body = static_cast<std::uint32_t>(bodies_.size());
    const double fall = fall_in(linkage, dt) + margin;
    const auto add_terms = [&](const Combination& sum) {
      const auto first = static_cast<std::uint32_t>(ends_.size());
      crowd.add_terms(linkage, i, sum, 1, ends_);
      return TermRange{first, static_cast<std::uint32_t>(ends_.size())};
    };
    for (std::uint32_t k = 0; k < linkage.shapes().size(); ++k) {
      const Linkage::Shape& shape = linkage.shapes()[k];
      const TermRange a = add_terms(shape.a), b = add_terms(shape.b);
      bodies_.push_back({i, k, &shape, a, b});
      bounds_.push_back(reach_of(crowd, surroundings, bodies_.back(), dt, crowd.is_moving(i) ? fall : 0));
    }
    if (!crowd.is_moving(i)) continue;
    for (std::uint32_t k = 0; k < linkage.balls().size(); ++k) {
      const Linkage::Ball& ball = linkage.balls()[k];
      const std::uint32_t body = ball.shape < linkage.shapes().size() ? first_body + ball.shape : none;
      balls_.push_back({i, k, &ball, add_terms(ball.center), body});
      const double radius = ball.radius + dt * fastest_ + fall;
      ball_bounds_.push_back(
          carried(crowd, surroundings, i, reach_of(crowd, balls_.back().center, radius, dt), ball.filter));
    }
  }
}

/// Returns a box around the way of a place in dt (s).
template <class T>
Bounds CrowdPairs<T>::reach_of(const Crowd<T>& crowd, TermRange place, double radius, double dt) const {
  const auto terms = terms_of(place);
  return passed_through(crowd.position(terms), dt * crowd.velocity(terms), radius);
}

/// Returns a box around the way of a line in dt (s), which ground may carry, and `more` (m) around that.
template <class T>
Bounds CrowdPairs<T>::reach_of(const Crowd<T>& crowd, const Surroundings& surroundings, const Body& body,
                               double dt, double more) const {
  Bounds around = reach_of(crowd, body.a, body.shape->radius + more, dt);
  include(around, reach_of(crowd, body.b, body.shape->radius + more, dt));
  return carried(crowd, surroundings, body.island, around, body.shape->filter);
}

template <class T>
bool CrowdPairs<T>::is_outrun(const Crowd<T>& crowd, std::uint32_t body) const {
  const Body& each = bodies_[body];
  const Bounds& bounds = bounds_[body];
  const auto leaves = [&](TermRange end) {
    const auto terms = terms_of(end);
    const Vec3 at = crowd.position(terms) + crowd.moved(terms);
    const double radius = each.shape->radius;
    return at.x - radius < bounds.low.x || at.x + radius > bounds.high.x || at.y - radius < bounds.low.y ||
           at.y + radius > bounds.high.y || at.z - radius < bounds.low.z || at.z + radius > bounds.high.z;
  };
  return crowd.is_moving(each.island) && (leaves(each.a) || leaves(each.b));
}

template <class T>
void CrowdPairs<T>::find_outrun(const Crowd<T>& crowd, Team* team) {
  const auto count = static_cast<std::uint32_t>(bodies_.size());
  outrun_.clear();
  if (team == nullptr) {
    for (std::uint32_t i = 0; i < count; ++i)
      if (is_outrun(crowd, i)) outrun_.push_back(i);
    return;
  }
  is_outrun_.resize(count);
  team->for_parts([&](unsigned part) {
    for (std::uint32_t i = Team::begin_of(count, part, team->parts());
         i < Team::begin_of(count, part + 1, team->parts()); ++i)
      is_outrun_[i] = is_outrun(crowd, i);
  });
  for (std::uint32_t i = 0; i < count; ++i)
    if (is_outrun_[i] != 0) outrun_.push_back(i);
}

template <class T>
void CrowdPairs<T>::follow(std::span<LinkageState* const> cluster, const Crowd<T>& crowd,
                           const Surroundings& surroundings, const GroundNow& ground, double left,
                           Team* team) {
  left_ = left;
  find_outrun(crowd, team);
  for (const std::uint32_t i : outrun_) {
    const double fall = fall_in(*cluster[bodies_[i].island]->linkage, left) + margin_;
    widen(i, reach_of(crowd, surroundings, bodies_[i], left, fall));
  }
  find_more(cluster, crowd, surroundings, ground);
}

template <class T>
void CrowdPairs<T>::follow(std::span<LinkageState* const> cluster, const Crowd<T>& crowd,
                           const Surroundings& surroundings, const GroundNow& ground,
                           std::span<const Bounds> ways) {
  // What passes ground in the substep is found without pairs.
  if (!has_pairs_) return;
  outrun_.clear();
  for (std::uint32_t i = 0; i < ways.size(); ++i) {
    const Bounds& way = ways[i];
    if (way.is_empty() || !crowd.is_moving(island_of(i)) || bounds_[i].contains(way)) continue;
    // What is solved again may go somewhat farther.
    const Vec3 spread = way.high - way.low;
    widen(i, grown(way, (further - 1) * std::max({spread.x, spread.y, spread.z})));
    outrun_.push_back(i);
  }
  find_more(cluster, crowd, surroundings, ground);
}

/// Widens the bounds of a body or a hull.
template <class T>
void CrowdPairs<T>::widen(std::uint32_t number, const Bounds& by) {
  if (has_pairs_) hash_.remove(number, bounds_[number]);
  include(bounds_[number], by);
  if (has_pairs_) hash_.insert(number, bounds_[number]);
}

/// Adds what those may touch that are outrun, once their bounds are wide enough.
template <class T>
void CrowdPairs<T>::find_more(std::span<LinkageState* const> cluster, const Crowd<T>& crowd,
                              const Surroundings& surroundings, const GroundNow& ground) {
  if (outrun_.empty()) return;
  if (has_pairs_) find_more_pairs(cluster);
  const auto lines = static_cast<std::uint32_t>(bodies_.size());
  more_.clear();
  more_of_hulls_.clear();
  for (const std::uint32_t i : outrun_)
    if (i < lines)
      find_on_ground(crowd, surroundings, i, bounds_[i], filter_of(i), more_);
    else
      find_on_ground(crowd, surroundings, i - lines, bounds_[i], filter_of(i), more_of_hulls_);
  merge(on_ground_, more_);
  merge(hulls_on_ground_, more_of_hulls_);
  more_.clear();
  for (std::uint32_t i = 0; i < balls_.size(); ++i) {
    const Ball& each = balls_[i];
    if (each.body == none || !std::binary_search(outrun_.begin(), outrun_.end(), each.body)) continue;
    include(ball_bounds_[i], bounds_[each.body]);
    find_on_ground(crowd, surroundings, i, bounds_[each.body], each.ball->filter, more_);
  }
  merge(ends_on_ground_, more_);
  find_on_moving(crowd, ground, left_);
}

/// Returns the box `bounds` of an island's shape and what it reaches when ground carries it.
template <class T>
Bounds CrowdPairs<T>::carried(const Crowd<T>& crowd, const Surroundings& surroundings, std::uint32_t island,
                              const Bounds& bounds, const Filter& filter) const {
  if (!crowd.is_moving(island) || !surroundings.any_moves()) return bounds;
  return moved_by(surroundings.carried(moved_by(bounds, crowd.origin()), {&filter, 1}),
                  -1.0 * crowd.origin());
}

template <class T>
void CrowdPairs<T>::find_hulls(std::span<LinkageState* const> cluster, const Crowd<T>& crowd,
                               const Surroundings& surroundings, double dt, double margin) {
  hulls_.clear();
  for (std::uint32_t i = 0; i < cluster.size(); ++i) {
    const Linkage& linkage = *cluster[i]->linkage;
    const double fall = crowd.is_moving(i) ? fall_in(linkage, dt) + margin : 0;
    for (const Linkage::HullShape& shape : linkage.hulls()) {
      Hull& hull = hulls_.emplace_back(Hull{i, &shape, {}});
      Linkage::HullShape::Vectors particles, velocities;
      for (std::size_t k = 0; k < 4; ++k) {
        hull.at[k] = crowd.number_of(i, shape.particles[k]);
        particles[k] = crowd.origin() + crowd.position(hull.at[k]);
        velocities[k] = crowd.velocity(hull.at[k]);
      }
      Bounds around = nowhere;
      for (const std::array<double, 4>& corner : shape.corners) {
        const Bounds way = passed_through(weighted(corner, particles) - crowd.origin(),
                                          dt * weighted(corner, velocities), shape.radius + fall);
        include(around, way);
      }
      bounds_.push_back(carried(crowd, surroundings, i, around, shape.filter));
    }
  }
}

template <class T>
bool CrowdPairs<T>::may_meet(std::span<LinkageState* const> cluster, std::uint32_t i, std::uint32_t j) const {
  if (!bounds_[i].overlaps(bounds_[j])) return false;
  const std::uint32_t island = island_of(i);
  if (island == island_of(j)) {
    const auto lines = static_cast<std::uint32_t>(bodies_.size());
    if (i >= lines || j >= lines ||
        !cluster[island]->linkage->neighbors().may_touch(bodies_[i].number, bodies_[j].number))
      return false;
  }
  return plumb::may_touch(filter_of(i), filter_of(j));
}

template <class T>
void CrowdPairs<T>::find_pairs(std::span<LinkageState* const> cluster) {
  pairs_.clear();
  hull_pairs_.clear();
  const auto lines = static_cast<std::uint32_t>(bodies_.size());
  has_pairs_ = false;
  for (std::uint32_t i = 0; i < bounds_.size() && !has_pairs_; ++i)
    has_pairs_ = island_of(i) != island_of(0) || cluster[island_of(i)]->linkage->neighbors().any_may_touch();
  if (!has_pairs_) return;
  double sum = 0;
  for (const Bounds& each : bounds_)
    sum += std::max({each.high.x - each.low.x, each.high.y - each.low.y, each.high.z - each.low.z});
  hash_.start(sum / static_cast<double>(bounds_.size()), 4 * bounds_.size());
  for (std::uint32_t i = 0; i < bounds_.size(); ++i)
    hash_.find_and_insert(i, bounds_[i], [&](std::uint32_t j) {
      if (may_meet(cluster, i, j)) (i < lines ? pairs_ : hull_pairs_).push_back({j, i});
    });
  sort(pairs_);
  sort(hull_pairs_);
}

/// Adds pairs of what is outrun.
template <class T>
void CrowdPairs<T>::find_more_pairs(std::span<LinkageState* const> cluster) {
  const auto lines = static_cast<std::uint32_t>(bodies_.size());
  more_.clear();
  more_of_hulls_.clear();
  for (const std::uint32_t i : outrun_)
    hash_.find(bounds_[i], [&](std::uint32_t j) {
      if (i != j && may_meet(cluster, i, j))
        (std::max(i, j) < lines ? more_ : more_of_hulls_).push_back({std::min(i, j), std::max(i, j)});
    });
  merge(pairs_, more_);
  merge(hull_pairs_, more_of_hulls_);
}

/// Sorts pairs into others that are sorted, and leaves each of them once.
template <class T>
void CrowdPairs<T>::merge(std::vector<Pair>& into, std::vector<Pair>& more) {
  sort(more);
  merged_.clear();
  std::set_union(into.begin(), into.end(), more.begin(), more.end(), std::back_inserter(merged_), is_before);
  into.swap(merged_);
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
  for (std::uint32_t i = 0; i < balls_.size(); ++i) {
    const Bounds at = moved_by(ball_bounds_[i], crowd.origin());
    for (std::uint32_t p = 0; p < ground.planes().size(); ++p) {
      const Plane& plane = ground.planes()[p];
      if (height(met(at, ground.rate_of_plane(p)), plane) <= 0 &&
          plumb::may_touch(balls_[i].ball->filter, plane.filter))
        on_planes_.push_back({i, p});
    }
  }
  for (std::uint32_t i = 0; i < bodies_.size(); ++i) {
    if (!crowd.is_moving(bodies_[i].island)) continue;
    const Bounds at = moved_by(bounds_[i], crowd.origin());
    const Filter& filter = bodies_[i].shape->filter;
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

/// Finds who may touch all other ground.
template <class T>
void CrowdPairs<T>::find_on_ground(const Crowd<T>& crowd, const Surroundings& surroundings) {
  on_ground_.clear();
  ends_on_ground_.clear();
  hulls_on_ground_.clear();
  for (std::uint32_t i = 0; i < balls_.size(); ++i)
    if (const Ball& each = balls_[i]; each.body != none)
      find_on_ground(crowd, surroundings, i, bounds_[each.body], each.ball->filter, ends_on_ground_);
  const auto lines = static_cast<std::uint32_t>(bodies_.size());
  for (std::uint32_t i = 0; i < bounds_.size(); ++i) {
    if (!crowd.is_moving(island_of(i))) continue;
    if (i < lines)
      find_on_ground(crowd, surroundings, i, bounds_[i], filter_of(i), on_ground_);
    else
      find_on_ground(crowd, surroundings, i - lines, bounds_[i], filter_of(i), hulls_on_ground_);
  }
}

/// Adds what of such ground reaches into a box, from the crowd's origin, as what `number` may touch.
template <class T>
void CrowdPairs<T>::find_on_ground(const Crowd<T>& crowd, const Surroundings& surroundings,
                                   std::uint32_t number, const Bounds& around, const Filter& filter,
                                   std::vector<Pair>& to) {
  if (surroundings.tree.is_empty()) return;
  const Bounds at = moved_by(around, crowd.origin());
  surroundings.find(at, near_);
  for (const std::uint32_t shape : near_)
    if (surroundings.shapes[shape].reaches_into(at) &&
        plumb::may_touch(filter, surroundings.filter_of(shape)))
      to.push_back({number, shape});
}

template class CrowdPairs<float>;
template class CrowdPairs<double>;

}  // namespace plumb::detail
