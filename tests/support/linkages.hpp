#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include "contact/linkage/linkage_state.hpp"
#include "contact/linkage/scene_parts.hpp"

/// Islands as the contact solver has them, each made from a scene.
namespace plumb::test {

/// The islands of a scene, awake.
struct Linkages {
  explicit Linkages(const Scene& scene) : parts(scene) {
    for (std::uint32_t i = 0; i < parts.count(); ++i) {
      const Scene part = parts.part(i);
      kinds.push_back(std::make_unique<detail::Linkage>(part, Isa::scalar));
      states.emplace_back(*kinds.back(), i, part).particles = parts.particles(i);
    }
  }

  detail::SceneParts parts;
  std::vector<std::unique_ptr<detail::Linkage>> kinds;
  std::vector<detail::LinkageState> states;
};

}  // namespace plumb::test
