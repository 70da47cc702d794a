#include "scenes/generators/wires.hpp"

#include "scenes/basics/require.hpp"

namespace plumb::scenes {

Scene make_wire(const WireShape& shape) {
  require_at_least(shape.rods, 1, "rods");
  require_countable(shape.rods + std::uint64_t{2});
  require_positive(shape.length, "length");
  require_positive(shape.mass, "mass");
  require_positive(shape.bending, "bending");
  if (shape.torsion != 0) require_positive(shape.torsion, "torsion");
  const double l = shape.length / shape.rods, mass = shape.mass / shape.rods;
  Scene scene;
  scene.particles = {{.position = {-l, 0, 0}, .fixed = true}, {.position = {}, .fixed = true}};
  for (std::uint32_t i = 1; i <= shape.rods; ++i) {
    scene.particles.push_back({.position = {i * l, 0, 0}, .mass = i == shape.rods ? mass / 2 : mass});
    scene.rods.push_back({.a = i, .b = i + 1, .length = l});
    scene.bends.push_back(
        {.a = i - 1, .b = i, .c = i + 1, .stiffness = (i == 1 ? 2 : 1) * shape.bending / l});
  }
  if (shape.torsion == 0) return scene;
  Twist& twist = scene.twists.emplace_back();
  for (std::uint32_t i = 0; i < shape.rods + 2; ++i) twist.particles.push_back(i);
  twist.stiffness = shape.torsion;
  twist.angle = shape.twist;
  return scene;
}

}  // namespace plumb::scenes
