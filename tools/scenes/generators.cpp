#include "scenes/generators.hpp"

#include <random>

#include "plumb/error.hpp"
#include "scenes/require.hpp"
#include "scenes/seeded.hpp"

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

Scene make_net(const NetShape& shape) {
  // With two columns the fixed corners would be neighbours, and a rod between fixed particles has no work to
  // do.
  require_at_least(shape.width, 3, "width");
  require_at_least(shape.height, 1, "height");
  require_positive(shape.spacing, "spacing");
  require_positive(shape.mass, "mass");
  require_countable(std::uint64_t{shape.width} * shape.height);
  Scene scene;
  scene.particles.reserve(std::size_t{shape.width} * shape.height);
  for (std::uint32_t row = 0; row < shape.height; ++row) {
    for (std::uint32_t column = 0; column < shape.width; ++column) {
      const bool corner = row == 0 && (column == 0 || column + 1 == shape.width);
      scene.particles.push_back({.position = {column * shape.spacing, 0 - row * shape.spacing, 0},
                                 .velocity = {},
                                 .mass = corner ? 0 : shape.mass,
                                 .fixed = corner});
      const std::uint32_t id = row * shape.width + column;
      if (column + 1 < shape.width) scene.rods.push_back({.a = id, .b = id + 1, .length = shape.spacing});
      if (row + 1 < shape.height)
        scene.rods.push_back({.a = id, .b = id + shape.width, .length = shape.spacing});
    }
  }
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

}  // namespace plumb::scenes
