#include <algorithm>
#include <array>
#include <cmath>

#include "plumb/measures.hpp"
#include "scenes/basics/seeded.hpp"
#include "scenes/generators/generators.hpp"
#include "stability/hangings/hangings.hpp"

namespace plumb::scenes {
namespace {

/// Returns the share by which something is longer than it need be: none, some, much, or too short.
double random_slack(Random& random) {
  switch (random.count(0, 5)) {
    case 0:
      return 0;
    case 1:
      return -random.scaled(1e-4, 0.05);
    case 2:
      return random.between(0.1, 1);
    default:
      return random.scaled(1e-4, 0.1);
  }
}

/// Returns rigid rods more often than cables and elastic ones. Stiffness is up to some 10^5 times what a
/// weight of `mass` (kg) at a rod of `length` (m) would need.
RodLaw random_law(Random& random, double mass, double length) {
  RodLaw law;
  if (random.chance(0.6)) return law;
  law.one_sided = random.chance(0.4);
  if (!law.one_sided || random.chance(0.5)) law.stiffness = mass * 9.81 / length * random.scaled(10, 1e5);
  return law;
}
void set_law(Scene& scene, Random& random) {
  const RodLaw law = random_law(random, 10, plumb::rod_length(scene, 0));
  for (Rod& rod : scene.rods) rod.law = law;
}

struct Strand {
  std::uint32_t links;
  double slack;
  double mass;        ///< Mass of a particle, in kg.
  double zigzag = 0;  ///< Every other particle starts so many rods to the side.
};
/// Adds a line between two particles, straight or in zigzag across z, of rods that are longer by the slack.
void add_line(Scene& scene, std::uint32_t from, std::uint32_t to, const Strand& strand) {
  const auto [links, slack, mass, zigzag] = strand;
  const Vec3 start = scene.particles[from].position, way = scene.particles[to].position - start;
  const double length = norm(way) * (1 + slack) / links;
  std::uint32_t last = from;
  for (std::uint32_t i = 1; i <= links; ++i) {
    std::uint32_t next = to;
    if (i < links) {
      next = static_cast<std::uint32_t>(scene.particles.size());
      const Vec3 aside{0, 0, i % 2 == 1 ? zigzag * length : 0};
      scene.particles.push_back(
          {.position = start + (static_cast<double>(i) / links) * way + aside, .mass = mass});
    }
    scene.rods.push_back({.a = last, .b = next, .length = length});
    last = next;
  }
}

Hanging make_random_line(Random& random) {
  Hanging out{"line", {}, false};
  const double slack = random_slack(random), tilt = random.chance(0.5) ? 0 : random.between(-1, 1);
  const double span = random.between(1, 20), spread = random.chance(0.3) ? 1e3 : 1;
  out.scene.particles = {{.fixed = true}, {.position = {span, tilt * span, 0}, .fixed = true}};
  const double zigzag = random.chance(0.3) ? 0.3 : 0;
  const std::uint32_t links = random.scaled(5, 300) < 60 ? random.count(5, 60) : random.count(60, 300);
  add_line(out.scene, 0, 1, {links, slack, 1, zigzag});
  for (std::size_t i = 2; i < out.scene.particles.size(); ++i)
    out.scene.particles[i].mass = random.scaled(1, spread);
  set_law(out.scene, random);
  out.must_move = slack > 0.01;
  return out;
}

Hanging make_random_net(Random& random) {
  const std::uint32_t width = random.count(3, 12), height = random.count(3, 12);
  Hanging out{"net", make_net(width, height), false};
  const double slack = random_slack(random), share = 1 / (1 + slack), spacing = 0.1;
  for (std::uint32_t i = 0; i < out.scene.particles.size(); ++i) {
    Particle& particle = out.scene.particles[i];
    particle.position.x *= share;
    if (slack > 0 && i % width % 2 == 1) particle.position.z = spacing * std::sqrt(1 - share * share);
  }
  for (Rod& rod : out.scene.rods) rod.length = spacing;
  if (random.chance(0.3))
    for (std::uint32_t i = 0; i < width; ++i) out.scene.particles[i].fixed |= i % 3 == 0;
  std::erase_if(out.scene.rods, [&](const Rod& rod) {
    return out.scene.particles[rod.a].fixed && out.scene.particles[rod.b].fixed;
  });
  set_law(out.scene, random);
  return out;
}

/// Two lines between anchors carry planks, rods with mass that join them.
Hanging make_random_bridge(Random& random) {
  Hanging out{"bridge", {}, false};
  const double span = random.between(2, 20), slack = random_slack(random), width = 1;
  const std::uint32_t links = random.count(4, 60);
  for (const double z : {0.0, width})
    for (const double x : {0.0, span}) out.scene.particles.push_back({.position = {x, 0, z}, .fixed = true});
  add_line(out.scene, 0, 1, {links, slack, 0.1});
  add_line(out.scene, 2, 3, {links, slack, 0.1});
  const RodLaw law = random_law(random, 10 * links, span / links);
  for (Rod& rod : out.scene.rods) rod.law = law;
  for (std::uint32_t i = 4; i < 3 + links; ++i)
    out.scene.rods.push_back({.a = i, .b = i + links - 1, .length = width, .mass = random.between(5, 20)});
  out.must_move = slack > 0.01;
  return out;
}

/// A truss carries a load on a line from its tip. Its own rods may be more than it needs, and one may not
/// fit.
Hanging make_random_crane(Random& random) {
  Hanging out{"crane", make_truss({.bays = random.count(2, 12), .braces = random.count(1, 2), .spacing = 1}),
              false};
  Scene& scene = out.scene;
  const auto tip = static_cast<std::uint32_t>(scene.particles.size() - 1);
  if (random.chance(0.2)) {
    Rod& rod = scene.rods[random.count(0, static_cast<std::uint32_t>(scene.rods.size() - 1))];
    const Vec3 way = scene.particles[rod.b].position - scene.particles[rod.a].position;
    rod.length = norm(way) * (1 + random.between(-2e-3, 2e-3));
  }
  const Vec3 below{0, -random.between(0.5, 3), 0};
  scene.particles.push_back(
      {.position = scene.particles[tip].position + below, .mass = random.scaled(1, 1000)});
  const std::size_t first = scene.rods.size();
  const std::uint32_t links = random.count(1, 30);
  add_line(scene, tip, tip + 1, {links, random.chance(0.5) ? 0.05 : 0, 0.1});
  const RodLaw law{.one_sided = true};
  if (random.chance(0.5))
    for (std::size_t i = first; i < scene.rods.size(); ++i) scene.rods[i].law = law;
  return out;
}

Hanging make_random_graph(Random& random) {
  Hanging out{"graph",
              make_graph({.particles = random.count(10, 120),
                          .degree = random.between(2, 5),
                          .seed = random.count(1, 1000)}),
              false};
  set_law(out.scene, random);
  return out;
}

/// Lines lead from a ring of anchors to a load in the middle.
Hanging make_random_spider(Random& random) {
  Hanging out{"spider", {}, false};
  const std::uint32_t legs = random.count(2, 6), links = random.count(2, 40);
  const double slack = random_slack(random);
  out.scene.particles.push_back({.mass = random.scaled(1, 1000)});
  for (std::uint32_t i = 0; i < legs; ++i) {
    const auto anchor = static_cast<std::uint32_t>(out.scene.particles.size());
    const double height = random.chance(0.5) ? 0 : random.between(0, 2);
    const double side = i < 2 ? (i == 0 ? -1 : 1) : random.between(-1, 1);
    out.scene.particles.push_back({.position = {3 * side, height, 3 * (1 - std::abs(side))}, .fixed = true});
    add_line(out.scene, anchor, 0, {links, slack, 0.1});
  }
  set_law(out.scene, random);
  out.must_move = slack > 0.01;
  return out;
}

}  // namespace

Hanging random_hanging(std::uint64_t seed) {
  constexpr std::array makers{make_random_line,  make_random_net,   make_random_bridge,
                              make_random_crane, make_random_graph, make_random_spider};
  Random random(seed);
  Hanging out = makers[random.count(0, makers.size() - 1)](random);
  out.scene.drag = random.chance(0.2) ? 0 : random.between(0.5, 4);
  return out;
}

}  // namespace plumb::scenes
