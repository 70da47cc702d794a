#include "relax/constants.hpp"

#include <algorithm>

namespace plumb::detail {

Constants make_constants(const Scene& scene) {
  Constants constants;
  constants.length2.reserve(scene.rods.size());
  constants.inverse_mass.reserve(scene.particles.size());
  for (std::size_t i = 0; i < scene.rods.size(); ++i) {
    const double length = rod_length(scene, i);
    constants.length2.push_back(length * length);
  }
  for (const double mass : lumped_masses(scene)) constants.inverse_mass.push_back(1 / mass);
  constants.valence.assign(scene.particles.size(), 0);
  for (const Rod& rod : scene.rods) {
    ++constants.valence[rod.a];
    ++constants.valence[rod.b];
  }
  if (std::any_of(scene.rods.begin(), scene.rods.end(), [](const Rod& rod) { return !rod.law.is_rigid(); }))
    for (const Rod& rod : scene.rods) constants.laws.push_back(rod.law);
  return constants;
}

}  // namespace plumb::detail
