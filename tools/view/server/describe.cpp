#include <algorithm>
#include <array>
#include <cmath>

#include "scenes/spec.hpp"
#include "view/exhibit/placement.hpp"
#include "view/server/messages.hpp"

namespace plumb::view {
namespace {

using scenes::Json;

Json vector(Vec3 v) {
  return Json::array_of({v.x, v.y, v.z});
}

/// Returns the number of the particle that a place is at, or an object of particles and weights.
Json place(const Point& point) {
  Json particles = Json::array(), weights = Json::array();
  std::uint32_t alone = 0;
  std::size_t used = 0;
  for (std::size_t i = 0; i < point.particles.size(); ++i) {
    if (point.weights[i] == 0) continue;
    alone = point.particles[i];
    ++used;
    particles.push_back(point.particles[i]);
    weights.push_back(point.weights[i]);
  }
  if (used == 1) return alone;
  return {{"particles", particles}, {"weights", weights}};
}

/// Returns weights w of the four particles of a body with sum w = 1 and sum w x = `at`.
std::array<double, 4> weights_in(const Scene& scene, const Body& body, Vec3 at) {
  const auto x = [&](int i) { return scene.particles[body.particles[i]].position; };
  const Vec3 a = x(1) - x(0), b = x(2) - x(0), c = x(3) - x(0), d = at - x(0);
  const double volume = dot(a, cross(b, c));
  const double u = dot(d, cross(b, c)) / volume, v = dot(a, cross(d, c)) / volume,
               w = dot(a, cross(b, d)) / volume;
  return {1 - u - v - w, u, v, w};
}

Json hulls_json(const Scene& scene) {
  Json out = Json::array();
  for (const Hull& hull : scene.hulls) {
    const Body& body = scene.bodies[hull.body];
    Json weights = Json::array();
    for (const Vec3& point : hull.points)
      for (const double w : weights_in(scene, body, point)) weights.push_back(w);
    out.push_back(
        {{"particles", Json::array_of(body.particles)}, {"weights", weights}, {"radius", hull.radius}});
  }
  return out;
}

Json ground_json(const Scene& scene) {
  Json out{{"planes", Json::array()}, {"boxes", Json::array()},  {"capsules", Json::array()},
           {"hulls", Json::array()},  {"meshes", Json::array()}, {"heights", Json::array()}};
  for (const Plane& each : scene.planes)
    out["planes"].push_back({{"normal", vector(each.normal)}, {"offset", each.offset}});
  for (const Box& each : scene.boxes)
    out["boxes"].push_back({{"center", vector(each.center)},
                            {"half_size", vector(each.half_size)},
                            {"orientation", Json::array_of(each.orientation)}});
  for (const GroundCapsule& each : scene.ground_capsules)
    out["capsules"].push_back({{"a", vector(each.a)}, {"b", vector(each.b)}, {"radius", each.radius}});
  for (const GroundHull& each : scene.ground_hulls) {
    Json points = Json::array();
    for (const Vec3& point : each.points) points.push_back(vector(point));
    out["hulls"].push_back({{"points", points}, {"radius", each.radius}});
  }
  for (const GroundMesh& each : scene.meshes) {
    Json vertices = Json::array(), triangles = Json::array();
    for (const Vec3& v : each.vertices) vertices.push_back(vector(v));
    for (const auto& triangle : each.triangles) triangles.push_back(Json::array_of(triangle));
    out["meshes"].push_back({{"vertices", vertices}, {"triangles", triangles}});
  }
  for (const HeightField& each : scene.height_fields)
    out["heights"].push_back({{"corner", vector(each.corner)},
                              {"cell_x", each.cell_x},
                              {"cell_z", each.cell_z},
                              {"columns", each.columns},
                              {"heights", Json::array_of(each.heights)}});
  return out;
}

Json capsules_json(const Scene& scene) {
  Json out = Json::array();
  for (const Capsule& each : scene.capsules)
    out.push_back({{"a", place(each.a)}, {"b", place(each.b)}, {"radius", each.radius}});
  return out;
}

}  // namespace

Json scene_json(const Exhibit& exhibit) {
  const Side& side = exhibit.sides().front();
  const Scene& scene = side.scene();
  const std::vector<double> masses = lumped_masses(scene);
  Json rods = Json::array(), shown = Json::array(), places = Json::array(), tackles = Json::array();
  for (const Rod& rod : scene.rods)
    for (const std::uint32_t end : {rod.a, rod.b}) rods.push_back(end);
  for (const double mass : masses) shown.push_back(std::isfinite(mass) ? Json(mass) : Json());
  for (const Vec3& p : side.positions())
    for (const double component : {p.x, p.y, p.z}) places.push_back(component);
  const Placement placement = place_rods(scene);
  for (const Tackle& each : scene.tackles) tackles.push_back(Json::array_of(each.particles));
  return {{"kind", "scene"},
          {"name", exhibit.start().name},
          {"rods", rods},
          {"masses", shown},
          {"places", places},
          {"islands", Json::array_of(side.islands())},
          {"colors", Json::array_of(placement.color_of_rod)},
          {"lanes", Json::array_of(placement.lane_of_rod)},
          {"capsules", capsules_json(scene)},
          {"hulls", hulls_json(exhibit.start().scene)},
          {"ground", ground_json(scene)},
          {"tackles", tackles},
          {"reels", scene.reels.size()},
          {"has_shapes", !scene.capsules.empty() || !scene.hulls.empty()}};
}

Json sides_json(const Exhibit& exhibit) {
  Json sides = Json::array();
  std::vector<std::string> names;
  for (const Side& side : exhibit.sides()) {
    names.push_back(side.name());
    sides.push_back(
        {{"name", names.back()}, {"settings", choices_json(side.settings())}, {"rebuilds", side.rebuilds()}});
  }
  const Comparison shown = comparison_of(names);
  const Scene& scene = exhibit.sides().front().scene();
  const std::uint32_t end = end_particle(exhibit.start().scene);
  // A point of a body has no mass of its own, and a ball alone is no end.
  const bool is_end = std::any_of(scene.rods.begin(), scene.rods.end(),
                                  [&](const Rod& rod) { return rod.a == end || rod.b == end; });
  const bool has_mass = is_end && scene.particles[end].mass > 0;
  const Json end_mass = has_mass ? Json(scene.particles[end].mass) : Json();
  return {{"kind", "sides"},
          {"sides", sides},
          {"comparison", shown.name},
          {"about", shown.about},
          {"hint", has_mass ? shown.hint : ""},
          {"gravity", -scene.gravity.y},
          {"drag", scene.drag},
          {"end_mass", end_mass}};
}

Json menu_json() {
  Json scenes = Json::array(), compared = Json::array(), methods = Json::array();
  for (const scenes::GeneratorHelp& each : scenes::list_generators())
    scenes.push_back({{"name", each.name}, {"about", each.summary}, {"parameters", each.parameters}});
  for (const Comparison& each : comparisons()) compared.push_back(each.name);
  for (const MethodInfo& each : all_methods())
    methods.push_back({{"name", each.name}, {"about", each.moves}, {"reads", Json::array_of(each.reads)}});
  return {{"kind", "menu"},
          {"scenes", scenes},
          {"comparisons", compared},
          {"methods", methods},
          {"stages", Json::array_of(stage_names)}};
}

Json note_json(std::string_view text, bool refused) {
  return {{"kind", "note"}, {"text", text}, {"refused", refused}};
}

}  // namespace plumb::view
