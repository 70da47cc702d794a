#include "contact/surroundings.hpp"

#include <algorithm>
#include <cmath>

namespace plumb::detail {
namespace {

/// These are shares of `close`, within which solids lie against each other. A place that lies on a surface is
/// off it by no more than the first of these, which is far above rounding. Where the surface was only touched
/// nearby, it is off by no more than the second.
constexpr double on_surface = 1e-6, on_surface_nearby = 1e-3;
/// A surface is looked at so many times `close` from a place, which is far beyond what lies against it, and
/// is still the same spot: 1 mm where `close` is the 10 µm of ContactSettings::tolerance.
constexpr double aside = 100;
/// What is so many times `close` in front of a surface is in another solid if it is nearer to that than this.
/// It is halfway: the surface is one `close` away.
constexpr double in_front = 0.5;
/// Faces of two solids that meet at an angle of less than this (rad) go on into each other.
constexpr double flat_enough = 1e-3;
/// Directions with a lower cosine than this lead against each other.
constexpr double opposed = -0.5;

/// A box around a solid box.
Bounds bounds_of(Vec3 center, Vec3 half, const Frame3& frame) {
  const auto far = [&](double a, double b, double c) {
    return std::abs(a) * half.x + std::abs(b) * half.y + std::abs(c) * half.z;
  };
  const Vec3 most{far(frame.x.x, frame.y.x, frame.z.x), far(frame.x.y, frame.y.y, frame.z.y),
                  far(frame.x.z, frame.y.z, frame.z.z)};
  return {center - most, center + most};
}

bool may_move(const GroundMotion& motion) {
  return motion.platform || motion.belt != Vec3{};
}

}  // namespace

Surroundings::Surroundings(const Scene& scene)
    : planes(scene.planes.begin(), scene.planes.end()), platforms(scene), anchored(scene), numbers(scene) {
  for (const Box& box : scene.boxes) {
    const Frame3 frame = frame_of(box.orientation);
    boxes.push_back({box.center, box.half_size, frame, bounds_of(box.center, box.half_size, frame),
                     box.surface, box.filter, box.motion});
    if (!box.motion.platform) shapes.emplace_back(box, static_cast<std::uint32_t>(boxes.size() - 1));
    if (box.motion.platform && cube.is_empty()) cube = unit_cube();
  }
  standing_boxes_ = static_cast<std::uint32_t>(shapes.size());
  for (const GroundCapsule& each : scene.ground_capsules) shapes.emplace_back(each);
  for (const GroundHull& each : scene.ground_hulls) shapes.emplace_back(each);
  for (const GroundMesh& each : scene.meshes) shapes.emplace_back(each);
  for (const HeightField& each : scene.height_fields) shapes.emplace_back(each);
  Array<Bounds> around;
  for (const GroundShape& each : shapes) around.push_back(each.bounds());
  tree = BoundsTree(around);
  const auto moves = [](const auto& ground) { return detail::may_move(ground.motion); };
  may_move_ = std::any_of(planes.begin(), planes.end(), moves) ||
              std::any_of(boxes.begin(), boxes.end(), moves) || !anchored.shapes().empty();
}

void Surroundings::begin_step(double dt) {
  dt_ = dt;
  platforms.begin_step(dt);
  const auto has_belt = [](const auto& ground) { return ground.motion.belt != Vec3{}; };
  moves_ = platforms.any_moves() || anchored.any_moves() ||
           std::any_of(planes.begin(), planes.end(), has_belt) ||
           std::any_of(boxes.begin(), boxes.end(), has_belt);
}

template <class F>
bool Surroundings::any_ground(const Bounds& bounds, std::span<const Filter> filters, F&& f) const {
  const auto see = [&](const auto& ground, auto&& reaches) {
    if (!detail::may_touch(filters, ground.filter)) return false;
    const Vec3 belt = ground.motion.belt;
    if (!ground.motion.platform) return f(0.0, belt, [&](const Bounds& at) { return reaches(at, ground); });
    const PlatformPose pose = platforms.at(*ground.motion.platform, 0);
    const double speed = fastest(pose.rate, bounds, dt_);
    return f(speed, belt, [&](const Bounds& at) { return reaches(at, posed(ground, pose)); });
  };
  const auto above = [](const Bounds& at, const Plane& plane) { return height(at, plane) <= 0; };
  const auto beside = [](const Bounds& at, const Solid& box) { return box.bounds.overlaps(at); };
  if (std::any_of(planes.begin(), planes.end(), [&](const Plane& plane) { return see(plane, above); }) ||
      std::any_of(boxes.begin(), boxes.end(), [&](const Solid& box) { return see(box, beside); }))
    return true;
  const std::span<const Linkage::Shape> others = anchored.shapes();
  for (std::size_t i = 0; i < others.size(); ++i) {
    if (!detail::may_touch(filters, others[i].filter)) continue;
    const GroundRate rate = anchored.rate(i, anchored.positions());
    const auto reaches = [&](const Bounds& at) { return anchored.bounds(i).overlaps(at); };
    if (f(fastest(rate, bounds, dt_), rate.belt, reaches)) return true;
  }
  return false;
}

bool Surroundings::reach_into(const Bounds& bounds, std::span<const Filter> filters) const {
  bool any = false;
  tree.find(bounds, [&](std::uint32_t i) {
    any = any || (detail::may_touch(filters, shapes[i].filter()) && shapes[i].reaches_into(bounds));
  });
  return any || any_ground(bounds, filters, [&](double speed, Vec3, auto&& reaches) {
           return reaches(speed > 0 ? grown(bounds, speed * dt_) : bounds);
         });
}

bool Surroundings::move_under(const Bounds& bounds, std::span<const Filter> filters) const {
  if (!moves_) return false;
  return any_ground(bounds, filters, [&](double speed, Vec3 belt, auto&& reaches) {
    return (speed > 0 || belt != Vec3{}) && reaches(grown(bounds, speed * dt_));
  });
}

double Surroundings::speed_under(const Bounds& bounds, std::span<const Filter> filters) const {
  if (!moves_) return 0;
  double most = 0;
  any_ground(bounds, filters, [&](double speed, Vec3 belt, auto&& reaches) {
    const double surface = speed + norm(belt);
    if (surface > most && reaches(grown(bounds, speed * dt_))) most = surface;
    return false;
  });
  return most;
}

Bounds Surroundings::carried(const Bounds& bounds, std::span<const Filter> filters) const {
  return moves_ ? grown(bounds, speed_under(bounds, filters) * dt_) : bounds;
}

void Surroundings::find(const Bounds& bounds, Array<std::uint32_t>& out) const {
  out.clear();
  tree.find(bounds, [&](std::uint32_t i) {
    if (shapes[i].bounds().overlaps(bounds)) out.push_back(i);
  });
  std::sort(out.begin(), out.end());
}

bool Surroundings::is_within(std::uint32_t but, Vec3 place, double near) const {
  Bounds around = nowhere;
  include(around, place, near);
  bool out = false;
  tree.find(around, [&](std::uint32_t i) {
    const GroundShape& shape = shapes[i];
    out = out ||
          (i != but && shape.is_convex() && shape.bounds().overlaps(around) && shape.distance(place) <= near);
  });
  return out;
}

/// Returns whether the surface of a shape goes on where another one that lies against it ends, so that both
/// form a corner: a wall on a floor. `normal` is the surface's at a place of both.
bool Surroundings::goes_on(std::uint32_t shape, const GroundShape& other, Vec3 at, Vec3 normal,
                           double close) const {
  bool out = false;
  other.for_normals(at, close, [&](Vec3 n) {
    const Vec3 along = n - dot(n, normal) * normal;
    const double size = norm(along);
    if (out || !(size > flat_enough)) return;
    const Vec3 next = at + (aside * close / size) * along;
    out = shapes[shape].distance(next) <= on_surface * close &&
          !is_within(shape, next + close * normal, in_front * close);
  });
  return out;
}

bool Surroundings::is_flat(std::uint32_t shape, Vec3 at, Vec3 along, double close) const {
  const double length = norm(along);
  if (!(length > 0)) return true;
  for (const double side : {-1.0, 1.0}) {
    const Vec3 next = at + (side * aside * close / length) * along;
    const bool is_on =
        shapes[shape].distance(next) <= on_surface_nearby * close || is_within(shape, next, close);
    if (!is_on) return false;
  }
  return true;
}

/// Returns whether a face of a solid, which looks along `normal` from a place on it, leads into the plane or
/// the landscape that the solid stands on.
bool Surroundings::leads_down(Vec3 at, Vec3 normal, double close) const {
  const auto is_under = [&](const Plane& plane) {
    return !plane.motion.platform && dot(plane.normal, normal) < opposed &&
           dot(plane.normal, at) - plane.offset <= close;
  };
  if (std::any_of(planes.begin(), planes.end(), is_under)) return true;
  if (!(normal.y < opposed)) return false;
  const Vec3 before = at + close * normal;
  bool out = false;
  tree.find(box_around(before, before), [&](std::uint32_t i) { out = out || shapes[i].encloses(before); });
  return out;
}

bool Surroundings::is_covered(std::uint32_t shape, const Near& near, double close) const {
  // What is touched in one place of several solids is the one that is nearest; and a surface is not touched
  // where it leads into or along another one.
  const Vec3 at = near.place - near.distance * near.normal, before = at + close * near.normal;
  if (leads_down(at, near.normal, close)) return true;
  Bounds around = nowhere;
  include(around, at, 2 * close);
  bool out = false;
  tree.find(around, [&](std::uint32_t i) {
    const GroundShape& other = shapes[i];
    if (out || i == shape || !other.is_convex() || !other.bounds().overlaps(around)) return;
    if (other.distance(at) > close) return;
    const bool hides = other.distance(near.place) < near.distance - on_surface * close ||
                       other.distance(before) < in_front * close;
    out = hides && !goes_on(shape, other, at, near.normal, close);
  });
  return out;
}

Vec3 Surroundings::lifted(std::uint32_t shape, Vec3 place, double close) const {
  const double reach = aside * close;  // What is deeper was pushed there.
  for (const Plane& plane : planes) {
    const double depth = plane.offset - dot(plane.normal, place);
    if (!plane.motion.platform && depth > 0 && depth <= reach) place += depth * plane.normal;
  }
  const Vec3 from = place;
  tree.find(box_around(from, from), [&](std::uint32_t i) {
    LineTouches touches;
    if (i != shape) shapes[i].touch_point(place, place, 0, touches);
    for (const LineTouch& each : touches)
      if (each.gap < 0 && each.gap >= -reach) place = place - each.gap * each.normal;
  });
  return place;
}

bool Surroundings::leads_out(std::uint32_t shape, const Near& near, double reach, double close) const {
  constexpr int most_solids = 3;  // which meet in a corner of a room
  Vec3 way = -near.distance * near.normal, along = near.normal;
  for (int left = 1; left <= most_solids; ++left) {
    const Vec3 at = near.place + way + (2 * close) * along;
    std::uint32_t next = GroundShape::none;
    tree.find(box_around(at, at), [&](std::uint32_t i) {
      if (i != shape && shapes[i].is_convex() && shapes[i].distance(at) < -close) next = std::min(next, i);
    });
    if (next == GroundShape::none) return norm(way) <= reach && !leads_down(at, along, 3 * close);
    shape = GroundShape::none;
    shapes[next].for_exits(at, [&](double distance, Vec3 normal) {
      if (dot(normal, along) < opposed) return false;  // back to where it came from
      way = way - distance * normal;
      along = normal;
      shape = next;
      return true;
    });
    if (shape == GroundShape::none) return false;
  }
  return false;
}

double height(const Bounds& bounds, const Plane& plane) {
  const Vec3 center = 0.5 * (bounds.low + bounds.high), half = 0.5 * (bounds.high - bounds.low);
  const Vec3 n = plane.normal;
  return dot(n, center) - plane.offset -
         (std::abs(n.x) * half.x + std::abs(n.y) * half.y + std::abs(n.z) * half.z);
}

double fastest(const GroundRate& rate, const Bounds& bounds, double dt) {
  const double speed = norm(rate.velocity);
  if (rate.spin == Vec3{}) return speed;
  const Vec3 low = rate.center - bounds.low, high = bounds.high - rate.center;
  const Vec3 far{std::max(std::abs(low.x), std::abs(high.x)), std::max(std::abs(low.y), std::abs(high.y)),
                 std::max(std::abs(low.z), std::abs(high.z))};
  return speed + norm(rate.spin) * (norm(far) + speed * dt);
}

Plane posed(const Plane& plane, const PlatformPose& pose) {
  Plane out = plane;
  if (pose.is_home) return out;
  out.normal = pose.direction(plane.normal);
  out.offset = dot(out.normal, pose.place(plane.offset * plane.normal));
  return out;
}

Surroundings::Solid posed(const Surroundings::Solid& box, const PlatformPose& pose) {
  Surroundings::Solid out = box;
  if (pose.is_home) return out;
  out.center = pose.place(box.center);
  out.frame = {pose.direction(box.frame.x), pose.direction(box.frame.y), pose.direction(box.frame.z)};
  out.bounds = bounds_of(out.center, out.half, out.frame);
  return out;
}

Bounds box_around(Vec3 p, Vec3 q) {
  return {{std::min(p.x, q.x), std::min(p.y, q.y), std::min(p.z, q.z)},
          {std::max(p.x, q.x), std::max(p.y, q.y), std::max(p.z, q.z)}};
}

Bounds grown(const Bounds& bounds, double by) {
  const Vec3 most{by, by, by};
  return {bounds.low - most, bounds.high + most};
}

bool may_touch(std::span<const Filter> filters, const Filter& other) {
  return std::any_of(filters.begin(), filters.end(),
                     [&](const Filter& each) { return plumb::may_touch(each, other); });
}

}  // namespace plumb::detail
