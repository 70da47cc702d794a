#include "contact/linkage/scene_parts.hpp"

#include <algorithm>
#include <array>
#include <type_traits>
#include <vector>

#include "contact/platforms/anchored.hpp"
#include "plumb/joints.hpp"
#include "scene/barycentric.hpp"
#include "scene/bends/bends.hpp"
#include "scene/refuse.hpp"
#include "scene/scene_graph.hpp"
#include "scene/validate_bodies.hpp"

namespace plumb::detail {
namespace {

/// A scene's particles and whatever holds them together, as edges.
struct Bonds {
  explicit Bonds(const Scene& scene) {
    for (const Particle& particle : scene.particles) movable.push_back(!particle.fixed);
    for (const Rod& rod : scene.rods) edges.push_back({rod.a, rod.b});
    for (const Body& body : scene.bodies) bond(Point{body.particles, {1, 1, 1, 1}});
    for (const Pin& pin : scene.pins) bond(pin.a, pin.b);
    for (const Alignment& each : scene.alignments) bond(each.u.from, each.u.to, each.v.from, each.v.to);
    for (const AngleControl& each : scene.angles) bond(each.u.from, each.u.to, each.v.from, each.v.to);
    for (const Spring& each : scene.springs) bond(each.a, each.b);
    for (const Torsion& each : scene.torsions)
      bond(each.axis.from, each.axis.to, each.u.from, each.u.to, each.v.from, each.v.to);
    for (const Bend& each : scene.bends) bond(Point{{each.a, each.b, each.c}, {1, 1, 1}});
    for (const Capsule& capsule : scene.capsules) bond(capsule.a, capsule.b);
  }

  layouts::Graph view() const { return {static_cast<std::uint32_t>(movable.size()), edges, movable}; }

  Array<layouts::Edge> edges;
  Array<std::uint8_t> movable;

 private:
  void name(const std::array<std::uint32_t, 4>& particles, const std::array<double, 4>& weights) {
    for (std::size_t i = 0; i < 4; ++i)
      if (weights[i] != 0) named.push_back(particles[i]);
  }
  /// All to the first that is movable; fixed ones may be its neighbours only.
  void bond_named() {
    const auto hub =
        std::find_if(named.begin(), named.end(), [&](std::uint32_t i) { return movable[i] != 0; });
    if (hub != named.end())
      for (const std::uint32_t i : named)
        if (i != *hub) edges.push_back({*hub, i});
    named.clear();
  }
  template <class... Points>
  void bond(const Points&... points) {
    (name(points.particles, points.weights), ...);
    bond_named();
  }

