#include "scenes/files/scene_file_limbs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "plumb/joints.hpp"
#include "scenes/files/scene_text.hpp"

namespace plumb::scenes {
namespace {

Point point(const json& value, const std::string& path) {
  if (!is_object(value)) return point_at(particle_id(value, path));
  const Object item(value, path, {"particles", "weights"});
  const Array particles(item, "particles");
  const Array weights(item, "weights");
  if (particles.size() == 0 || particles.size() > 4 || weights.size() != particles.size()) {
    refuse(path, "must have one to four particles and a weight for each, not " +
                     std::to_string(particles.size()) + " and " + std::to_string(weights.size()));
  }
  Point out;
  for (std::size_t k = 0; k < particles.size(); ++k) {
    out.particles[k] = particle_id(particles[k], particles.path_of(k));
    out.weights[k] = number(weights[k], weights.path_of(k));
  }
  return out;
}
Point point(const Object& object, const char* key) {
  return point(object.at(key), object.path_of(key));
}

Direction direction(const Object& object, const char* key) {
  const Object item(object.at(key), object.path_of(key), {"from", "to"});
  return {point(item, "from"), point(item, "to")};
}

template <std::size_t n, class Number, class Read>
std::array<Number, n> numbers(const json& value, const std::string& path, Read read) {
  const Array list(value, path);
  if (list.size() != n)
    refuse(path, "must have " + std::to_string(n) + " numbers, not " + std::to_string(list.size()));
  std::array<Number, n> out;
  for (std::size_t k = 0; k < n; ++k) out[k] = read(list[k], list.path_of(k));
  return out;
}

Inertia inertia(const Object& object, const char* key) {
  const Object item(object.at(key), object.path_of(key), {"xx", "yy", "zz", "xy", "xz", "yz"});
  return {.xx = number(item, "xx"),
          .yy = number(item, "yy"),
          .zz = number(item, "zz"),
          .xy = number_or(item, "xy", 0),
          .xz = number_or(item, "xz", 0),
          .yz = number_or(item, "yz", 0)};
}

Surface surface(const Object& item) {
  const Surface usual;
  return {.friction = number_or(item, "friction", usual.friction),
          .restitution = number_or(item, "restitution", usual.restitution),
          .rolling = number_or(item, "rolling", usual.rolling),
          .spinning = number_or(item, "spinning", usual.spinning)};
}

/// Reads a whole number that fits the type.
template <class Integer>
Integer whole_or(const Object& item, const char* key, Integer otherwise) {
  if (!item.find(key)) return otherwise;
  const double value = number(item, key), low = std::numeric_limits<Integer>::min(),
               high = std::numeric_limits<Integer>::max();
  if (!(value >= low && value <= high && value == std::floor(value)))
    refuse(item.path_of(key), "must be a whole number from " + std::to_string(static_cast<Integer>(low)) +
                                  " to " + std::to_string(static_cast<Integer>(high)));
  return static_cast<Integer>(value);
}

Filter filter(const Object& item) {
  const Filter usual;
  return {.category = whole_or(item, "category", usual.category),
          .mask = whole_or(item, "mask", usual.mask),
          .group = whole_or(item, "group", usual.group),
          .own_island = truth_or(item, "own_island", usual.own_island)};
}

GroundMotion motion(const Object& item) {
  GroundMotion out{.belt = vector_or(item, "belt", {})};
  if (item.find("platform")) out.platform = whole_or<std::uint32_t>(item, "platform", 0);
  return out;
}

std::array<double, 4> orientation(const Object& item) {
  const json* const value = item.find("orientation");
  if (value == nullptr) return Pose{}.orientation;
  return numbers<4, double>(*value, item.path_of("orientation"),
                            [](const json& v, const std::string& p) { return number(v, p); });
}

Body body(const json& value, const std::string& path) {
  const Object item(value, path, {"particles", "mass", "center", "inertia"});
  const auto id = [](const json& v, const std::string& p) { return particle_id(v, p); };
  return {.particles = numbers<4, std::uint32_t>(item.at("particles"), item.path_of("particles"), id),
          .mass = number(item, "mass"),
          .center = vector(item, "center"),
          .inertia = inertia(item, "inertia")};
}

Pin pin(const json& value, const std::string& path) {
  const Object item(value, path, {"a", "b"});
  return {point(item, "a"), point(item, "b")};
}

Alignment alignment(const json& value, const std::string& path) {
  const Object item(value, path, {"u", "v", "value"});
  Alignment out{.u = direction(item, "u"), .v = direction(item, "v")};
  if (item.find("value")) out.value = number(item, "value");
  return out;
}

AngleControl angle(const json& value, const std::string& path) {
  const Object item(value, path, {"u", "v", "lower", "upper", "friction", "target", "stiffness", "damping"});
  const AngleControl usual;
  return {.u = direction(item, "u"),
          .v = direction(item, "v"),
          .lower = number_or(item, "lower", usual.lower),
          .upper = number_or(item, "upper", usual.upper),
          .friction = number_or(item, "friction", usual.friction),
          .target = number_or(item, "target", usual.target),
          .stiffness = number_or(item, "stiffness", usual.stiffness),
          .damping = number_or(item, "damping", usual.damping)};
}

Spring spring(const json& value, const std::string& path) {
  const Object item(value, path, {"a", "b", "length", "stiffness", "damping", "force", "one_sided"});
  return {.a = point(item, "a"),
          .b = point(item, "b"),
          .length = number_or(item, "length", 0),
          .stiffness = number_or(item, "stiffness", 0),
          .damping = number_or(item, "damping", 0),
          .force = number_or(item, "force", 0),
          .one_sided = truth_or(item, "one_sided", false)};
}

Torsion torsion(const json& value, const std::string& path) {
  const Object item(value, path, {"axis", "u", "v", "angle", "stiffness", "damping", "torque"});
  return {.axis = direction(item, "axis"),
          .u = direction(item, "u"),
          .v = direction(item, "v"),
          .angle = number_or(item, "angle", 0),
          .stiffness = number_or(item, "stiffness", 0),
          .damping = number_or(item, "damping", 0),
          .torque = number_or(item, "torque", 0)};
}

Capsule capsule(const json& value, const std::string& path) {
  const Object item(value, path,
                    {"a", "b", "radius", "friction", "restitution", "rolling", "spinning", "category", "mask",
                     "group", "own_island"});
  return {.a = point(item, "a"),
          .b = point(item, item.find("b") ? "b" : "a"),
          .radius = number(item, "radius"),
          .surface = surface(item),
          .filter = filter(item)};
}

Plane plane(const json& value, const std::string& path) {
  const Object item(value, path,
                    {"normal", "offset", "friction", "restitution", "rolling", "spinning", "category", "mask",
                     "group", "platform", "belt"});
  return {.normal = vector(item, "normal"),
          .offset = number_or(item, "offset", 0),
          .surface = surface(item),
          .filter = filter(item),
          .motion = motion(item)};
}

Box box(const json& value, const std::string& path) {
  const Object item(value, path,
                    {"center", "half_size", "orientation", "friction", "restitution", "rolling", "spinning",
                     "category", "mask", "group", "platform", "belt"});
  return {.center = vector(item, "center"),
          .half_size = vector(item, "half_size"),
          .orientation = orientation(item),
          .surface = surface(item),
          .filter = filter(item),
          .motion = motion(item)};
}

Pose platform(const json& value, const std::string& path) {
  const Object item(value, path, {"position", "orientation"});
  return {.position = vector_or(item, "position", {}), .orientation = orientation(item)};
}

/// Reads the list of a key. Lists are long, so that each is read once.
template <class Read>
auto list_of(const Object& item, const char* key, Read read) {
  const Array list(item, key);
  std::vector<decltype(read(list[0], std::string()))> out;
  out.reserve(list.size());
  for (std::size_t i = 0; i < list.size(); ++i) out.push_back(read(list[i], list.path_of(i)));
  return out;
}

Vec3 place(const json& value, const std::string& path) {
  return vector(value, path);
}

Hull hull(const json& value, const std::string& path) {
  const Object item(value, path,
                    {"body", "points", "radius", "friction", "restitution", "rolling", "spinning", "category",
                     "mask", "group"});
  return {.body = id_of("body", item.at("body"), item.path_of("body")),
          .points = list_of(item, "points", place),
          .radius = number_or(item, "radius", 0),
          .surface = surface(item),
          .filter = filter(item)};
}

GroundCapsule ground_capsule(const json& value, const std::string& path) {
  const Object item(
      value, path,
      {"a", "b", "radius", "friction", "restitution", "rolling", "spinning", "category", "mask", "group"});
  return {.a = vector(item, "a"),
          .b = vector(item, item.find("b") ? "b" : "a"),
          .radius = number(item, "radius"),
          .surface = surface(item),
          .filter = filter(item)};
}

GroundHull ground_hull(const json& value, const std::string& path) {
  const Object item(
      value, path,
      {"points", "radius", "friction", "restitution", "rolling", "spinning", "category", "mask", "group"});
  return {.points = list_of(item, "points", place),
          .radius = number_or(item, "radius", 0),
          .surface = surface(item),
          .filter = filter(item)};
}

GroundMesh mesh(const json& value, const std::string& path) {
  const Object item(value, path,
                    {"vertices", "triangles", "solid", "friction", "restitution", "rolling", "spinning",
                     "category", "mask", "group"});
  const auto corners = [](const json& v, const std::string& p) {
    return numbers<3, std::uint32_t>(
        v, p, [](const json& id, const std::string& at) { return id_of("vertex", id, at); });
  };
  return {.vertices = list_of(item, "vertices", place),
          .triangles = list_of(item, "triangles", corners),
          .solid = truth_or(item, "solid", false),
          .surface = surface(item),
          .filter = filter(item)};
}

HeightField height_field(const json& value, const std::string& path) {
  const Object item(value, path,
                    {"corner", "cell_x", "cell_z", "columns", "heights", "friction", "restitution", "rolling",
                     "spinning", "category", "mask", "group"});
  const auto height = [](const json& v, const std::string& p) { return number(v, p); };
  return {.corner = vector_or(item, "corner", {}),
          .cell_x = number(item, "cell_x"),
          .cell_z = number(item, "cell_z"),
          .columns = static_cast<std::uint32_t>(std::min<std::uint64_t>(count(item, "columns"), ~0u)),
          .heights = list_of(item, "heights", height),
          .surface = surface(item),
          .filter = filter(item)};
}

template <class Item>
void read_list(const Object& top, const char* key, std::vector<Item>& out,
               Item (*read)(const json&, const std::string&)) {
  if (!top.find(key)) return;
  const Array list(top, key);
  for (std::size_t i = 0; i < list.size(); ++i) out.push_back(read(list[i], list.path_of(i)));
}

}  // namespace

void read_limbs(const Object& top, Scene& scene) {
  read_list(top, "bodies", scene.bodies, body);
  read_list(top, "pins", scene.pins, pin);
  read_list(top, "alignments", scene.alignments, alignment);
  read_list(top, "angles", scene.angles, angle);
  read_list(top, "springs", scene.springs, spring);
  read_list(top, "torsions", scene.torsions, torsion);
  read_list(top, "capsules", scene.capsules, capsule);
  read_list(top, "planes", scene.planes, plane);
  read_list(top, "boxes", scene.boxes, box);
  read_list(top, "platforms", scene.platforms, platform);
  read_list(top, "hulls", scene.hulls, hull);
  read_list(top, "ground_capsules", scene.ground_capsules, ground_capsule);
  read_list(top, "ground_hulls", scene.ground_hulls, ground_hull);
  read_list(top, "meshes", scene.meshes, mesh);
  read_list(top, "height_fields", scene.height_fields, height_field);
}

}  // namespace plumb::scenes
