#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "contact/elastics/elastic.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/scene.hpp"

namespace plumb::detail {

/// A bend of a linkage pulls along its w (scene/bends/curvature.hpp), whose parts along the axes are elastics
/// where it is straight at rest. Where it is not, |w| is one. Its law is not linear in them, so that they
/// follow its tangent or its secant, which is renewed in the middle of every substep.
struct BendElastics {
  double stiffness, damping;           ///< N m, N m s
  double curvature;                    ///< at rest
  std::uint32_t first = 0, count = 0;  ///< of its elastics
  Array<std::uint32_t> rods{};         ///< numbers among rods that give, without which it does not act
  /// The part's rods from a to b and from b to c, or none between fixed particles.
  std::array<std::optional<std::uint32_t>, 2> sides{};

  bool is_straight() const { return curvature == 0; }
};

/// Returns the w of a bend with the lengths (m) from a to b and from b to c.
Combination bend_vector(const Bend& bend, const std::array<double, 2>& lengths);

/// Returns which of a linkage's bends an elastic is of. It must be of one.
const BendElastics& bend_of(std::span<const BendElastics> bends, std::size_t elastic);

/// A pull along a rod, in N or N s, or along none.
struct AlongRod {
  std::optional<std::uint32_t> rod;
  double pull = 0;
};
/// Returns what a bend that pulls its w so (N m or N m s) adds to the pulls of its rods at x.
std::array<AlongRod, 2> along_rods(const BendElastics& bend, const Combination& w, std::span<const Vec3> x,
                                   Vec3 pull);

/// Writes how a bend with the vector w pulls into the laws of its elastics.
void set_laws(const BendElastics& bend, Vec3 w, std::span<ElasticLaw> laws);

}  // namespace plumb::detail