  Array<std::uint32_t> named;
};

/// Numbers, in order.
class Likeness {
 public:
  explicit Likeness(const Scene& part) {
    add(part.drag, part.joint_drag);
    for (const Particle& each : part.particles) add(each.mass, each.fixed);
    add(part.rods.size());
    for (std::size_t i = 0; i < part.rods.size(); ++i) {
      const Rod& rod = part.rods[i];
      add(rod.a, rod.b, rod_length(part, i), rod.mass, rod.center, rod.inertia.value_or(-1), rod.linear_drag,
          rod.orthogonal_drag, rod.law.stiffness, rod.law.damping, rod.law.one_sided, rod.law.strength);
    }
    add(part.bodies.size());
    for (std::size_t i = 0; i < part.bodies.size(); ++i) {
      for (const std::uint32_t particle : part.bodies[i].particles) add(particle);
      add(signed_volume(detail::positions_of(part, part.bodies[i].particles)) > 0);  // it is no mirror image
      for (const auto& line : body_mass(part, i))
        for (const double mass : line) add(mass);
    }
    add(part.pins.size());
    for (const Pin& each : part.pins) add(each.a, each.b);
    add(part.alignments.size());
    for (const Alignment& each : part.alignments) {
      add(each.u.from, each.u.to, each.v.from, each.v.to);
      add(dot(span(part, each.u), span(part, each.v)));
    }
    add(part.angles.size());
    for (const AngleControl& each : part.angles)
      add(each.u.from, each.u.to, each.v.from, each.v.to, norm(span(part, each.u)), norm(span(part, each.v)),
          each.lower, each.upper, each.friction, each.target, each.stiffness, each.damping);
    add(part.springs.size());
    for (const Spring& each : part.springs)
      add(each.a, each.b, each.length, each.stiffness, each.damping, each.force, each.one_sided);
    add(part.torsions.size());
    for (const Torsion& each : part.torsions)
      add(each.axis.from, each.axis.to, each.u.from, each.u.to, each.v.from, each.v.to, each.angle,
          each.stiffness, each.damping, each.torque);
    add(part.bends.size());
    const Array<std::array<double, 2>> lengths = bend_lengths(part);
    for (std::size_t i = 0; i < part.bends.size(); ++i) {
      const Bend& each = part.bends[i];
      add(each.a, each.b, each.c, lengths[i][0], lengths[i][1], each.stiffness, each.angle, each.damping);
    }
    add(part.hulls.size());
    for (const Hull& each : part.hulls) add_hull(part, each);
    add(part.capsules.size());
    for (const Capsule& each : part.capsules) add(each.a, each.b, each.radius, each.surface, each.filter);
  }

  const Array<double>& numbers() const { return numbers_; }

 private:
  static Vec3 span(const Scene& part, const Direction& direction) {
    return position_of(part, direction.to) - position_of(part, direction.from);
  }

  /// Places of points on the body are the same wherever it is, to rounding.
  void add_hull(const Scene& part, const Hull& hull) {
    add(hull.body, hull.radius, hull.surface, hull.filter, hull.points.size());
    for (const Vec3 point : hull.points) add(point_on_body(part, hull.body, point));
  }
  void add(const Vec3& v) { add(v.x, v.y, v.z); }
  void add(const Surface& surface) {
    add(surface.friction, surface.restitution, surface.rolling, surface.spinning);
  }
  void add(const Filter& filter) { add(filter.category, filter.mask, filter.group, filter.own_island); }
  void add(const Point& point) {
    for (std::size_t i = 0; i < 4; ++i)
      add(point.weights[i] == 0 ? 0u : point.particles[i], point.weights[i]);
  }
  template <class Number>
  requires std::is_arithmetic_v<Number>
  void add(Number number) { numbers_.push_back(static_cast<double>(number)); }
  template <class First, class Second, class... Rest>
  void add(const First& first, const Second& second, const Rest&... rest) {
    add(first);
    add(second);
    (add(rest), ...);
  }

