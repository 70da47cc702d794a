#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "plumb/shapes/queries.hpp"
#include "queries/things.hpp"
#include "step/breaks/numbers.hpp"

namespace plumb::detail {

/// Lists the rods and particles of a world that no shape and no body shows. What was added or joined since
/// the scene is bare: it comes without shapes.
class Bare {
 public:
  Bare(const Scene& scene, const QuerySettings& settings);

  /// Takes those that are there, in the scene as it is now.
  void find(const Scene& now, const Population& population);

  std::span<const BareRod> rods() const { return rods_; }
  std::span<const std::uint32_t> particles() const { return particles_; }

 private:
  bool finds_rods_, finds_particles_;
  std::vector<std::uint8_t> shown_rods_, shown_particles_;  ///< of the scene
  std::vector<BareRod> rods_;
  std::vector<std::uint32_t> particles_;
};

}  // namespace plumb::detail
