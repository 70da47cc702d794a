#include "contact/elastics/bend_elastics.hpp"

#include <algorithm>
#include <cmath>

#include "scene/bends/curvature.hpp"

namespace plumb::detail {

Combination bend_vector(const Bend& bend, const std::array<double, 2>& lengths) {
  const double over_first = 1 / lengths[0], over_second = 1 / lengths[1];
  Combination out;
  out.add(bend.a, -over_first);
  out.add(bend.b, over_first + over_second);
  out.add(bend.c, -over_second);
  return out;
}

const BendElastics& bend_of(std::span<const BendElastics> bends, std::size_t elastic) {
  return *(std::upper_bound(bends.begin(), bends.end(), elastic,
                            [](std::size_t i, const BendElastics& than) { return i < than.first; }) -
           1);
}

std::array<AlongRod, 2> along_rods(const BendElastics& bend, const Combination& w, std::span<const Vec3> x,
                                   Vec3 pull) {
  std::array<AlongRod, 2> out;
  const auto& terms = w.terms;  // of a, b and c
  for (std::size_t side = 0; side < 2; ++side) {
    const Vec3 d = x[terms[side + 1].particle] - x[terms[side].particle];
    const double share = side == 0 ? -terms[0].weight : terms[2].weight;
    out[side] = {bend.sides[side], share * dot(pull, d) / norm(d)};
  }
  return out;
}

void set_laws(const BendElastics& bend, Vec3 w, std::span<ElasticLaw> laws) {
  const double q = dot(w, w), slope = curvature_slope(q);
  const double damping = bend.damping / (1 - std::min(q, folded) / 4);  // of |w|, whose rate is not phi's
  if (bend.is_straight()) {
    for (ElasticLaw& law : laws.first(3)) law = {.stiffness = bend.stiffness * slope};
    // Its parts along the axes change as the bend turns as a whole, which nothing may brake.
    if (bend.damping > 0) laws[3] = {.damping = damping};
    return;
  }
  const double bent = std::sqrt(q), curvature = std::sqrt(squared_curvature(q));
  const double rate = curvature > 0 ? slope * bent / curvature : 1;
  laws[0] = {.rest = bent - (curvature - bend.curvature) / rate,
             .stiffness = bend.stiffness * rate * rate,
             .damping = damping};
}

}  // namespace plumb::detail
