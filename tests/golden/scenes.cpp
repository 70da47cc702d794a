#include "golden/scenes.hpp"

#include <cmath>
#include <map>
#include <string>

#include "golden/contact_scenes.hpp"
#include "golden/table.hpp"
#include "plumb/error.hpp"
#include "scenes/basics/numbers.hpp"
#include "scenes/generators/generators.hpp"
#include "scenes/generators/wires.hpp"
#include "scenes/humanoid/humanoid.hpp"
#include "scenes/spec.hpp"
#include "support/random_trees.hpp"

namespace plumb::golden {
namespace {

/// Adds the particles, rods, bends and twists of `more`, moved by `by` (m).
void append(Scene& scene, const Scene& more, Vec3 by) {
  const auto first = static_cast<std::uint32_t>(scene.particles.size());
  for (Particle particle : more.particles) {
    particle.position += by;
    scene.particles.push_back(particle);
  }
  for (Rod rod : more.rods) {
    rod.a += first;
    rod.b += first;
    scene.rods.push_back(rod);
  }
  for (Bend bend : more.bends) {
    for (std::uint32_t* const particle : {&bend.a, &bend.b, &bend.c}) *particle += first;
    scene.bends.push_back(bend);
  }
  for (Twist twist : more.twists) {
    for (std::uint32_t& particle : twist.particles) particle += first;
    scene.twists.push_back(twist);
  }
}

Scene make_forest() {
  Scene scene;
  append(scene, scenes::make_tree(), {});
  append(scene, scenes::make_tree(), {0, 0, 2});
  append(scene, scenes::make_rods5(), {0, 0, 4});
  append(scene, scenes::make_ensemble({.chains = 6, .links = 6, .vary = 0.3}), {0, 0, 6});
  return scene;
}

Scene make_mixed() {
  Scene scene;
  append(scene, scenes::make_net(16, 16), {});
  append(scene, scenes::make_chain(20, 0.1, 10), {0, 0, 1});
  append(scene, scenes::make_truss({.bays = 5, .fixed = 2}), {0, 0, 2});
  scene.particles.push_back({.position = {0, 0, 3}, .velocity = {1, 2, 0}, .mass = 1});
  return scene;
}

/// The tests' random trees take powers of masses from the C library, but not if all are 1 kg.
Scene make_random_tree() {
  test::Random random(7);
  return test::random_tree(random, {.movable = 40, .anchors = 2, .masses = 1, .rod_mass = 0.8});
}

Scene make_ladder() {
  Scene scene = scenes::make_truss({.bays = 6, .chords = 2, .fixed = 1, .spacing = 0.25});
  for (Rod& rod : scene.rods) rod.mass = 0.4;
  scene.particles.back().fixed = true;
  return scene;
}

Scene make_hoist() {
  Scene scene;
  scene.particles = {{.position = {-1, 0, 0}, .fixed = true},
                     {.position = {1, 0.25, 0}, .fixed = true},
                     {.position = {0, -2, 0}, .mass = 20},
                     {.position = {1.5, -1, 0.5}, .mass = 8},
                     {.position = {0, -2.5, 0}, .mass = 1}};
  scene.rods = {{.a = 2, .b = 4}};
  scene.tackles = {{.particles = {0, 2, 1, 3}}};
  return scene;
}

/// More wires than a vector has lanes, twisted to both sides.
Scene make_twisted_wires() {
  Scene scene;
  for (int i = 0; i < 9; ++i)
    append(scene, scenes::make_wire({.rods = 10, .twist = 2.0 * (i - 4)}), {0, 0, 0.25 * i});
  return scene;
}

using Maker = Scene (*)();
const std::map<std::string, Maker>& makers() {
  static const std::map<std::string, Maker> all = {
      {"forest", make_forest},
      {"mixed", make_mixed},
      {"random_tree", make_random_tree},
      {"ladder", make_ladder},
      {"tower", make_tower},
      {"slide", make_slide},
      {"pool", make_pool},
      {"mechanism", make_mechanism},
      {"springs", make_springs},
      {"draped_rope", make_draped_rope},
      {"hilly", make_hilly},
      {"fallen_wire", make_fallen_wire},
      {"bridge", make_bridge},
      {"knot", make_knot},
      {"hoist", make_hoist},
      {"twisted_wires", make_twisted_wires},
      {"rollers", make_rollers},
  };
  return all;
}

void put_masses_off_the_middle(Scene& scene) {
  for (std::size_t i = 0; i < scene.rods.size(); ++i) {
    Rod& rod = scene.rods[i];
    const double length = rod_length(scene, i);
    rod.center = i % 2 == 0 ? 0.4 : 0.55;
    rod.inertia = 0.06 * rod.mass * length * length;
  }
}

void put_off_length(Scene& scene, double share) {
  for (std::size_t i = 0; i < scene.rods.size(); ++i)
    scene.rods[i].length = rod_length(scene, i) * (1 + (i % 2 == 0 ? share : -share));
}

void set_velocities(Scene& scene, double speed) {
  for (std::size_t i = 0; i < scene.particles.size(); ++i)
    if (!scene.particles[i].fixed)
      scene.particles[i].velocity = speed * Vec3{i % 2 == 0 ? 0.5 : -0.25, 0.125 * (i % 3), 1};
}

void snap(Scene& scene) {
  const auto snapped = [](double x) { return std::nearbyint(x * 0x1p40) * 0x1p-40; };
  for (Particle& particle : scene.particles)
    particle.position = {snapped(particle.position.x), snapped(particle.position.y),
                         snapped(particle.position.z)};
}

void throw_at_torso(Scene& scene, double speed) {
  scenes::throw_ball(scene, {.speed = speed, .distance = 0.6},
                     scenes::torso_center({.body = scenes::BodyType::medium}));
}

void change(Scene& scene, const std::string& key, double value) {
  if (key == "drag") {
    scene.drag = value;
  } else if (key == "joint_drag") {
    scene.joint_drag = value;
  } else if (key == "rod_drag") {
    for (Rod& rod : scene.rods)
      if (rod.mass > 0) rod.orthogonal_drag = value, rod.linear_drag = value / 4;
  } else if (key == "rod_mass") {
    for (Rod& rod : scene.rods) rod.mass = value;
  } else if (key == "uneven") {
    put_masses_off_the_middle(scene);
  } else if (key == "off_length") {
    put_off_length(scene, value);
  } else if (key == "friction") {
    for (Tackle& tackle : scene.tackles) tackle.friction = value;
  } else if (key == "velocity") {
    set_velocities(scene, value);
  } else if (key == "snap") {
    snap(scene);
  } else if (key == "ball") {
    throw_at_torso(scene, value);
  } else {
    throw InputError("'" + key + "' changes no scene");
  }
}

}  // namespace

Scene build_scene(std::string_view text) {
  const std::vector<std::string> words = split(text, ' ');
  const auto maker = makers().find(words.front());
  Scene scene = maker != makers().end() ? maker->second() : scenes::load_scene(words.front());
  for (std::size_t i = 1; i < words.size(); ++i) {
    const std::size_t equals = words[i].find('=');
    const auto value = equals == std::string::npos
                           ? std::optional<double>{}
                           : scenes::parse_number<double>(std::string_view(words[i]).substr(equals + 1));
    if (!value) throw InputError("'" + words[i] + "' is not key=number");
    change(scene, words[i].substr(0, equals), *value);
  }
  return scene;
}

}  // namespace plumb::golden
