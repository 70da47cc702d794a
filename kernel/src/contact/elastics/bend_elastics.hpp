#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "contact/elastics/elastic.hpp"
#include "plumb/scene.hpp"

namespace plumb::detail {

/// A bend of a linkage pulls along its w (scene/bends/curvature.hpp), whose parts along the axes are elastics
/// where it is straight at rest. Where it is not, |w| is one. Its law is not linear in them, so that they
/// follow its tangent or its secant, which is renewed in the middle of every substep.
struct BendElastics {
  double stiffness, damping;           ///< N m, N m s
  double curvature;                    ///< at rest
  std::uint32_t first = 0, count = 0;  ///< of its elastics
  std::vector<std::uint32_t> rods{};   ///< numbers among rods that give, without which it does not act

  bool is_straight() const { return curvature == 0; }
};

/// Returns the w of a bend with the lengths (m) from a to b and from b to c.
Combination bend_vector(const Bend& bend, const std::array<double, 2>& lengths);

/// Writes how a bend with the vector w pulls into the laws of its elastics.
void set_laws(const BendElastics& bend, Vec3 w, std::span<ElasticLaw> laws);

}  // namespace plumb::detail
