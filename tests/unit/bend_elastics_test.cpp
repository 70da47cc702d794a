// The laws by which bends of linkages pull have the slope of a bend's energy where they are made.

#include "contact/elastics/bend_elastics.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "scene/bends/curvature.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

BendElastics bend_at_rest(double angle, double damping) {
  return {.stiffness = 3, .damping = damping, .curvature = curvature_of_angle(angle)};
}
/// dE/d|w|, by central differences.
double pull_of(const BendElastics& bend, double bent) {
  const double step = 1e-5;
  const auto energy = [&](double by) { return bending_energy(bend.stiffness, bend.curvature, by * by); };
  return (energy(bent + step) - energy(bent - step)) / (2 * step);
}

TEST(BendElastics, PullAsTheEnergySays) {
  for (const double bent : {0.01, 0.3, 1.0, 1.9, 1.99}) {
    const Vec3 w = bent * Vec3{0.48, -0.6, 0.64};
    std::array<ElasticLaw, 4> laws;
    const BendElastics straight = bend_at_rest(0, 0);
    set_laws(straight, w, std::span(laws).first(3));
    for (const ElasticLaw& law : std::span(laws).first(3))
      EXPECT_NEAR(law.stiffness * bent, pull_of(straight, bent), 1e-6 * law.stiffness) << bent;
    const BendElastics curved = bend_at_rest(0.8, 0);
    set_laws(curved, w, std::span(laws).first(1));
    EXPECT_NEAR(laws[0].stiffness * (bent - laws[0].rest), pull_of(curved, bent), 1e-6 * laws[0].stiffness);
  }
}

// The angle of w is phi = 2 asin(|w|/2), by whose rate a bend is damped.
TEST(BendElastics, DampTheAngle) {
  const double bent = 1.2, rate = 1 / std::sqrt(1 - bent * bent / 4);
  std::array<ElasticLaw, 4> laws;
  set_laws(bend_at_rest(0, 0.5), bent * Vec3{0, 1, 0}, laws);
  EXPECT_NEAR(laws[3].damping, 0.5 * rate * rate, 1e-12);
  EXPECT_EQ(laws[3].stiffness, 0);
  for (const ElasticLaw& law : std::span(laws).first(3)) EXPECT_EQ(law.damping, 0);
  set_laws(bend_at_rest(0.8, 0.5), bent * Vec3{0, 1, 0}, std::span(laws).first(1));
  EXPECT_NEAR(laws[0].damping, 0.5 * rate * rate, 1e-12);
}

TEST(BendElastics, PassTheStraightLine) {
  std::array<ElasticLaw, 1> laws;
  const BendElastics curved = bend_at_rest(0.8, 0);
  set_laws(curved, {}, laws);
  EXPECT_NEAR(laws[0].rest, curved.curvature, 1e-15);
  EXPECT_EQ(laws[0].stiffness, 3);
}

TEST(BendElastics, HaveWeightsThatAddUpToNothing) {
  const Combination w = bend_vector({.a = 0, .b = 1, .c = 2, .stiffness = 1}, {0.5, 0.25});
  double sum = 0;
  for (std::uint32_t i = 0; i < w.count; ++i) sum += w.terms[i].weight;
  EXPECT_EQ(sum, 0);
  const std::array<Vec3, 3> straight{Vec3{0, 0, 0}, {0.5, 0, 0}, {0.75, 0, 0}},
      right{Vec3{}, {0.5, 0, 0}, {0.5, 0.25, 0}};
  EXPECT_EQ(norm(w.of(straight)), 0);
  EXPECT_NEAR(norm(w.of(right)), std::sqrt(2), 1e-15);
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