  Array<double> numbers_;
};

}  // namespace

bool needs_contact_stage(const Scene& scene) {
  const bool has_ground = !scene.planes.empty() || !scene.boxes.empty() || !scene.ground_capsules.empty() ||
                          !scene.ground_hulls.empty() || !scene.meshes.empty() ||
                          !scene.height_fields.empty();
  const bool has_joints = !scene.bodies.empty() || !scene.pins.empty() || !scene.alignments.empty() ||
                          !scene.angles.empty() || !scene.springs.empty() || !scene.torsions.empty() ||
                          !scene.capsules.empty() || scene.joint_drag != 0;
  return has_joints || has_ground ||
         std::any_of(scene.particles.begin(), scene.particles.end(),
                     [](const Particle& particle) { return particle.asleep; }) ||
         has_air(scene);
}

bool has_air(const Scene& part) {
  return std::any_of(part.rods.begin(), part.rods.end(),
                     [](const Rod& rod) { return rod.linear_drag != 0 || rod.orthogonal_drag != 0; });
}

bool is_plain(const Scene& part) {
  const bool has_joints = !part.bodies.empty() || !part.pins.empty() || !part.alignments.empty() ||
                          !part.angles.empty() || !part.springs.empty() || !part.torsions.empty() ||
                          part.joint_drag != 0;
  const bool has_sleepers = std::any_of(part.particles.begin(), part.particles.end(),
                                        [](const Particle& each) { return each.asleep && !each.fixed; });
  const bool gives = !part.bends.empty() || std::any_of(part.rods.begin(), part.rods.end(),
                                                        [](const Rod& rod) { return !rod.law.is_rigid(); });
  if (has_joints || has_air(part) || has_sleepers || (gives && !part.capsules.empty())) return false;
  const auto is_inside = [](const Point& point) {
    return std::all_of(point.weights.begin(), point.weights.end(),
                       [](double weight) { return weight >= 0 && weight <= 1; });
  };
  if (!std::all_of(part.capsules.begin(), part.capsules.end(),
                   [&](const Capsule& each) { return is_inside(each.a) && is_inside(each.b); }))
    return false;
  const SceneGraph rods(part);
  return layouts::find_islands(rods.view()).count() == 1;
}

void lump_masses(Scene& part) {
  for (std::size_t i = 0; i < part.rods.size(); ++i) {
    const RodMass mass = rod_mass(part, i, MassModel::lumped);
    part.particles[part.rods[i].a].mass += mass.aa;
    part.particles[part.rods[i].b].mass += mass.bb;
  }
  for (Rod& rod : part.rods) {
    rod.mass = 0;
    rod.inertia.reset();
  }
}

Array<double> likeness(const Scene& part) {
  return Likeness(part).numbers();
}

SceneParts::SceneParts(const Scene& scene) : scene_(scene) {
  const Bonds bonds(scene);
  const layouts::Islands islands = layouts::find_islands(bonds.view());
  const std::uint32_t count = islands.count();
  island_of_.assign(scene.particles.size(), none);
  for (std::uint32_t i = 0; i < count; ++i)
    for (const std::uint32_t particle : islands.vertices(i))
      if (!scene.particles[particle].fixed) island_of_[particle] = i;
  parts_.resize(count);
  particles_.resize(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto vertices = islands.vertices(i);
    Array<std::uint32_t>& order = particles_[i];
    for (const bool fixed : {false, true})
      for (const std::uint32_t particle : vertices)
        if (scene.particles[particle].fixed == fixed) order.push_back(particle);
    parts_[i].gravity = scene.gravity;
    parts_[i].drag = scene.drag;
    parts_[i].joint_drag = scene.joint_drag;
    for (const std::uint32_t particle : order) parts_[i].particles.push_back(scene.particles[particle]);
  }
  hand_out();
}

template <class Item>
void SceneParts::hand(const Item& item, std::uint32_t island, std::vector<Item>& to, Array<Share>& shares) {
  shares.push_back({island, static_cast<std::uint32_t>(to.size())});
  to.push_back(item);
}

void SceneParts::hand_out() {
  local_.assign(scene_.particles.size(), 0);
  for (std::uint32_t i = 0; i < count(); ++i)
    for (std::uint32_t p = 0; p < particles_[i].size(); ++p)
      if (!scene_.particles[particles_[i][p]].fixed) local_[particles_[i][p]] = p;
  for (std::size_t i = 0; i < scene_.rods.size(); ++i) {
    Rod rod = scene_.rods[i];
    const std::uint32_t island = movable_of({{rod.a, rod.b, 0, 0}, {1, 1, 0, 0}});
    rod.length = rod_length(scene_, i);
    rod.a = local(island, rod.a);
    rod.b = local(island, rod.b);
    hand(rod, island, parts_[island].rods, shares_.rods);
  }
  for (Body body : scene_.bodies) {
    const std::uint32_t island = movable_of({body.particles, {1, 1, 1, 1}});
    if (island == none) {  // part of the ground
      shares_.bodies.push_back({none, 0});
      continue;
    }
    for (std::uint32_t& particle : body.particles) particle = local(island, particle);
    hand(body, island, parts_[island].bodies, shares_.bodies);
  }
  hand_out_joints();
  for (Capsule each : scene_.capsules) {
    if (is_anchored(scene_, each)) {  // ground
      shares_.capsules.push_back({none, 0});
      continue;
    }
    const std::uint32_t island = island_of(each.a, each.b);
    each.a = local(island, each.a);
    each.b = local(island, each.b);
    hand(each, island, parts_[island].capsules, shares_.capsules);
  }
  for (Hull each : scene_.hulls) {
    const auto [island, number] = shares_.bodies[each.body];
    if (island == none)
      refuse("hull ", shares_.hulls.size(), ": its body ", each.body, " cannot move; use ground hulls");
    each.body = number;
    hand(each, island, parts_[island].hulls, shares_.hulls);
  }
}

void SceneParts::hand_out_joints() {
  for (const Pin& each : scene_.pins) {
    const std::uint32_t island = island_of(each.a, each.b);
    hand(Pin{local(island, each.a), local(island, each.b)}, island, parts_[island].pins, shares_.pins);
  }
  for (const Alignment& each : scene_.alignments) {
    const std::uint32_t island = island_of(each.u.from, each.u.to, each.v.from, each.v.to);
    hand(Alignment{local(island, each.u), local(island, each.v)}, island, parts_[island].alignments,
         shares_.alignments);
  }
  for (AngleControl each : scene_.angles) {
    const std::uint32_t island = island_of(each.u.from, each.u.to, each.v.from, each.v.to);
    each.u = local(island, each.u);
    each.v = local(island, each.v);
    hand(each, island, parts_[island].angles, shares_.angles);
  }
  for (Spring each : scene_.springs) {
    const std::uint32_t island = island_of(each.a, each.b);
    each.a = local(island, each.a);
    each.b = local(island, each.b);
    hand(each, island, parts_[island].springs, shares_.springs);
  }
  for (Torsion each : scene_.torsions) {
    const std::uint32_t island =
        island_of(each.axis.from, each.axis.to, each.u.from, each.u.to, each.v.from, each.v.to);
    each.axis = local(island, each.axis);
    each.u = local(island, each.u);
    each.v = local(island, each.v);
    hand(each, island, parts_[island].torsions, shares_.torsions);
  }
  for (Bend each : scene_.bends) {
    const std::uint32_t island = movable_of({{each.a, each.b, each.c}, {1, 1, 1}});
    for (std::uint32_t* const particle : {&each.a, &each.b, &each.c}) *particle = local(island, *particle);
    hand(each, island, parts_[island].bends, shares_.bends);
  }
}

std::uint32_t SceneParts::movable_of(const Point& point) const {
  for (std::size_t i = 0; i < 4; ++i)
    if (point.weights[i] != 0 && !scene_.particles[point.particles[i]].fixed)
      return island_of_[point.particles[i]];
  return none;
}
template <class... Points>
std::uint32_t SceneParts::island_of(const Points&... points) const {
  std::uint32_t out = none;
  ((out = out == none ? movable_of(points) : out), ...);
  if (out == none) refuse("a joint on fixed particles alone moves nothing");
  return out;
}
std::uint32_t SceneParts::local(std::uint32_t island, std::uint32_t particle) const {
  if (!scene_.particles[particle].fixed) return local_[particle];
  const auto& order = particles_[island];
  return static_cast<std::uint32_t>(std::find(order.begin(), order.end(), particle) - order.begin());
}
Point SceneParts::local(std::uint32_t island, Point point) const {
  for (std::size_t i = 0; i < 4; ++i)
    point.particles[i] = point.weights[i] == 0 ? 0 : local(island, point.particles[i]);
  return point;
}
Direction SceneParts::local(std::uint32_t island, const Direction& direction) const {
  return {local(island, direction.from), local(island, direction.to)};
}

}  // namespace plumb::detail
