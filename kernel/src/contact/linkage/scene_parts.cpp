#include "contact/linkage/scene_parts.hpp"

#include <algorithm>
#include <array>
#include <functional>
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
    numbers_.reserve(2 * part.particles.size() + 12 * part.rods.size() + 25 * part.capsules.size() + 16);
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
      add(each.value.value_or(dot(span(part, each.u), span(part, each.v))));
    }
    add(part.angles.size());
    for (const AngleControl& each : part.angles)
      add(each.u.from, each.u.to, each.v.from, each.v.to, each.lower, each.upper, each.friction, each.target,
          each.stiffness, each.damping);
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

Scene part_of(const Scene& whole, const Names& names) {
  Scene out;
  out.gravity = whole.gravity;
  out.drag = whole.drag;
  out.joint_drag = whole.joint_drag;
  const auto begin = names.particles.begin(), end = names.particles.end();
  const auto is_fixed = [&](std::uint32_t particle) { return whole.particles[particle].fixed; };
  const auto fixed = std::partition_point(begin, end, std::not_fn(is_fixed));
  const auto place_in = [&](auto first, auto last, std::uint32_t particle) {
    // Most islands have particles in a row, and there is no need to search.
    const std::size_t ahead = first != last && particle > *first ? particle - *first : 0;
    auto at = first + static_cast<std::ptrdiff_t>(std::min<std::size_t>(ahead, last - first));
    if (at == last || *at != particle) at = std::lower_bound(first, last, particle);
    return at != last && *at == particle ? static_cast<std::uint32_t>(at - begin) : 0;
  };
  const auto renumber = [&](std::uint32_t& particle) {
    if (particle >= whole.particles.size()) particle = 0;  // Places have slots that nobody reads.
    particle = is_fixed(particle) ? place_in(fixed, end, particle) : place_in(begin, fixed, particle);
  };
  for_lists(
      [&](std::size_t kind, auto& to, const auto& from) {
        to.reserve(names.all()[kind]->size());
        for (const std::uint32_t number : *names.all()[kind])
          for_particles(to.emplace_back(from[number]), renumber);
      },
      out, whole);
  for (std::size_t i = 0; i < out.rods.size(); ++i) out.rods[i].length = rod_length(whole, names.rods[i]);
  for (Hull& hull : out.hulls) {
    const auto body = std::lower_bound(names.bodies.begin(), names.bodies.end(), hull.body);
    hull.body = static_cast<std::uint32_t>(body - names.bodies.begin());
  }
  return out;
}

SceneParts::SceneParts(const Scene& scene) : scene_(scene) {
  const Bonds bonds(scene);
  const layouts::Islands islands = layouts::find_islands(bonds.view());
  const std::uint32_t count = islands.count();
  island_of_.assign(scene.particles.size(), none);
  names_.resize(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto vertices = islands.vertices(i);
    names_[i].particles.assign(vertices.begin(), vertices.end());
    for (const std::uint32_t particle : vertices)
      if (!scene.particles[particle].fixed) island_of_[particle] = i;
  }
  hand_out();
}

/// Hands out the items of a list to the islands that `owner` says.
template <class Item, class Owner>
void SceneParts::hand_out(const std::vector<Item>& list, Owner&& owner) {
  Array<Share>& shares = *shares_.all()[kind_of<Item>()];
  shares.reserve(list.size());
  for (std::uint32_t i = 0; i < list.size(); ++i) {
    const std::uint32_t island = owner(list[i]);
    if (island == none) {
      shares.push_back({none, 0});
      continue;
    }
    Array<std::uint32_t>& names = *names_[island].all()[kind_of<Item>()];
    shares.push_back({island, static_cast<std::uint32_t>(names.size())});
    names.push_back(i);
  }
}

void SceneParts::hand_out() {
  const auto of_places = [&](const auto& each) { return island_of(each.a, each.b); };
  const auto of_directions = [&](const auto& each) {
    return island_of(each.u.from, each.u.to, each.v.from, each.v.to);
  };
  hand_out(scene_.rods, [&](const Rod& rod) { return movable_of({{rod.a, rod.b, 0, 0}, {1, 1, 0, 0}}); });
  hand_out(scene_.bodies, [&](const Body& body) { return movable_of({body.particles, {1, 1, 1, 1}}); });
  hand_out(scene_.pins, of_places);
  hand_out(scene_.alignments, of_directions);
  hand_out(scene_.angles, of_directions);
  hand_out(scene_.springs, of_places);
  hand_out(scene_.torsions, [&](const Torsion& each) {
    return island_of(each.axis.from, each.axis.to, each.u.from, each.u.to, each.v.from, each.v.to);
  });
  hand_out(scene_.bends, [&](const Bend& bend) { return movable_of({{bend.a, bend.b, bend.c}, {1, 1, 1}}); });
  // Those of fixed particles alone are ground.
  hand_out(scene_.capsules,
           [&](const Capsule& capsule) { return is_anchored(scene_, capsule) ? none : of_places(capsule); });
  hand_out(scene_.hulls, [&](const Hull& hull) {
    const std::uint32_t island = shares_.bodies[hull.body].part;
    if (island == none)
      refuse("hull ", shares_.hulls.size(), ": its body ", hull.body, " cannot move; use ground hulls");
    return island;
  });
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

}  // namespace plumb::detail
