#pragma once

#include <cstdint>

#include "contact/pulls/touched_pairs.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/vec3.hpp"

namespace plumb::detail {

/// Adds up the impulses by which an island was held together and pushed in a step. It has no numbers unless
/// it counts, but for what touched.
struct LinkagePulls {
  bool counts = false;
  double dt = 0;            ///< s, of the step; 0 before the first
  Array<double> rods;       ///< N s, by the part's rods: how they pulled
  Array<Vec3> pins;         ///< N s, on the places a
  Array<double> angles;     ///< N m s, of limits and friction, which widen if positive
  Array<double> elastics;   ///< N s or N m s: how they pulled
  Array<Vec3> along_first;  ///< N s or N s/m, by elastic: that pull along the gradient of its first sum
  Array<Vec3> shapes;       ///< N s, by which contacts pushed
  Array<Vec3> fixed;        ///< N s, on the fixed particles
  TouchedPairs touched;     ///< what pushed shapes, which may count without the others

  /// Begins a step. The pulls of the one before are kept until then, also through sleep.
  void begin_step();
  /// Returns whether somebody asks what pushes the island.
  bool are_asked_for() const { return counts || touched.counts; }
};

template <class Archive>
void visit_members(Archive& archive, LinkagePulls& of) {
  auto& [counts, dt, rods, pins, angles, elastics, along_first, shapes, fixed, touched] = of;
  archive(dt, rods, pins, angles, elastics, along_first, shapes, fixed, touched);
}

}  // namespace plumb::detail
