#include "view/exhibit/limbs.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "plumb/error.hpp"

namespace plumb::view {
namespace {

bool has(const Body& body, std::uint32_t particle) {
  return std::count(body.particles.begin(), body.particles.end(), particle) > 0;
}

bool is_at(const Body& body, const Point& place) {
  for (std::size_t k = 0; k < place.particles.size(); ++k)
    if (place.weights[k] != 0 && has(body, place.particles[k])) return true;
  return false;
}

bool is_at(const Body& body, const Direction& of) {
  return is_at(body, of.from) || is_at(body, of.to);
}

}  // namespace

std::optional<Scene> with_limb_severed(const Scene& scene, std::uint32_t rod) {
  const Rod& of = scene.rods[rod];
  const auto limb = std::find_if(scene.bodies.begin(), scene.bodies.end(),
                                 [&](const Body& body) { return has(body, of.a) && has(body, of.b); });
  if (limb == scene.bodies.end()) return std::nullopt;
  Scene out = scene;
  std::size_t count = 0;
  const auto sever = [&](auto& list, auto&& sides) {
    count += std::erase_if(list, [&](const auto& item) { return sides(item); });
  };
  sever(out.pins, [&](const Pin& pin) { return is_at(*limb, pin.a) || is_at(*limb, pin.b); });
  sever(out.springs, [&](const Spring& spring) { return is_at(*limb, spring.a) || is_at(*limb, spring.b); });
  const auto turns = [&](const auto& item) { return is_at(*limb, item.u) || is_at(*limb, item.v); };
  sever(out.alignments, turns);
  sever(out.angles, turns);
  sever(out.torsions, turns);
  if (count == 0) throw InputError("rod " + std::to_string(rod) + " is of a body, which no joint holds");
  return out;
}

}  // namespace plumb::view
