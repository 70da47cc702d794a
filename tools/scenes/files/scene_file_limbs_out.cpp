// This file writes what scenes have beside particles and rods.

#include <initializer_list>
#include <utility>

#include "scenes/files/scene_file_limbs.hpp"
#include "scenes/files/scene_text.hpp"

namespace plumb::scenes {
namespace {

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
  Json object{{"u", to_json(a.u)}, {"v", to_json(a.v)}};
  if (a.value) object["value"] = *a.value;
  return object;
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
  object = with_surface(object, c.surface, c.filter);
  if (c.filter.own_island) object["own_island"] = true;
  return object;
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

Json to_json(const std::vector<Vec3>& places) {
  Json out = Json::array();
  for (const Vec3 p : places) out.push_back(to_json(p));
  return out;
}

/// A radius of 0 is left out.
Json with_radius(Json object, double radius) {
  return with_numbers(std::move(object), {{"radius", radius}});
}

Json to_json(const Hull& h) {
  return with_surface(with_radius({{"body", h.body}, {"points", to_json(h.points)}}, h.radius), h.surface,
                      h.filter);
}

Json to_json(const GroundCapsule& c) {
  Json object{{"a", to_json(c.a)}};
  if (c.b != c.a) object["b"] = to_json(c.b);
  object["radius"] = c.radius;
  return with_surface(object, c.surface, c.filter);
}

Json to_json(const GroundHull& h) {
  return with_surface(with_radius({{"points", to_json(h.points)}}, h.radius), h.surface, h.filter);
}

Json to_json(const GroundMesh& m) {
  Json triangles = Json::array();
  for (const auto& corners : m.triangles) triangles.push_back(Json::array_of(corners));
  Json object{{"vertices", to_json(m.vertices)}, {"triangles", triangles}};
  if (m.solid) object["solid"] = true;
  return with_surface(object, m.surface, m.filter);
}

Json to_json(const HeightField& f) {
  Json object{{"corner", to_json(f.corner)},
              {"cell_x", f.cell_x},
              {"cell_z", f.cell_z},
              {"columns", f.columns},
              {"heights", Json::array_of(f.heights)}};
  return with_surface(object, f.surface, f.filter);
}

template <class Item>
void append_some(std::string& out, const char* key, const std::vector<Item>& items) {
  if (!items.empty()) append_list(out, key, items, [](const Item& item) { return to_json(item); });
}

}  // namespace

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
  append_some(out, "hulls", scene.hulls);
  append_some(out, "ground_capsules", scene.ground_capsules);
  append_some(out, "ground_hulls", scene.ground_hulls);
  append_some(out, "meshes", scene.meshes);
  append_some(out, "height_fields", scene.height_fields);
}

}  // namespace plumb::scenes
