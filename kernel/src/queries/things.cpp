#include "queries/things.hpp"

#include <algorithm>

#include "contact/ground/ground_shape.hpp"
#include "scene/barycentric.hpp"

namespace plumb::detail {
namespace {

QueryTarget shape_of(ShapeKind list, std::size_t i) {
  return {QueryTarget::Kind::shape, list, static_cast<std::uint32_t>(i)};
}

}  // namespace

Things::Things(const Scene& scene, const QuerySettings& settings)
    : rod_radius_(settings.rod_radius), particle_radius_(settings.particle_radius), platforms_(scene) {
  for (std::size_t i = 0; i < scene.capsules.size(); ++i) add_capsule(scene, i);
  for (std::size_t i = 0; i < scene.hulls.size(); ++i) add_hull(scene, i);
  add_ground(scene);
  first_ = {things_.size(), targets_.size(), lines_.size(), carried_.size(), solids_.size()};
  poses_.assign(scene.platforms.begin(), scene.platforms.end());
  bounds_.resize(things_.size());
  // What does not move is taken now.
  for (std::size_t i = 0; i < things_.size(); ++i) bounds_[i] = around(things_[i]);
}

std::uint32_t Things::add(const QueryTarget& target, const Filter& filter) {
  targets_.push_back(target);
  filters_.push_back(filter);
  index_.push_back(0);
  return static_cast<std::uint32_t>(targets_.size() - 1);
}

/// Returns its place in the list.
std::uint32_t Things::add_thing(const QueryTarget& target, const Filter& filter, const Thing& thing,
                                std::size_t index) {
  things_.push_back(thing);
  things_.back().number = add(target, filter);
  index_.back() = static_cast<std::uint32_t>(index);
  return static_cast<std::uint32_t>(things_.size() - 1);
}

std::uint32_t Things::add_solid(ShapeKind list, std::size_t i, const Filter& filter, double radius) {
  solids_.emplace_back();
  return add_thing(shape_of(list, i), filter, {.radius = radius, .form = Thing::Form::solid},
                   solids_.size() - 1);
}

void Things::add_capsule(const Scene& scene, std::size_t i) {
  const Capsule& each = scene.capsules[i];
  const std::uint32_t thing = add_thing(shape_of(ShapeKind::capsule, i), each.filter,
                                        {.radius = each.radius, .form = Thing::Form::capsule});
  lines_.push_back({thing, combination(each.a), combination(each.b)});
}

void Things::add_hull(const Scene& scene, std::size_t i) {
  const Hull& each = scene.hulls[i];
  const auto solid = static_cast<std::uint32_t>(solids_.size());
  const std::uint32_t thing = add_solid(ShapeKind::hull, i, each.filter, each.radius);
  Carried& out = *carried_.emplace_back(std::make_unique<Carried>());
  out.thing = thing;
  out.solid = solid;
  out.hull = ConvexHull(each.points);
  out.particles = scene.bodies[each.body].particles;
  std::array<Vec3, 4> places;
  for (std::size_t k = 0; k < 4; ++k) places[k] = scene.particles[out.particles[k]].position;
  const Barycentric barycentric(places);
  for (const Vec3 v : out.hull.vertices()) out.corners.push_back(barycentric.weights(v));
  out.vertices.resize(out.corners.size());
  out.normals.resize(out.hull.parts().faces());
}

void Things::add_ground(const Scene& scene) {
  first_box_ = solids_.size();
  first_box_thing_ = things_.size();
  ground_hulls_.reserve(scene.ground_hulls.size());
  home_planes_.assign(scene.planes.begin(), scene.planes.end());
  for (std::size_t i = 0; i < scene.planes.size(); ++i) {
    const Plane& each = scene.planes[i];
    planes_.push_back({each.normal, each.offset, add(shape_of(ShapeKind::plane, i), each.filter)});
  }
  for (std::size_t i = 0; i < scene.boxes.size(); ++i) {
    const Box& each = scene.boxes[i];
    Surroundings::Solid& home = home_boxes_.emplace_back();
    home.center = each.center;
    home.half = each.half_size;
    home.frame = frame_of(each.orientation);
    home.motion = each.motion;
    add_solid(ShapeKind::box, i, each.filter, 0);
    boxes_.emplace_back(home.center, home.half, home.frame);
  }
  for (const SolidBox& box : boxes_) solids_[first_box_ + (&box - boxes_.data())] = box.shape();
  for (std::size_t i = 0; i < scene.ground_capsules.size(); ++i) {
    const GroundCapsule& each = scene.ground_capsules[i];
    add_thing(shape_of(ShapeKind::ground_capsule, i), each.filter,
              {.p = each.a, .q = each.b, .radius = each.radius, .form = Thing::Form::capsule});
  }
  for (std::size_t i = 0; i < scene.ground_hulls.size(); ++i) {
    const GroundHull& each = scene.ground_hulls[i];
    add_solid(ShapeKind::ground_hull, i, each.filter, each.radius);
    solids_.back() = ground_hulls_.emplace_back(each.points).shape(each.radius);
  }
  for (std::size_t i = 0; i < scene.meshes.size(); ++i)
    add_mesh(ShapeKind::mesh, i, scene.meshes[i],
             scene.meshes[i].solid ? MeshSides::outward : MeshSides::both);
  for (std::size_t i = 0; i < scene.height_fields.size(); ++i) {
    wide_.push_back(static_cast<std::uint32_t>(things_.size()));
    add_mesh(ShapeKind::height_field, i, mesh_of(scene.height_fields[i]), MeshSides::upward);
  }
}

void Things::add_mesh(ShapeKind list, std::size_t i, const GroundMesh& mesh, MeshSides sides) {
  meshes_.emplace_back(mesh.vertices, mesh.triangles, sides);
  add_thing(shape_of(list, i), mesh.filter, {.form = Thing::Form::mesh}, meshes_.size() - 1);
}

bool Things::list_bare(const Scene& now, std::span<const BareRod> rods,
                       std::span<const std::uint32_t> particles, std::span<const AddedShape> shapes) {
  if (std::equal(rods.begin(), rods.end(), rods_.begin(), rods_.end()) &&
      std::equal(particles.begin(), particles.end(), particles_.begin(), particles_.end()) &&
      std::equal(shapes.begin(), shapes.end(), added_.begin(), added_.end()))
    return false;
  added_.assign(shapes.begin(), shapes.end());
  rods_.assign(rods.begin(), rods.end());
  particles_.assign(particles.begin(), particles.end());
  things_.resize(first_.things);
  targets_.resize(first_.numbers);
  filters_.resize(first_.numbers);
  index_.resize(first_.numbers);
  lines_.resize(first_.lines);
  carried_.resize(first_.carried);
  solids_.resize(first_.solids);
  const auto add_line = [&](QueryTarget::Kind kind, std::uint32_t number, double radius) {
    add_thing({kind, ShapeKind::capsule, number}, {}, {.radius = radius, .form = Thing::Form::gone});
  };
  for (const BareRod& rod : rods_) add_line(QueryTarget::Kind::rod, rod.rod, rod_radius_);
  for (const std::uint32_t particle : particles_)
    add_line(QueryTarget::Kind::particle, particle, particle_radius_);
  for (const AddedShape& each : added_)
    if (each.shape.kind == ShapeKind::hull)
      add_hull(now, each.shape.number);
    else
      add_capsule(now, each.shape.number);
  bounds_.resize(things_.size());
  return true;
}

void Things::update(const Whereabouts& now) {
  const auto put = [&](std::size_t number, Vec3 p, Vec3 q, bool is_there) {
    Thing& thing = things_[number];
    thing.p = p;
    thing.q = q;
    thing.form = is_there ? Thing::Form::capsule : Thing::Form::gone;
    bounds_[number] = around(thing);
    if (bounds_[number].is_empty()) thing.form = Thing::Form::gone;
  };
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    const auto& [thing, a, b] = lines_[i];
    const bool has_ended = i < now.ended_capsules.size() && now.ended_capsules[i] != 0;
    const auto middle = now.middle_of(targets_[things_[thing].number].number);
    if (middle && !has_ended)
      put(thing, now.positions[*middle], now.positions[*middle], true);
    else
      put(thing, a.of(now.positions), b.of(now.positions), !has_ended);
  }
  std::size_t bare = first_.things;
  for (const BareRod& each : rods_)
    put(bare++, now.positions[each.a], now.positions[each.b], now.gone[each.rod] == 0);
  for (const std::uint32_t particle : particles_)
    put(bare++, now.positions[particle], now.positions[particle], true);
  move_hulls(now);
  move_platforms(now.platforms);
}

