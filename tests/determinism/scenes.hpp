#pragma once

#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "plumb/plumb.hpp"
#include "scenes/generators/generators.hpp"

namespace plumb::test {

/// One scene of every shape, each large enough that executors which share work early (executors.hpp) share
/// its work, and sweeps to go with it.
struct SharedScene {
  const char* name;
  Scene (*make)();
  std::uint32_t sweeps;

  friend void PrintTo(const SharedScene& scene, std::ostream* out) { *out << scene.name; }
};

inline Scene with_law(Scene scene, const RodLaw& law) {
  for (Rod& rod : scene.rods) rod.law = law;
  return scene;
}

/// Rods of many strengths, of which some break under a scene's weight.
inline Scene torn(Scene scene, const RodLaw& law) {
  scene = with_law(std::move(scene), law);
  for (std::size_t i = 0; i < scene.rods.size(); ++i)
    scene.rods[i].law.strength *= 0.1 + static_cast<double>(i * 37 % 101) / 101;
  return scene;
}

inline std::vector<SharedScene> shared_scenes() {
  return {
      {"chain", [] { return scenes::make_chain(5000, 0.1, 10); }, 4},
      {"net", [] { return scenes::make_net(48, 32); }, 4},
      {"ensemble", [] { return scenes::make_ensemble({.chains = 100, .links = 32}); }, 4},
      {"graph", [] { return scenes::make_graph({.particles = 2000, .degree = 5}); }, 5},
      {"net_of_cables",
       [] { return with_law(scenes::make_net(48, 32), {.stiffness = 1e4, .damping = 5, .one_sided = true}); },
       4},
      {"torn_net", [] { return torn(scenes::make_net(48, 32), {.strength = 60}); }, 4},
      {"torn_ensemble",
       [] {
         return torn(scenes::make_ensemble({.chains = 100, .links = 32}),
                     {.stiffness = 1e4, .one_sided = true, .strength = 60});
       },
       4},
      {"elastic_ensemble",
       [] { return with_law(scenes::make_ensemble({.chains = 100, .links = 32}), {.stiffness = 1e4}); }, 4},
  };
}

inline std::vector<Isa> supported_isas() {
  std::vector<Isa> isas;
  for (const Isa isa : all_isas())
    if (is_supported(isa)) isas.push_back(isa);
  return isas;
}

}  // namespace plumb::test
