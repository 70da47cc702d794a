#include "scenes/files/scene_file.hpp"

#include <set>
#include <vector>

#include "plumb/error.hpp"
#include "scenes/basics/files.hpp"
#include "scenes/files/scene_file_limbs.hpp"
#include "scenes/files/scene_json.hpp"

namespace plumb::scenes {
namespace {

Scene scene_of(const json& root) {
  const Object top(root, "",
                   {"plumb", "gravity", "drag", "joint_drag", "particles", "rods", "bodies", "pins",
                    "alignments", "angles", "capsules", "planes", "boxes"});
  const json& version = top.at("plumb");
  if (!version.is_number_integer() || version != 1) {
    refuse("plumb", "is the version of the format and must be 1, not " + version.dump());
  }
  Scene scene;
  scene.gravity = vector_or(top, "gravity", scene.gravity);
  scene.drag = number_or(top, "drag", scene.drag);
  scene.joint_drag = number_or(top, "joint_drag", scene.joint_drag);
  const json& particles = array(top, "particles");
  scene.particles.reserve(particles.size());
  for (const json& value : particles) {
    const Object item(value, "particles[" + std::to_string(scene.particles.size()) + "]",
                      {"position", "velocity", "mass", "fixed", "asleep"});
    scene.particles.push_back({.position = vector(item.at("position"), item.path_of("position")),
                               .velocity = vector_or(item, "velocity", {}),
                               .mass = number_or(item, "mass", 0),
                               .fixed = truth_or(item, "fixed", false),
                               .asleep = truth_or(item, "asleep", false)});
  }
  const json& rods = array(top, "rods");
  scene.rods.reserve(rods.size());
  for (const json& value : rods) {
    const Object item(value, "rods[" + std::to_string(scene.rods.size()) + "]",
                      {"a", "b", "length", "mass", "center", "inertia", "linear_drag", "orthogonal_drag"});
    scene.rods.push_back({.a = particle_id(item, "a"),
                          .b = particle_id(item, "b"),
                          .length = number_or(item, "length", 0),
                          .mass = number_or(item, "mass", 0),
                          .center = number_or(item, "center", 0.5),
                          .linear_drag = number_or(item, "linear_drag", 0),
                          .orthogonal_drag = number_or(item, "orthogonal_drag", 0)});
    if (const json* inertia = item.find("inertia"))
      scene.rods.back().inertia = number(*inertia, item.path_of("inertia"));
    // In a Scene 0 stands for "as far as the ends are apart"; in a file that is said by leaving the key out.
    if (item.find("length") && scene.rods.back().length == 0) {
      refuse(item.path_of("length"),
             "must be positive; leave it out for the distance between the two particles");
    }
  }
  read_limbs(top, scene);
  return scene;
}

/// The JSON value of `text`. The library keeps the last of two equal keys; here that is an error, since one
/// of the two would be ignored silently.
json parse_strictly(std::string_view text) {
  std::vector<std::set<std::string>> open;
  const auto check = [&](int, json::parse_event_t event, json& value) {
    if (event == json::parse_event_t::object_start) open.emplace_back();
    if (event == json::parse_event_t::object_end) open.pop_back();
    if (event == json::parse_event_t::key && !open.back().insert(value.get<std::string>()).second) {
      refuse("the key " + value.dump(), "appears twice in one object");
    }
    return true;
  };
  try {
    return json::parse(text, check);
  } catch (const json::exception& error) {
    std::string reason = error.what();
    if (const std::size_t end = reason.find("] "); end != std::string::npos) reason.erase(0, end + 2);
    refuse("not JSON:", reason);
  }
}

}  // namespace

Scene parse_scene(std::string_view text, std::string_view name) {
  try {
    Scene scene = scene_of(parse_strictly(text));
    validate(scene);
    return scene;
  } catch (const InputError& error) {
    throw InputError(std::string(name) + ": " + error.what());
  }
}

std::string format_scene(const Scene& scene) {
  std::string out = "{\n  \"plumb\": 1,\n  \"gravity\": " + to_json(scene.gravity).dump();
  if (scene.drag != 0) out += ",\n  \"drag\": " + json(scene.drag).dump();
  if (scene.joint_drag != 0) out += ",\n  \"joint_drag\": " + json(scene.joint_drag).dump();
  append_list(out, "particles", scene.particles, [](const Particle& p) {
    ordered_json object;
    object["position"] = to_json(p.position);
    if (p.velocity != Vec3{}) object["velocity"] = to_json(p.velocity);
    if (p.mass != 0) object["mass"] = p.mass;
    if (p.fixed) object["fixed"] = true;
    if (p.asleep) object["asleep"] = true;
    return object;
  });
  append_list(out, "rods", scene.rods, [](const Rod& r) {
    ordered_json object{{"a", r.a}, {"b", r.b}};
    if (r.length != 0) object["length"] = r.length;
    if (r.mass != 0) object["mass"] = r.mass;
    if (r.center != 0.5) object["center"] = r.center;
    if (r.inertia) object["inertia"] = *r.inertia;
    if (r.linear_drag != 0) object["linear_drag"] = r.linear_drag;
    if (r.orthogonal_drag != 0) object["orthogonal_drag"] = r.orthogonal_drag;
    return object;
  });
  append_limbs(out, scene);
  return out + "\n}\n";
}

Scene read_scene(const std::filesystem::path& path) {
  return parse_scene(read_file(path), path.string());
}

void write_scene(const Scene& scene, const std::filesystem::path& path) {
  write_file(path, format_scene(scene));
}

}  // namespace plumb::scenes
