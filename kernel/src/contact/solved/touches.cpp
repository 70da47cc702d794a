// This file finds where islands touch ground that is not a plane, and where their hulls touch others.

#include <algorithm>
#include <cmath>
#include <utility>

#include "contact/ground/ground_search.hpp"
#include "contact/ground/placed_hulls.hpp"
#include "contact/solved/cluster_limits.hpp"
#include "contact/solved/cluster_stepper.hpp"

namespace plumb::detail {
using namespace contact_limits;

/// Returns how a shape moves in the substep.
MovingSegment ClusterStepper::motion_of(const Island& island, const Linkage::Shape& shape) {
  const std::span<const Vec3> x = island.state->x;
  return {{shape.a.of(x), shape.b.of(x), shape.radius}, shape.a.of(island.d), shape.b.of(island.d)};
}

/// Returns how an island's hull moves in the substep.
MovingHullShape ClusterStepper::hull_motion(Island& island, std::uint32_t hull) {
  return island.hulls.moving(hull, island.hulls.shape(hull).of(island.d));
}

/// Returns the side of a contact that is on ground.
ClusterStepper::Place ClusterStepper::place_on(std::uint32_t ground) const {
  const GroundShape& shape = surroundings_->shapes[ground];
  const GroundRate* const rate =
      shape.box() == GroundShape::none ? nullptr : ground_.rate_of_box(shape.box());
  return {none, no_particles, shape.surface(), surroundings_->number_of(ground), rate, std::nullopt};
}

void ClusterStepper::touch_ground(std::uint32_t i, double h) {
  const Surroundings& surroundings = *surroundings_;
  Island& island = islands_[i];
  const Linkage& linkage = *island.state->linkage;
  Bounds bounds = island.bounds;
  const double further = in_sight(island.moves, settings_.length_scale);
  include(bounds, bounds.low, further);
  include(bounds, bounds.high, further);
  surroundings.find(bounds, near_ground_);
  const GroundSearch search{settings_.margin, settings_.tolerance};
  for (const std::uint32_t ground : near_ground_) {
    const Place other = place_on(ground);
    const Place on_line{none,        no_particles, other.surface,
                        other.shape, other.rate,   surroundings.shapes[ground].capsule()};
    const Filter& filter = surroundings.shapes[ground].filter();
    touch_ends(i, ground, h);
    for (std::uint32_t k = 0; k < linkage.shapes().size(); ++k) {
      const Linkage::Shape& shape = linkage.shapes()[k];
      if (!plumb::may_touch(shape.filter, filter)) continue;
      const auto add = [&](std::uint64_t key, const Touch& touch) {
        add_contact({i, blend(shape.a, shape.b, touch.a), shape.surface, k}, on_line, touch, key, h);
      };
      for_line_touches(surroundings, ground, motion_of(island, shape), k, search, add);
    }
    for (std::uint32_t k = 0; k < island.hulls.size(); ++k) {
      const Linkage::HullShape& hull = linkage.hulls()[k];
      if (!plumb::may_touch(hull.filter, filter)) continue;
      const auto add = [&](std::uint64_t key, const Combination& at, const Touch& touch) {
        add_contact({i, at, hull.surface, hull.number}, other, touch, key, h);
      };
      for_hull_touches(surroundings, ground, hull_motion(island, k), search, add);
    }
  }
  for (const MissedGround& each : missed_ground_)
    if (each.island == i)
      add_contact({i, each.at, linkage.shape_of(each.shape).surface, each.shape}, place_on(each.ground),
                  each.touch, ground_key(GroundPart::missed, each.shape, each.ground, each.number), h);
}

/// Ends of shapes are kept off as balls, which neighbours share.
void ClusterStepper::touch_ends(std::uint32_t i, std::uint32_t ground, double h) {
  const Surroundings& surroundings = *surroundings_;
  const Island& island = islands_[i];
  const Linkage& linkage = *island.state->linkage;
  const std::span<const Vec3> x = island.state->x;
  for (std::uint32_t k = 0; k < linkage.balls().size(); ++k) {
    const Linkage::Ball& ball = linkage.balls()[k];
    if (ball.shape >= linkage.shapes().size()) break;  // corners of hulls
    if (!plumb::may_touch(ball.filter, surroundings.shapes[ground].filter())) continue;
    const Linkage::Shape& shape = linkage.shapes()[ball.shape];
    const MovingEnd end{ball.center.of(x), 0.5 * (shape.a.of(x) + shape.b.of(x)), ball.radius,
                        norm(ball.center.of(island.d))};
    for_end_touches(
        surroundings, ground, end, k, {settings_.margin, settings_.tolerance},
        [&](std::uint64_t key, const Touch& touch) {
          add_contact({i, ball.center, ball.surface, ball.shape}, place_on(ground), touch, key, h);
        });
  }
}

/// Returns whether the line of a shape, or a hull, goes through ground on its way from `there` to where the
/// island is.
bool ClusterStepper::passes_ground(const Island& island, const Surroundings& surroundings) {
  if (surroundings.tree.is_empty()) return false;
  const GroundSearch search{0, settings_.tolerance};
  const std::span<const Vec3> from = island.there, to = island.state->x;
  const auto meets = [&](const auto& moving, const Filter& filter) {
    surroundings.find(bounds_of(moving), near_ground_);
    return std::any_of(near_ground_.begin(), near_ground_.end(), [&](std::uint32_t ground) {
      return plumb::may_touch(filter, surroundings.shapes[ground].filter()) &&
             surroundings.shapes[ground].first_touch(moving, search.close);
    });
  };
  for (const Linkage::Shape& shape : island.state->linkage->shapes()) {
    const Vec3 p = shape.a.of(from), q = shape.b.of(from);
    const MovingSegment moving{{p, q, 0}, shape.a.of(to) - p, shape.b.of(to) - q};
    if (search.is_fast(moves_of(moving), shape.radius) && meets(moving, shape.filter)) return true;
  }
  PlacedHulls hulls;
  for (const Linkage::HullShape& hull : island.state->linkage->hulls()) {
    const Linkage::HullShape::Vectors start = hull.of(from);
    Linkage::HullShape::Vectors by = hull.of(to);
    for (std::size_t k = 0; k < by.size(); ++k) by[k] -= start[k];
    hulls.clear();
    hulls.add(hull, start);
    const MovingHullShape moving = hulls.moving(0, by);
    if (search.is_fast(moving.moves(), hull.half_width) && meets(moving.hull, hull.filter)) return true;
  }
  return false;
}

/// Finds shapes that went into ground where it was not expected, because others pushed them. They keep off it
/// when positions are sought again. Returns whether there are any.
bool ClusterStepper::find_missed_ground() {
  const Surroundings& surroundings = *surroundings_;
  if (surroundings.tree.is_empty()) return false;
  const std::size_t before = missed_ground_.size();
  const GroundSearch search{settings_.margin, settings_.tolerance};
  for (std::uint32_t i = 0; i < count_; ++i) {
    Island& island = islands_[i];
    if (!island.awake) continue;
    const Linkage& linkage = *island.state->linkage;
    const auto miss = [&](std::uint32_t shape, std::uint32_t ground, const Combination& at,
                          const Touch& plane, double time) {
      if (plumb::may_touch(linkage.shape_of(shape).filter, surroundings.shapes[ground].filter()) &&
          is_missed(plane, time, settings_.tolerance))
        missed_ground_.push_back(
            {i, shape, ground, static_cast<std::uint32_t>(missed_ground_.size()), at, plane});
    };
    for (std::uint32_t k = 0; k < linkage.shapes().size(); ++k) {
      const Linkage::Shape& shape = linkage.shapes()[k];
      const MovingSegment moving = motion_of(island, shape);
      if (!search.is_fast(moves_of(moving), shape.radius)) continue;
      surroundings.find(bounds_of(moving), near_ground_);
      for (const std::uint32_t ground : near_ground_)
        for_first_touches(surroundings, ground, moving, search,
                          [&](std::uint64_t, const Touch& plane, double time) {
                            miss(k, ground, blend(shape.a, shape.b, plane.a), plane, time);
                          });
    }
    for (std::uint32_t k = 0; k < island.hulls.size(); ++k) {
      const MovingHullShape moving = hull_motion(island, k);
      if (!search.is_fast(moving.moves(), moving.shape.half_width)) continue;
      surroundings.find(bounds_of(moving.hull), near_ground_);
      for (const std::uint32_t ground : near_ground_)
        for_first_touches(surroundings, ground, moving, search,
                          [&](std::uint64_t, const Combination& at, const Touch& plane, double time) {
                            miss(moving.shape.number, ground, at, plane, time);
                          });
    }
  }
  return missed_ground_.size() > before;
}

void ClusterStepper::place_hulls(Island& island) {
  island.hulls.clear();
  for (const Linkage::HullShape& hull : island.state->linkage->hulls())
    island.hulls.add(hull, hull.of(island.state->x));
}

/// Returns a shape of an island, or a hull, by its number.
PlacedShape ClusterStepper::placed(Island& island, std::uint32_t number) {
  const std::span<const Linkage::Shape> shapes = island.state->linkage->shapes();
  const auto lines = static_cast<std::uint32_t>(shapes.size());
  if (number >= lines) return {island.hulls, number - lines};
  const Linkage::Shape& shape = shapes[number];
  return {shape, number, shape.a.of(island.state->x), shape.b.of(island.state->x)};
}

/// Finds where hulls of two islands touch each other and capsules.
void ClusterStepper::touch_island_hulls(std::uint32_t i, std::uint32_t j, double h) {
  Island &own = islands_[i], &other = islands_[j];
  const double reach = settings_.margin + own.moves + other.moves;
  const auto count = [](const Island& island) {
    const auto lines = static_cast<std::uint32_t>(island.state->linkage->shapes().size());
    return std::pair{lines, lines + island.hulls.size()};
  };
  const auto [own_lines, own_end] = count(own);
  const auto [other_lines, other_end] = count(other);
  for (std::uint32_t k = 0; k < own_end; ++k) {
    const PlacedShape a = placed(own, k);
    for (std::uint32_t l = k < own_lines ? other_lines : 0; l < other_end; ++l) {
      if (!plumb::may_touch(own.state->linkage->shape_of(k).filter, other.state->linkage->shape_of(l).filter))
        continue;
      const PlacedShape b = placed(other, l);
      for_pair_touches(
          a, b, reach, other.state->number,
          [&](std::uint64_t key, const Combination& at_a, const Combination& at_b, const Touch& touch) {
            add_contact({i, at_a, *a.surface, a.number}, {j, at_b, *b.surface, b.number}, touch, key, h);
          });
    }
  }
}

}  // namespace plumb::detail
