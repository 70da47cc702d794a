#pragma once

#include "plumb/scene.hpp"

/// Scenes whose rods give.
namespace plumb::test {

/// The scene, with this law for all of its rods. Lengths stay what they are.
inline Scene with_law(Scene scene, const RodLaw& law) {
  for (Rod& rod : scene.rods) rod.law = law;
  return scene;
}

}  // namespace plumb::test
