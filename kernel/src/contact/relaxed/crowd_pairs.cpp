#include "contact/relaxed/crowd_pairs.hpp"

#include <algorithm>

#include "contact/linkage/linkage_bounds.hpp"

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

Bounds moved_by(const Bounds& bounds, Vec3 by) {
  return {bounds.low + by, bounds.high + by};
}

}  // namespace

template <class T>
void CrowdPairs<T>::find(std::span<LinkageState* const> cluster, const Crowd<T>& crowd,
                         const Surroundings& surroundings, const GroundNow& ground, double dt,
                         double margin) {
  find_shapes(cluster, crowd, surroundings, dt, margin);
  find_pairs();
  find_on_ground(crowd, ground, dt);
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
  double fastest = 0;
  for (std::uint32_t i = 0; i < cluster.size(); ++i)
    if (crowd.is_moving(i)) fastest = std::max(fastest, top_speed(*cluster[i]));
  for (std::uint32_t i = 0; i < cluster.size(); ++i) {
    const Linkage& linkage = *cluster[i]->linkage;
    const double fall = 0.5 * dt * dt * norm(linkage.gravity()) + margin;
    const auto add_terms = [&](const Combination& sum) {
      const auto first = static_cast<std::uint32_t>(ends_.size());
      crowd.add_terms(linkage, i, sum, 1, ends_);
      return TermRange{first, static_cast<std::uint32_t>(ends_.size())};
    };
    const auto reach_of = [&](TermRange range, double radius) {
      const auto terms = terms_of(range);
      return passed_through(crowd.position(terms), dt * crowd.velocity(terms),
                            radius + (crowd.is_moving(i) ? fall : 0));
    };
    const auto carried = [&](const Bounds& bounds, const Filter& filter) {
      if (!crowd.is_moving(i) || !surroundings.any_moves()) return bounds;
      return moved_by(surroundings.carried(moved_by(bounds, crowd.origin()), {&filter, 1}),
                      -1.0 * crowd.origin());
    };
    for (std::uint32_t k = 0; k < linkage.shapes().size(); ++k) {
      const Linkage::Shape& shape = linkage.shapes()[k];
      const TermRange a = add_terms(shape.a), b = add_terms(shape.b);
      bodies_.push_back({i, k, &shape, a, b});
      Bounds around = reach_of(a, shape.radius);
      const Bounds other = reach_of(b, shape.radius);
      include(around, other.low, 0);
      include(around, other.high, 0);
      bounds_.push_back(carried(around, shape.filter));
    }
    if (!crowd.is_moving(i)) continue;
    for (std::uint32_t k = 0; k < linkage.balls().size(); ++k) {
      const Linkage::Ball& ball = linkage.balls()[k];
      balls_.push_back({i, k, &ball, add_terms(ball.center)});
      ball_bounds_.push_back(
          carried(reach_of(balls_.back().center, ball.radius + dt * fastest), ball.filter));
    }
  }
}

template <class T>
void CrowdPairs<T>::find_pairs() {
  pairs_.clear();
  if (bodies_.empty() || bodies_.front().island == bodies_.back().island) return;
  double sum = 0;
  for (const Bounds& each : bounds_)
    sum += std::max({each.high.x - each.low.x, each.high.y - each.low.y, each.high.z - each.low.z});
  hash_.start(sum / static_cast<double>(bounds_.size()), 4 * bounds_.size());
  for (std::uint32_t i = 0; i < bodies_.size(); ++i)
    hash_.find_and_insert(i, bounds_[i], [&](std::uint32_t j) {
      if (bodies_[i].island != bodies_[j].island && bounds_[i].overlaps(bounds_[j]) &&
          plumb::may_touch(bodies_[i].shape->filter, bodies_[j].shape->filter))
        pairs_.push_back({j, i});
    });
  const auto number = [](const Pair& pair) { return std::uint64_t{pair.one} << 32 | pair.other; };
  std::sort(pairs_.begin(), pairs_.end(),
            [&](const Pair& a, const Pair& b) { return number(a) < number(b); });
  pairs_.erase(std::unique(pairs_.begin(), pairs_.end(),
                           [&](const Pair& a, const Pair& b) { return number(a) == number(b); }),
               pairs_.end());
}

template <class T>
void CrowdPairs<T>::find_on_ground(const Crowd<T>& crowd, const GroundNow& ground, double dt) {
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
      if (box.bounds.overlaps(met(at, ground.rate_of_box(b))) && plumb::may_touch(filter, box.filter))
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

template class CrowdPairs<float>;
template class CrowdPairs<double>;

}  // namespace plumb::detail