void Things::move_hulls(const Whereabouts& now) {
  for (std::size_t i = 0; i < carried_.size(); ++i) {
    Carried& each = *carried_[i];
    Thing& thing = things_[each.thing];
    Bounds& bounds = bounds_[each.thing];
    thing.form = Thing::Form::gone;
    bounds = nowhere;
    if (i < now.ended_hulls.size() && now.ended_hulls[i] != 0) continue;
    std::array<Vec3, 4> places;
    for (std::size_t k = 0; k < 4; ++k) places[k] = now.positions[each.particles[k]];
    for (std::size_t k = 0; k < each.corners.size(); ++k)
      each.vertices[k] = weighted(each.corners[k], places);
    const ConvexParts& parts = each.hull.parts();
    find_normals(parts, each.vertices, each.normals);
    solids_[each.solid] = {each.vertices, each.normals, &parts, thing.radius};
    thing.form = Thing::Form::solid;
    bounds = around(thing);
    if (bounds.is_empty()) thing.form = Thing::Form::gone;
  }
}

void Things::move_platforms(std::span<const Pose> platforms) {
  if (std::equal(poses_.begin(), poses_.end(), platforms.begin(), platforms.end())) return;
  poses_.assign(platforms.begin(), platforms.end());
  for (std::uint32_t i = 0; i < platforms.size(); ++i) platforms_.set_target(i, platforms[i]);
  platforms_.end_step();
  for (std::size_t i = 0; i < planes_.size(); ++i)
    if (const auto platform = home_planes_[i].motion.platform) {
      const Plane now = posed(home_planes_[i], platforms_.at(*platform, 0));
      planes_[i].normal = now.normal;
      planes_[i].offset = now.offset;
    }
  for (std::size_t i = 0; i < boxes_.size(); ++i)
    if (const auto platform = home_boxes_[i].motion.platform) {
      const Surroundings::Solid now = posed(home_boxes_[i], platforms_.at(*platform, 0));
      boxes_[i] = SolidBox(now.center, now.half, now.frame);
      bounds_[first_box_thing_ + i] = around(things_[first_box_thing_ + i]);
    }
}

