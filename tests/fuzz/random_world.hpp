#pragma once

#include <cstddef>
#include <cstdint>

#include "plumb/scene.hpp"
#include "plumb/settings.hpp"

namespace plumb::fuzz {

/// A small scene, how to step it and what to do to it meanwhile. Mostly valid: what is not is refused.
struct RandomWorld {
  Scene scene;
  Settings settings;
  double dt = 1.0 / 60;
  int steps = 0;
  std::uint32_t pushed = 0;  ///< particle
  Vec3 push{};               ///< N, if it is movable; else how far it is moved, m
};

/// The bytes decide all of it. Sizes and substeps are bounded, so that a step takes milliseconds.
RandomWorld make_random_world(const std::uint8_t* data, std::size_t size);

}  // namespace plumb::fuzz
