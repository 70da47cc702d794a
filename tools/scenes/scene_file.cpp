#include "scenes/scene_file.hpp"

#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "plumb/error.hpp"
#include "scenes/files.hpp"
#include "scenes/lists.hpp"

namespace plumb::scenes {
namespace {

using nlohmann::json;

[[noreturn]] void refuse(const std::string& path, const std::string& reason) {
  throw InputError(path + " " + reason);
}

std::string kind_of(const json& value) {
  const std::string name = value.type_name();
  return name == "object" || name == "array" ? "an " + name : name == "null" ? name : "a " + name;
}

std::string join(const std::string& path, const char* key) {
  return path.empty() ? key : path + "." + key;
}

/// An object whose keys are all known; `path` names it in messages ("" is the whole file).
class Object {
 public:
  Object(const json& value, std::string path, std::initializer_list<const char*> known)
      : value_(value), path_(std::move(path)) {
    if (!value.is_object())
      refuse(path_.empty() ? "the scene" : path_, "must be an object, not " + kind_of(value));
    for (const auto& item : value.items()) {
      bool found = false;
      std::string list;
      for (const char* key : known) {
        found = found || item.key() == key;
        append_item(list, key);
      }
      if (!found) refuse(join(path_, item.key().c_str()), "is not a known key; known are " + list);
    }
  }

  const json* find(const char* key) const {
    const auto it = value_.find(key);
    return it == value_.end() ? nullptr : &*it;
  }
  const json& at(const char* key) const {
    if (const json* found = find(key)) return *found;
    refuse(path_of(key), "is missing");
  }
  std::string path_of(const char* key) const { return join(path_, key); }

 private:
  const json& value_;
  std::string path_;
};

double number(const json& value, const std::string& path) {
  if (!value.is_number()) refuse(path, "must be a number, not " + kind_of(value));
  return value.get<double>();
}

double number_or(const Object& object, const char* key, double otherwise) {
  const json* value = object.find(key);
  return value ? number(*value, object.path_of(key)) : otherwise;
}

Vec3 vector(const json& value, const std::string& path) {
  if (!value.is_array() || value.size() != 3) {
    refuse(path, "must be three numbers [x, y, z], not " +
                     (value.is_array() ? "an array of " + std::to_string(value.size()) : kind_of(value)));
  }
  return {number(value[0], path + "[0]"), number(value[1], path + "[1]"), number(value[2], path + "[2]")};
}

Vec3 vector_or(const Object& object, const char* key, Vec3 otherwise) {
  const json* value = object.find(key);
  return value ? vector(*value, object.path_of(key)) : otherwise;
}

bool truth_or(const Object& object, const char* key, bool otherwise) {
  const json* value = object.find(key);
  if (!value) return otherwise;
  if (!value->is_boolean()) refuse(object.path_of(key), "must be true or false, not " + kind_of(*value));
  return value->get<bool>();
}

std::uint32_t particle_id(const Object& object, const char* key) {
  const json& value = object.at(key);
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() > std::numeric_limits<std::uint32_t>::max()) {
    refuse(object.path_of(key), "must be the number of a particle, counted from 0, not " +
                                    (value.is_number() ? value.dump() : kind_of(value)));
  }
  return value.get<std::uint32_t>();
}

const json& array(const Object& object, const char* key) {
  const json& value = object.at(key);
  if (!value.is_array()) refuse(object.path_of(key), "must be an array, not " + kind_of(value));
  return value;
}

Scene scene_of(const json& root) {
  const Object top(root, "", {"plumb", "gravity", "drag", "particles", "rods"});
  const json& version = top.at("plumb");
  if (!version.is_number_integer() || version != 1) {
    refuse("plumb", "is the version of the format and must be 1, not " + version.dump());
  }
  Scene scene;
  scene.gravity = vector_or(top, "gravity", scene.gravity);
  scene.drag = number_or(top, "drag", scene.drag);
  const json& particles = array(top, "particles");
  scene.particles.reserve(particles.size());
  for (const json& value : particles) {
    const Object item(value, "particles[" + std::to_string(scene.particles.size()) + "]",
                      {"position", "velocity", "mass", "fixed"});
    scene.particles.push_back({.position = vector(item.at("position"), item.path_of("position")),
                               .velocity = vector_or(item, "velocity", {}),
                               .mass = number_or(item, "mass", 0),
                               .fixed = truth_or(item, "fixed", false)});
  }
  const json& rods = array(top, "rods");
  scene.rods.reserve(rods.size());
  for (const json& value : rods) {
    const Object item(value, "rods[" + std::to_string(scene.rods.size()) + "]",
                      {"a", "b", "length", "mass", "center", "inertia"});
    scene.rods.push_back({.a = particle_id(item, "a"),
                          .b = particle_id(item, "b"),
                          .length = number_or(item, "length", 0),
                          .mass = number_or(item, "mass", 0),
                          .center = number_or(item, "center", 0.5)});
    if (const json* inertia = item.find("inertia"))
      scene.rods.back().inertia = number(*inertia, item.path_of("inertia"));
    // In a Scene 0 stands for "as far as the ends are apart"; in a file that is said by leaving the key out.
    if (item.find("length") && scene.rods.back().length == 0) {
      refuse(item.path_of("length"),
             "must be positive; leave it out for the distance between the two particles");
    }
  }
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

json to_json(Vec3 v) {
  return json::array({v.x, v.y, v.z});
}

template <class Items, class ToJson>
void append_list(std::string& out, const char* key, const Items& items, ToJson to_object) {
  out += std::string(",\n  \"") + key + "\": [";
  for (const auto& item : items) {
    out += &item == &items.front() ? "\n    " : ",\n    ";
    out += to_object(item).dump();
  }
  out += items.empty() ? "]" : "\n  ]";
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
  append_list(out, "particles", scene.particles, [](const Particle& p) {
    nlohmann::ordered_json object;
    object["position"] = to_json(p.position);
    if (p.velocity != Vec3{}) object["velocity"] = to_json(p.velocity);
    if (p.mass != 0) object["mass"] = p.mass;
    if (p.fixed) object["fixed"] = true;
    return object;
  });
  append_list(out, "rods", scene.rods, [](const Rod& r) {
    nlohmann::ordered_json object{{"a", r.a}, {"b", r.b}};
    if (r.length != 0) object["length"] = r.length;
    if (r.mass != 0) object["mass"] = r.mass;
    if (r.center != 0.5) object["center"] = r.center;
    if (r.inertia) object["inertia"] = *r.inertia;
    return object;
  });
  return out + "\n}\n";
}

Scene read_scene(const std::filesystem::path& path) {
  return parse_scene(read_file(path), path.string());
}

void write_scene(const Scene& scene, const std::filesystem::path& path) {
  write_file(path, format_scene(scene));
}

}  // namespace plumb::scenes