/// Returns a box around a thing where it is now, or nowhere if it is gone or has no finite place.
Bounds Things::around(const Thing& thing) const {
  Bounds out = nowhere;
  if (thing.form == Thing::Form::mesh)
    return mesh(thing).sides() == MeshSides::upward ? nowhere : mesh(thing).bounds();
  if (thing.form == Thing::Form::gone) return nowhere;
  std::array<Vec3, 2> ends;
  for (const Vec3 v : convex(thing, ends).vertices) {
    if (!is_finite(v)) return nowhere;
    include(out, v, thing.radius);
  }
  return out;
}

Convex Things::convex(const Thing& thing, std::array<Vec3, 2>& ends) const {
  if (thing.form == Thing::Form::solid) return solids_[index_[thing.number]];
  ends = {thing.p, thing.q};
  return {
      .vertices = std::span(ends).first(thing.p == thing.q ? 1 : 2), .normals = {}, .radius = thing.radius};
}

bool Things::may_find(std::uint32_t number, const QueryFilter& filter) const {
  const QueryTarget& target = targets_[number];
  const bool is_bare = target.kind != QueryTarget::Kind::shape;
  const bool is_ground = !is_bare && target.list > ShapeKind::hull;
  if (!(is_bare ? filter.bare : is_ground ? filter.ground : filter.shapes)) return false;
  return may_touch(filters_[number], filter.filter);
}

}  // namespace plumb::detail
