#include "scenes/generators/generators.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "plumb/error.hpp"
#include "scenes/basics/require.hpp"
#include "scenes/basics/seeded.hpp"

namespace plumb::scenes {
namespace {

void require_sound(const ChainShape& shape) {
  require_at_least(shape.links, 1, "links");
  require_positive(shape.length, "length");
  require_positive(shape.mass, "mass");
  require_positive(shape.end_mass, "end_mass");
}

void append_chain(Scene& scene, const ChainShape& shape, double z) {
  const auto root = static_cast<std::uint32_t>(scene.particles.size());
  scene.particles.push_back({.position = {0, 0, z}, .velocity = {}, .mass = 0, .fixed = true});
  for (std::uint32_t i = 1; i <= shape.links; ++i) {
    const double mass = i == shape.links ? shape.end_mass : shape.mass;
    scene.particles.push_back({.position = {i * shape.length, 0, z}, .velocity = {}, .mass = mass});
    scene.rods.push_back({.a = root + i - 1, .b = root + i, .length = shape.length});
  }
}

}  // namespace

Scene make_chain(const ChainShape& shape) {
  require_sound(shape);
  require_countable(shape.links + std::uint64_t{1});
  Scene scene;
  append_chain(scene, shape, 0);
  return scene;
}

Scene make_chain(std::uint32_t links, double length, double end_mass, double mass) {
  return make_chain({.links = links, .length = length, .mass = mass, .end_mass = end_mass});
}

Scene make_thesis5() {
  return make_chain({.links = 5, .end_mass = 2});
}

Scene make_rods5() {
  Scene scene;
  scene.particles.push_back({.position = {0, 0, 0}, .fixed = true});
  for (std::uint32_t i = 1; i <= 5; ++i) {
    scene.particles.push_back({.position = {0.2 * i, 0, 0}});
    scene.rods.push_back({.a = i - 1, .b = i, .length = 0.2, .mass = i < 5 ? 5.0 : 10.0});
  }
  return scene;
}

Scene make_tree() {
  Scene scene;
  scene.particles = {{.position = {0, 0, 0}, .fixed = true},   {.position = {0.3, 0, 0}},
                     {.position = {0.6, 0.1, 0}, .mass = 0.5}, {.position = {0.3, 0, 0.3}},
                     {.position = {0.3, 0, -0.25}, .mass = 2}, {.position = {0.6, 0.3, 0.2}},
                     {.position = {0.55, -0.2, 0.1}}};
  scene.rods = {{.a = 0, .b = 1, .mass = 2},   {.a = 1, .b = 2, .mass = 1}, {.a = 1, .b = 3, .mass = 3},
                {.a = 1, .b = 4, .mass = 0.5}, {.a = 2, .b = 5, .mass = 1}, {.a = 2, .b = 6, .mass = 4}};
  return scene;
}

Scene make_net(const NetShape& shape) {
  // With two columns the fixed corners would be neighbours, and a rod between fixed particles has no work to
  // do.
  require_at_least(shape.width, 3, "width");
  require_at_least(shape.height, 1, "height");
  require_positive(shape.spacing, "spacing");
  require_positive(shape.mass, "mass");
  require_not_negative(shape.slack, "slack");
  require_not_negative(shape.end_mass, "end_mass");
  require_countable(std::uint64_t{shape.width} * shape.height);
  const double share = 1 / (1 + shape.slack), aside = shape.spacing * std::sqrt(1 - share * share);
  Scene scene;
  scene.particles.reserve(std::size_t{shape.width} * shape.height);
  for (std::uint32_t row = 0; row < shape.height; ++row) {
    for (std::uint32_t column = 0; column < shape.width; ++column) {
      const bool fixed = row == 0 && (shape.level || column == 0 || column + 1 == shape.width);
      const double x = column * shape.spacing * share, along = row * shape.spacing;
      const double off = column % 2 == 1 ? aside : 0;
      scene.particles.push_back({.position = shape.level ? Vec3{x, off, along} : Vec3{x, 0 - along, off},
                                 .velocity = {},
                                 .mass = fixed ? 0 : shape.mass,
                                 .fixed = fixed});
      const std::uint32_t id = row * shape.width + column;
      if (column + 1 < shape.width && !(shape.level && row == 0))
        scene.rods.push_back({.a = id, .b = id + 1, .length = shape.spacing});
      if (row + 1 < shape.height)
        scene.rods.push_back({.a = id, .b = id + shape.width, .length = shape.spacing});
    }
  }
  if (shape.end_mass > 0 && !scene.particles.back().fixed) scene.particles.back().mass = shape.end_mass;
  return scene;
}

Scene make_net(std::uint32_t width, std::uint32_t height, double spacing) {
  return make_net({.width = width, .height = height, .spacing = spacing});
}

Scene make_ensemble(const EnsembleShape& shape) {
  require_at_least(shape.chains, 1, "chains");
  require_positive(shape.spacing, "spacing");
  if (!(shape.vary >= 0 && shape.vary < 1)) throw InputError("vary must be at least 0 and below 1");
  ChainShape chain{
      .links = shape.links, .length = shape.length, .mass = shape.mass, .end_mass = shape.end_mass};
  require_sound(chain);
  require_countable(std::uint64_t{shape.chains} * (shape.links + std::uint64_t{1}));
  Scene scene;
  scene.particles.reserve(std::size_t{shape.chains} * (shape.links + std::size_t{1}));
  scene.rods.reserve(std::size_t{shape.chains} * shape.links);
  std::mt19937_64 random(shape.seed);
  for (std::uint32_t i = 0; i < shape.chains; ++i) {
    chain.end_mass = shape.end_mass * (1 + shape.vary * (2 * unit_double(random) - 1));
    append_chain(scene, chain, i * shape.spacing);
  }
  return scene;
}

Scene make_line(const LineShape& shape) {
  require_at_least(shape.links, 2, "links");
  require_positive(shape.span, "span");
  require_positive(shape.mass, "mass");
  if (!(shape.slack > -1 && std::isfinite(shape.slack)))
    throw InputError("slack must be above -1 and finite");
  require_countable(shape.links);
  Scene scene;
  const double length = shape.span * (1 + shape.slack) / shape.links;
  for (std::uint32_t i = 0; i <= shape.links; ++i) {
    const bool is_anchor = i == 0 || i == shape.links;
    scene.particles.push_back({.position = {shape.span * i / shape.links, 0, 0},
                               .velocity = {},
                               .mass = is_anchor ? 0 : shape.mass,
                               .fixed = is_anchor});
    if (i > 0) scene.rods.push_back({.a = i - 1, .b = i, .length = length});
  }
  return scene;
}

Scene make_ring(const RingShape& shape) {
  require_at_least(shape.links, 3, "links");
  require_positive(shape.length, "length");
  require_positive(shape.mass, "mass");
  require_countable(shape.links);
  Scene scene;
  const double radius = shape.length / (2 * std::sin(std::numbers::pi / shape.links));
  for (std::uint32_t i = 0; i < shape.links; ++i) {
    const double angle = 2 * std::numbers::pi * i / shape.links;
    const bool top = i == 0;
    scene.particles.push_back({.position = {radius * std::sin(angle), radius * (std::cos(angle) - 1), 0},
                               .velocity = {},
                               .mass = top ? 0 : shape.mass,
                               .fixed = top});
    scene.rods.push_back({.a = i, .b = (i + 1) % shape.links, .length = shape.length});
  }
  return scene;
}

Scene make_truss(const TrussShape& shape) {
  const std::uint32_t chords = shape.chords;
  require_at_least(shape.bays, 1, "bays");
  if (chords != 2 && chords != 3) throw InputError("chords must be 2 or 3");
  if (shape.braces != 1 && shape.braces != 2) throw InputError("braces must be 1 or 2");
  if (shape.fixed > chords) throw InputError("fixed must be at most the number of chords");
  require_positive(shape.spacing, "spacing");
  require_positive(shape.mass, "mass");
  require_countable(std::uint64_t{chords} * (shape.bays + std::uint64_t{1}));
  const std::uint32_t held = shape.fixed == 0 ? chords : shape.fixed;
  const double s = shape.spacing;
  const Vec3 section[3] = {
      {0, 0, 0}, chords == 2 ? Vec3{0, -s, 0} : Vec3{0, 0, s}, {0, -s * std::sqrt(0.75), s / 2}};
  Scene scene;
  const auto tie = [&](std::uint32_t a, std::uint32_t b) {
    if (!scene.particles[a].fixed || !scene.particles[b].fixed) scene.rods.push_back({.a = a, .b = b});
  };
  for (std::uint32_t station = 0; station <= shape.bays; ++station)
    for (std::uint32_t k = 0; k < chords; ++k) {
      const bool fixed = station == 0 && k < held;
      scene.particles.push_back({.position = section[k] + Vec3{station * s, 0, 0},
                                 .velocity = {},
                                 .mass = fixed ? 0 : shape.mass,
                                 .fixed = fixed});
    }
  for (std::uint32_t station = 0; station <= shape.bays; ++station) {
    const std::uint32_t here = station * chords, next = here + chords;
    for (std::uint32_t k = 0; k + 1 < chords; ++k) tie(here + k, here + k + 1);
    if (chords == 3) tie(here + 2, here);
    if (station == shape.bays) break;
    for (std::uint32_t k = 0; k < chords; ++k) tie(here + k, next + k);
    for (std::uint32_t k = 0; k < (chords == 2 ? 1 : 3); ++k) {
      const std::uint32_t other = (k + 1) % chords;
      tie(here + k, next + other);
      if (shape.braces == 2) tie(here + other, next + k);
    }
  }
  return scene;
}

}  // namespace plumb::scenes
