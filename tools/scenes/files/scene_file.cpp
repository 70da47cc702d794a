#include "scenes/files/scene_file.hpp"

#include <cmath>

#include "plumb/error.hpp"
#include "scenes/basics/files.hpp"
#include "scenes/files/scene_file_limbs.hpp"
#include "scenes/files/scene_json.hpp"
#include "scenes/files/scene_text.hpp"

namespace plumb::scenes {
namespace {

void read_particles(const Object& top, Scene& scene) {
  const Array list(top, "particles");
  scene.particles.reserve(list.size());
  for (std::size_t i = 0; i < list.size(); ++i) {
    const Object item(list[i], list.path_of(i), {"position", "velocity", "mass", "fixed", "asleep"});
    scene.particles.push_back({.position = vector(item, "position"),
                               .velocity = vector_or(item, "velocity", {}),
                               .mass = number_or(item, "mass", 0),
                               .fixed = truth_or(item, "fixed", false),
                               .asleep = truth_or(item, "asleep", false)});
  }
}

/// A file says that a length is that of the scene as it stands by leaving the key out, where a Scene has 0.
double length_of(const Object& item, const char* otherwise) {
  const double length = number_or(item, "length", 0);
  if (item.find("length") && length == 0)
    refuse(item.path_of("length"), std::string("must be positive; leave it out for ") + otherwise);
  return length;
}

/// Reads a law but for the strength.
RodLaw law_of(const Object& item) {
  return {.stiffness = number_or(item, "stiffness", RodLaw{}.stiffness),
          .damping = number_or(item, "damping", 0),
          .one_sided = truth_or(item, "one_sided", false)};
}

void read_rods(const Object& top, Scene& scene) {
  if (!top.find("rods")) return;
  const Array list(top, "rods");
  scene.rods.reserve(list.size());
  for (std::size_t i = 0; i < list.size(); ++i) {
    const Object item(list[i], list.path_of(i),
                      {"a", "b", "length", "mass", "center", "inertia", "linear_drag", "orthogonal_drag",
                       "stiffness", "damping", "one_sided", "strength"});
    scene.rods.push_back({.a = particle_id(item, "a"),
                          .b = particle_id(item, "b"),
                          .length = length_of(item, "the distance between the two particles"),
                          .mass = number_or(item, "mass", 0),
                          .center = number_or(item, "center", 0.5),
                          .linear_drag = number_or(item, "linear_drag", 0),
                          .orthogonal_drag = number_or(item, "orthogonal_drag", 0),
                          .law = law_of(item)});
    scene.rods.back().law.strength = number_or(item, "strength", RodLaw{}.strength);
    if (item.find("inertia")) scene.rods.back().inertia = number(item, "inertia");
  }
}

void read_bends(const Object& top, Scene& scene) {
  if (!top.find("bends")) return;
  const Array list(top, "bends");
  scene.bends.reserve(list.size());
  for (std::size_t i = 0; i < list.size(); ++i) {
    const Object item(list[i], list.path_of(i), {"a", "b", "c", "stiffness", "angle", "damping"});
    scene.bends.push_back({.a = particle_id(item, "a"),
                           .b = particle_id(item, "b"),
                           .c = particle_id(item, "c"),
                           .stiffness = number_or(item, "stiffness", 0),
                           .angle = number_or(item, "angle", 0),
                           .damping = number_or(item, "damping", 0)});
  }
}

void read_twists(const Object& top, Scene& scene) {
  if (!top.find("twists")) return;
  const Array list(top, "twists");
  for (std::size_t i = 0; i < list.size(); ++i) {
    const Object item(list[i], list.path_of(i), {"particles", "stiffness", "angle"});
    Twist& twist = scene.twists.emplace_back();
    const Array particles(item, "particles");
    for (std::size_t k = 0; k < particles.size(); ++k)
      twist.particles.push_back(particle_id(particles[k], particles.path_of(k)));
    twist.stiffness = number(item, "stiffness");
    twist.angle = number_or(item, "angle", 0);
  }
}

void read_tackles(const Object& top, Scene& scene) {
  if (!top.find("tackles")) return;
  const Array list(top, "tackles");
  for (std::size_t i = 0; i < list.size(); ++i) {
    const Object item(list[i], list.path_of(i),
                      {"particles", "length", "stiffness", "damping", "one_sided", "friction"});
    const Array particles(item, "particles");
    Tackle& tackle = scene.tackles.emplace_back();
    for (std::size_t k = 0; k < particles.size(); ++k)
      tackle.particles.push_back(particle_id(particles[k], particles.path_of(k)));
    tackle.length = length_of(item, "the way through the particles");
    tackle.law = law_of(item);
    tackle.friction = number_or(item, "friction", 0);
  }
}

void read_reels(const Object& top, Scene& scene) {
  if (!top.find("reels")) return;
  const Array list(top, "reels");
  for (std::size_t i = 0; i < list.size(); ++i) {
    const Object item(list[i], list.path_of(i), {"particles", "out"});
    const Array particles(item, "particles");
    Reel& reel = scene.reels.emplace_back();
    for (std::size_t k = 0; k < particles.size(); ++k)
      reel.particles.push_back(particle_id(particles[k], particles.path_of(k)));
    reel.out = number_or(item, "out", 0);
  }
}

Scene scene_of(const json& root) {
  const Object top(
      root, "",
      {"plumb",           "gravity",      "drag",     "joint_drag",   "particles", "rods",       "bends",
       "twists",          "tackles",      "reels",    "bodies",       "pins",      "alignments", "angles",
       "springs",         "torsions",     "capsules", "planes",       "boxes",     "platforms",  "hulls",
       "ground_capsules", "ground_hulls", "meshes",   "height_fields"});
  require_version(top, "plumb", 1);
  Scene scene;
  scene.gravity = vector_or(top, "gravity", scene.gravity);
  scene.drag = number_or(top, "drag", scene.drag);
  scene.joint_drag = number_or(top, "joint_drag", scene.joint_drag);
  read_particles(top, scene);
  read_rods(top, scene);
  read_bends(top, scene);
  read_twists(top, scene);
  read_tackles(top, scene);
  read_reels(top, scene);
  read_limbs(top, scene);
  return scene;
}

}  // namespace

Scene parse_scene(std::string_view text, std::string_view name) {
  try {
    Scene scene;
    read_json(text, [&](const json& root) { scene = scene_of(root); });
    validate(scene);
    return scene;
  } catch (const InputError& error) {
    throw InputError(std::string(name) + ": " + error.what());
  }
}

namespace {

/// Writes a law but for the strength.
void write_law(const RodLaw& law, Json& object) {
  if (law.is_elastic()) object["stiffness"] = law.stiffness;
  if (law.damping != 0) object["damping"] = law.damping;
  if (law.one_sided) object["one_sided"] = true;
}

}  // namespace

std::string format_scene(const Scene& scene) {
  std::string out = "{\n  \"plumb\": 1,\n  \"gravity\": " + to_json(scene.gravity).dump();
  if (scene.drag != 0) out += ",\n  \"drag\": " + Json(scene.drag).dump();
  if (scene.joint_drag != 0) out += ",\n  \"joint_drag\": " + Json(scene.joint_drag).dump();
  append_list(out, "particles", scene.particles, [](const Particle& p) {
    Json object;
    object["position"] = to_json(p.position);
    if (p.velocity != Vec3{}) object["velocity"] = to_json(p.velocity);
    if (p.mass != 0) object["mass"] = p.mass;
    if (p.fixed) object["fixed"] = true;
    if (p.asleep) object["asleep"] = true;
    return object;
  });
  append_list(out, "rods", scene.rods, [](const Rod& r) {
    Json object{{"a", r.a}, {"b", r.b}};
    if (r.length != 0) object["length"] = r.length;
    if (r.mass != 0) object["mass"] = r.mass;
    if (r.center != 0.5) object["center"] = r.center;
    if (r.inertia) object["inertia"] = *r.inertia;
    if (r.linear_drag != 0) object["linear_drag"] = r.linear_drag;
    if (r.orthogonal_drag != 0) object["orthogonal_drag"] = r.orthogonal_drag;
    write_law(r.law, object);
    if (std::isfinite(r.law.strength)) object["strength"] = r.law.strength;
    return object;
  });
  if (!scene.bends.empty())
    append_list(out, "bends", scene.bends, [](const Bend& bend) {
      Json object{{"a", bend.a}, {"b", bend.b}, {"c", bend.c}};
      if (bend.stiffness != 0) object["stiffness"] = bend.stiffness;
      if (bend.angle != 0) object["angle"] = bend.angle;
      if (bend.damping != 0) object["damping"] = bend.damping;
      return object;
    });
  if (!scene.twists.empty())
    append_list(out, "twists", scene.twists, [](const Twist& twist) {
      Json object{{"particles", Json::array_of(twist.particles)}, {"stiffness", twist.stiffness}};
      if (twist.angle != 0) object["angle"] = twist.angle;
      return object;
    });
  if (!scene.tackles.empty())
    append_list(out, "tackles", scene.tackles, [](const Tackle& tackle) {
      Json object{{"particles", Json::array_of(tackle.particles)}};
      if (tackle.length != 0) object["length"] = tackle.length;
      write_law(tackle.law, object);
      if (tackle.friction != 0) object["friction"] = tackle.friction;
      return object;
    });
  if (!scene.reels.empty())
    append_list(out, "reels", scene.reels, [](const Reel& reel) {
      Json object{{"particles", Json::array_of(reel.particles)}};
      if (reel.out != 0) object["out"] = reel.out;
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
