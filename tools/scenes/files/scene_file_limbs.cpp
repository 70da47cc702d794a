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
          .group = whole_or(item, "group", usual.group)};
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
  const Object item(value, path, {"u", "v"});
  return {direction(item, "u"), direction(item, "v")};
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
  const Object item(
      value, path,
      {"a", "b", "radius", "friction", "restitution", "rolling", "spinning", "category", "mask", "group"});
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

template <class Item>
void read_list(const Object& top, const char* key, std::vector<Item>& out,
               Item (*read)(const json&, const std::string&)) {
  if (!top.find(key)) return;
  const Array list(top, key);
  for (std::size_t i = 0; i < list.size(); ++i) out.push_back(read(list[i], list.path_of(i)));
}

using scenes::to_json;  // It is that of Vec3, which those below would hide.

/// Slots with weight 0 are left out.
Json to_json(const Point& p) {
  std::vector<std::uint32_t> particles;
  std::vector<double> weights;
  for (std::size_t k = 0; k < 4; ++k) {
    if (p.weights[k] == 0) continue;
    particles.push_back(p.particles[k]);
    weights.push_back(p.weights[k]);
  }
  if (weights == std::vector<double>{1}) return particles.front();
  return {{"particles", Json::array_of(particles)}, {"weights", Json::array_of(weights)}};
}

Json to_json(const Direction& d) {
  return {{"from", to_json(d.from)}, {"to", to_json(d.to)}};
}

Json to_json(const Inertia& i) {
  Json object{{"xx", i.xx}, {"yy", i.yy}, {"zz", i.zz}};
  if (i.xy != 0) object["xy"] = i.xy;
  if (i.xz != 0) object["xz"] = i.xz;
  if (i.yz != 0) object["yz"] = i.yz;
  return object;
}

Json to_json(const Body& b) {
  return {{"particles", Json::array_of(b.particles)},
          {"mass", b.mass},
          {"center", to_json(b.center)},
          {"inertia", to_json(b.inertia)}};
}

Json to_json(const Pin& p) {
  return {{"a", to_json(p.a)}, {"b", to_json(p.b)}};
}

Json to_json(const Alignment& a) {
  return {{"u", to_json(a.u)}, {"v", to_json(a.v)}};
}

Json to_json(const AngleControl& a) {
  const AngleControl usual;
  Json object{{"u", to_json(a.u)}, {"v", to_json(a.v)}};
  if (a.lower != usual.lower) object["lower"] = a.lower;
  if (a.upper != usual.upper) object["upper"] = a.upper;
  if (a.friction != usual.friction) object["friction"] = a.friction;
  if (a.target != usual.target) object["target"] = a.target;
  if (a.stiffness != usual.stiffness) object["stiffness"] = a.stiffness;
  if (a.damping != usual.damping) object["damping"] = a.damping;
  return object;
}

/// Numbers that are 0 are left out.
Json with_numbers(Json object, std::initializer_list<std::pair<const char*, double>> numbers) {
  for (const auto& [key, number] : numbers)
    if (number != 0) object[key] = number;
  return object;
}

Json to_json(const Spring& s) {
  Json object = with_numbers(
      {{"a", to_json(s.a)}, {"b", to_json(s.b)}},
      {{"length", s.length}, {"stiffness", s.stiffness}, {"damping", s.damping}, {"force", s.force}});
  if (s.one_sided) object["one_sided"] = true;
  return object;
}

Json to_json(const Torsion& t) {
  return with_numbers(
      {{"axis", to_json(t.axis)}, {"u", to_json(t.u)}, {"v", to_json(t.v)}},
      {{"angle", t.angle}, {"stiffness", t.stiffness}, {"damping", t.damping}, {"torque", t.torque}});
}

Json with_surface(Json object, const Surface& s, const Filter& f) {
  if (s.friction != Surface{}.friction) object["friction"] = s.friction;
  object = with_numbers(std::move(object),
                        {{"restitution", s.restitution}, {"rolling", s.rolling}, {"spinning", s.spinning}});
  if (f.category != Filter{}.category) object["category"] = f.category;
  if (f.mask != Filter{}.mask) object["mask"] = f.mask;
  if (f.group != 0) object["group"] = f.group;
  return object;
}

Json with_motion(Json object, const GroundMotion& m) {
  if (m.platform) object["platform"] = *m.platform;
  if (m.belt != Vec3{}) object["belt"] = to_json(m.belt);
  return object;
}

Json to_json(const Capsule& c) {
  Json object{{"a", to_json(c.a)}};
  if (const Json b = to_json(c.b); b.dump() != object["a"].dump()) object["b"] = b;
  object["radius"] = c.radius;
  return with_surface(object, c.surface, c.filter);
}

Json to_json(const Plane& p) {
  Json object{{"normal", to_json(p.normal)}};
  if (p.offset != 0) object["offset"] = p.offset;
  return with_motion(with_surface(object, p.surface, p.filter), p.motion);
}

Json to_json(const Box& b) {
  Json object{{"center", to_json(b.center)}, {"half_size", to_json(b.half_size)}};
  if (b.orientation != Box{}.orientation) object["orientation"] = Json::array_of(b.orientation);
  return with_motion(with_surface(object, b.surface, b.filter), b.motion);
}

Json to_json(const Pose& p) {
  Json object{{"position", to_json(p.position)}};
  if (p.orientation != Pose{}.orientation) object["orientation"] = Json::array_of(p.orientation);
  return object;
}

template <class Item>
void append_some(std::string& out, const char* key, const std::vector<Item>& items) {
  if (!items.empty()) append_list(out, key, items, [](const Item& item) { return to_json(item); });
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
}

void append_limbs(std::string& out, const Scene& scene) {
  append_some(out, "bodies", scene.bodies);
  append_some(out, "pins", scene.pins);
  append_some(out, "alignments", scene.alignments);
  append_some(out, "angles", scene.angles);
  append_some(out, "springs", scene.springs);
  append_some(out, "torsions", scene.torsions);
  append_some(out, "capsules", scene.capsules);
  append_some(out, "planes", scene.planes);
  append_some(out, "boxes", scene.boxes);
  append_some(out, "platforms", scene.platforms);
}

}  // namespace plumb::scenes
