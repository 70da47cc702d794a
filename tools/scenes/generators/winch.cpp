#include <numbers>

#include "scenes/basics/require.hpp"
#include "scenes/generators/generators.hpp"

namespace plumb::scenes {

Scene make_winch(const WinchShape& shape) {
  require_countable(shape.rods + std::uint64_t{2});
  require_positive(shape.cable, "cable");
  require_positive(shape.length, "length");
  require_positive(shape.mass, "mass");
  require_positive(shape.load, "load");
  const double slant = std::numbers::sqrt2 / 2;
  Scene scene;
  scene.particles.push_back({.position = {}, .fixed = true});
  for (std::uint32_t i = 0; i <= shape.rods; ++i) {
    const double out = slant * (shape.cable + i * shape.length);
    scene.particles.push_back(
        {.position = {out, -out, 0}, .mass = i == shape.rods ? shape.load : shape.mass});
    scene.rods.push_back({.a = i, .b = i + 1});
  }
  return scene;
}

}  // namespace plumb::scenes
