#include "contact/relaxed/pairs/crowd_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include "contact/linkage/linkage_bounds.hpp"
#include "contact/relaxed/pairs/ways.hpp"
#include "scene/barycentric.hpp"

namespace plumb::detail {
template <class T>
void CrowdPairs<T>::find(std::span<LinkageState* const> cluster, const Crowd<T>& crowd,
                         const Surroundings& surroundings, const GroundNow& ground, double dt) {
  left_ = dt;
  list_shapes(cluster, crowd);
  thrown_.clear();
  for (std::uint32_t i = 0; i < cluster.size(); ++i)
    thrown_.push_back(crowd.is_moving(i) ? cluster[i]->throw_by_elastics(dt) : 0);
  follows_lines_ = has_pairs_ || !are_kept_out_by_ends(crowd, surroundings, ground);
  find_shapes(cluster, crowd, surroundings, dt);
  find_hulls(cluster, crowd, surroundings, dt);
  find_pairs(cluster);
  find_on_moving(crowd, ground, dt);
  find_on_ground(crowd, surroundings);
  plain_ends_.clear();
  more_plain_ends_.clear();
  find_plain_ends(crowd, surroundings, ground, plain_ends_);
}

/// Lists the shapes of a crowd, unless they are those of the last time.
template <class T>
void CrowdPairs<T>::list_shapes(std::span<LinkageState* const> cluster, const Crowd<T>& crowd) {
  if (layout_ == crowd.layout() && std::equal(cluster.begin(), cluster.end(), listed_.begin(), listed_.end()))
    return;
  layout_ = crowd.layout();
  stride_ = crowd.places().component_stride();
  // What is no place of a particle stays 0 there, as it does in positions.
  low_.assign(crowd.places().numbers(), 0);
  high_.assign(crowd.places().numbers(), 0);
  listed_.assign(cluster.begin(), cluster.end());
  ends_.clear();
  bodies_.clear();
  balls_.clear();
  are_lines_plain_ = true;
  has_pairs_ = cluster.size() > 1 || cluster.front()->linkage->neighbors().any_may_touch();
  least_radius_ = INFINITY;
  largest_radius_ = 0;
  most_weight_ = 1;
  for (std::uint32_t i = 0; i < cluster.size(); ++i) {
    const Linkage& linkage = *cluster[i]->linkage;
    const auto first_body = static_cast<std::uint32_t>(bodies_.size());
    const auto add_terms = [&](Terms sum) {
      const auto first = static_cast<std::uint32_t>(ends_.size());
      crowd.add_terms(linkage, i, sum, 1, ends_);
      double weight = 0;
      for (const auto& term : sum) weight += std::abs(term.weight);
      most_weight_ = std::max(most_weight_, weight);
      return TermRange{first, static_cast<std::uint32_t>(ends_.size())};
    };
    const auto place_of = [&](Terms sum) {
      const bool is_particle = sum.size() == 1 && sum[0].weight == 1;
      return is_particle ? crowd.number_of(i, sum[0].particle) : none;
    };
    for (std::uint32_t k = 0; k < linkage.shapes().size(); ++k) {
      const Linkage::Shape& shape = linkage.shapes()[k];
      const TermRange a = add_terms(shape.a), b = add_terms(shape.b);
      bodies_.push_back({i,
                         k,
                         &shape,
                         a,
                         b,
                         {place_of(shape.a), place_of(shape.b)},
                         shape.radius,
                         shape.turning == Linkage::Shape::Turning::body});
      are_lines_plain_ = are_lines_plain_ && bodies_.back().is_plain();
      least_radius_ = std::min(least_radius_, shape.radius);
      largest_radius_ = std::max(largest_radius_, shape.radius);
    }
    if (!crowd.is_moving(i)) continue;
    for (std::uint32_t k = 0; k < linkage.balls().size(); ++k) {
      const Linkage::Ball& ball = linkage.balls()[k];
      const std::uint32_t body = ball.shape < linkage.shapes().size() ? first_body + ball.shape : none;
      const bool is_plain = body != none && place_of(ball.center) != none &&
                            crowd.inverse_mass(i, ball.center[0].particle) > 0 &&
                            linkage.shape_of(ball.shape).turning != Linkage::Shape::Turning::body;
      balls_.push_back({i, k, &ball, add_terms(ball.center), body, is_plain});
    }
  }
  compare_shapes(crowd);
}

/// Lists for every particle which lines end there.
template <class T>
void CrowdPairs<T>::list_lines(const CrowdPlaces& places) {
  other_lines_.clear();
  first_line_.assign(places.particles() + 2, 0);
  for (const Body& body : bodies_)
    if (body.is_plain())
      for (const std::uint32_t at : body.at) ++first_line_[places.particle_at(at) + 2];
  std::partial_sum(first_line_.begin(), first_line_.end(), first_line_.begin());
  lines_at_.resize(first_line_.back());
  for (std::uint32_t i = 0; i < bodies_.size(); ++i) {
    if (!bodies_[i].is_plain()) {
      other_lines_.push_back(i);
      continue;
    }
    for (const std::uint32_t at : bodies_[i].at) lines_at_[first_line_[places.particle_at(at) + 1]++] = i;
  }
}

/// Lists where bodies end, and finds whether they differ in nothing else.
template <class T>
void CrowdPairs<T>::compare_shapes(const Crowd<T>& crowd) {
  list_lines(crowd.places());
  are_alike_ = are_lines_plain_ && least_radius_ == largest_radius_;
  for (std::uint32_t k = 0; are_alike_ && k < crowd.places().particles(); ++k)
    are_alike_ = !lines_at(k).empty();
}

template <class T>
double CrowdPairs<T>::longest_line(const Crowd<T>& crowd) const {
  double square = 0;
  for (const Body& body : bodies_) {
    if (!body.is_plain()) continue;
    const Vec3 along = crowd.position(body.at[1]) - crowd.position(body.at[0]);
    square = std::max(square, dot(along, along));
  }
  return std::sqrt(square);
}

template <class T>
void CrowdPairs<T>::find_shapes(std::span<LinkageState* const> cluster, const Crowd<T>& crowd,
                                const Surroundings& surroundings, double dt) {
  bounds_.clear();
  ball_bounds_.clear();
  // A blow may make any of them as fast as the fastest. To look at planes costs little.
  fastest_ = 0;
  for (std::uint32_t i = 0; i < cluster.size(); ++i)
    if (crowd.is_moving(i)) fastest_ = std::max(fastest_, top_speed(*cluster[i]));
  slack_ = dt * fastest_;
  bound_particles(cluster, crowd, dt, follows_lines_ ? 0 : slack_);
  if (!follows_lines_) {
    for (const Ball& each : balls_)
      ball_bounds_.push_back(grown(particle_bounds(place_of(each)), each.ball->radius));
    return;
  }
  for (const Body& body : bodies_) {
    const bool moves = crowd.is_moving(body.island);
    if (!body.is_plain()) {
      const double fall =
          moves ? fall_in(*cluster[body.island]->linkage, dt) + margin_ + thrown_[body.island] : 0;
      bounds_.push_back(reach_of(crowd, surroundings, body, dt, fall));
      continue;
    }
    Bounds around = particle_bounds(body.at[0]);
    include(around, particle_bounds(body.at[1]));
    bounds_.push_back(
        carried(crowd, surroundings, body.island, grown(around, body.shape->radius), body.shape->filter));
  }
  for (const Ball& each : balls_) {
    const Linkage::Ball& ball = *each.ball;
    const double fall = fall_in(*cluster[each.island]->linkage, dt) + margin_ + thrown_[each.island];
    const Bounds around = reach_of(crowd, each.center, ball.radius + dt * fastest_ + fall, dt);
    ball_bounds_.push_back(carried(crowd, surroundings, each.island, around, ball.filter));
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
  if (each.is_plain())
    return std::any_of(each.at.begin(), each.at.end(), [&](std::uint32_t at) {
      const Vec3 there = crowd.position(at) + crowd.moved(at);
      return !particle_bounds(at).contains({there, there});
    });
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
  if (are_lines_plain_ && are_in_bounds(crowd)) return;
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
  more_plain_ends_.clear();
  if (!follows_lines_) return follow_ends(cluster, crowd, surroundings, ground);
  find_outrun(crowd, team);
  for (const std::uint32_t i : outrun_) {
    const std::uint32_t island = bodies_[i].island;
    const double fall = fall_in(*cluster[island]->linkage, left) + margin_ + thrown_[island];
    widen(i, reach_of(crowd, surroundings, bodies_[i], left, fall));
    for (const std::uint32_t at : bodies_[i].at)
      if (at != none)
        include_particle(at, passed_through(crowd.position(at), left * crowd.velocity(at), fall));
  }
  find_more(cluster, crowd, surroundings, ground);
}

template <class T>
void CrowdPairs<T>::follow(std::span<LinkageState* const> cluster, const Crowd<T>& crowd,
                           const Surroundings& surroundings, const GroundNow& ground,
                           std::span<const Bounds> ways) {
  more_plain_ends_.clear();
  // What passes ground in the substep is found without pairs, and what is not hit is not thrown at planes.
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
      find_line_on_ground(crowd, surroundings, i, more_);
    else
      find_hull_on_ground(crowd, surroundings, i, more_of_hulls_);
  merge(on_ground_, more_);
  merge(hulls_on_ground_, more_of_hulls_);
  more_.clear();
  for (std::uint32_t i = 0; i < balls_.size(); ++i) {
    const Ball& each = balls_[i];
    if (each.body == none || !std::binary_search(outrun_.begin(), outrun_.end(), each.body)) continue;
    include(ball_bounds_[i], bounds_[each.body]);
    find_end_on_ground(crowd, surroundings, i, more_);
  }
  merge(ends_on_ground_, more_);
  find_on_moving(crowd, ground, left_);
  find_more_plain_ends(crowd, surroundings, ground);
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
                               const Surroundings& surroundings, double dt) {
  hulls_.clear();
  for (std::uint32_t i = 0; i < cluster.size(); ++i) {
    const Linkage& linkage = *cluster[i]->linkage;
    const double fall = crowd.is_moving(i) ? fall_in(linkage, dt) + margin_ + thrown_[i] : 0;
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
  const std::uint32_t island = island_of(i), other = island_of(j);
  const auto lines = static_cast<std::uint32_t>(bodies_.size());
  const bool are_lines = i < lines && j < lines;
  if (island == other &&
      !(are_lines && cluster[island]->linkage->neighbors().may_touch(bodies_[i].number, bodies_[j].number)))
    return false;
  if (island != other && are_lines &&
      hang_together(*cluster[island], bodies_[i].number, *cluster[other], bodies_[j].number))
    return false;
  return plumb::may_touch(filter_of(i), filter_of(j));
}

template <class T>
void CrowdPairs<T>::find_pairs(std::span<LinkageState* const> cluster) {
  pairs_.clear();
  hull_pairs_.clear();
  const auto lines = static_cast<std::uint32_t>(bodies_.size());
  if (!has_pairs_ || bounds_.empty()) return;
  double sum = 0;
  for (const Bounds& each : bounds_)
    sum += std::max({each.high.x - each.low.x, each.high.y - each.low.y, each.high.z - each.low.z});
  hash_.start(sum / static_cast<double>(bounds_.size()), 4 * bounds_.size());
  seen_.assign(bounds_.size(), none);
  for (std::uint32_t i = 0; i < bounds_.size(); ++i)
    hash_.find_and_insert(i, bounds_[i], [&](std::uint32_t j) {
      if (std::exchange(seen_[j], i) == i) return;  // in another cell
      if (may_meet(cluster, i, j)) (i < lines ? pairs_ : hull_pairs_).push_back({j, i});
    });
  const auto count = static_cast<std::uint32_t>(bounds_.size());
  order_.sort(pairs_, &Pair::one, count);
  order_.sort(hull_pairs_, &Pair::one, count);
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
void CrowdPairs<T>::merge(Array<Pair>& into, Array<Pair>& more) {
  std::sort(more.begin(), more.end(), is_before);
  more.erase(std::unique(more.begin(), more.end()), more.end());
  merged_.clear();
  std::set_union(into.begin(), into.end(), more.begin(), more.end(), std::back_inserter(merged_), is_before);
  into.swap(merged_);
}

template class CrowdPairs<float>;
template class CrowdPairs<double>;

}  // namespace plumb::detail
