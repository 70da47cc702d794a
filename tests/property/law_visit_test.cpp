// One rod that gives, visited again and again by the scalar body: it ends where its law says, for rods of
// every kind between ends that move at random.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "simd/relax/law_scalar.hpp"
#include "simd/relax/scalar_access.hpp"
#include "support/graphs.hpp"

namespace plumb::simd::PLUMB_TEST_FILE {
namespace {

/// A rod whose ends would move apart by `free` if it did not pull.
struct Rod {
  Giving<double> giving;
  Triple<double> free;
  double slope;  ///< infinity for a rigid rod
};

Rod random_rod(test::Random& random, bool one_sided, Gradient gradient) {
  const auto number = [&] { return test::signed_unit(random); };
  const Triple<double> d{1 + 0.2 * number(), 0.3 * number(), 0.2 * number()};
  const double l0 = std::sqrt(dot(d, d)), length = l0 * (1 + 0.1 * number()), excess = l0 - length;
  const bool rigid = test::below(random, 4) == 0;
  const double slope = rigid ? std::numeric_limits<double>::infinity() : std::exp(4 * number());
  const double taut = one_sided ? std::max(excess, 0.0) : excess;
  // What is left of the start, as prepare_laws() makes it; gradient old has a half kick of a pull, too.
  double off = rigid ? 0 : (gradient == Gradient::new_ ? -0.3 : 0.2) * taut;
  if (gradient == Gradient::old && !rigid) off += 0.02 * std::abs(number());
  const double least =
      one_sided ? std::max(rigid ? 0 : slope * off, 0.0) : -std::numeric_limits<double>::infinity();
  Rod rod{{}, {0.15 * number(), 0.15 * number(), 0.15 * number()}, slope};
  rod.giving = {.d2 = 2.0 * d,
                .e = {},
                .shift = {},
                .violation = l0 * l0 - length * length,
                .length = length,
                .least_length = 1e-6 * length,
                .one_sided = one_sided,
                .start = {rigid ? 1 : slope / (1 + slope), off, least, l0, excess},
                .omega = 1};
  return rod;
}

/// Returns the pull of a cable whose law says `pull` while it is taut.
double cable_pull(const Rod& rod, Gradient gradient, double excess) {
  const LawStart<double>& start = rod.giving.start;
  const double pull = std::max(rod.slope * (std::max(excess, 0.0) + start.off), 0.0);
  if (gradient != Gradient::mid) return pull;
  const double before = std::max(start.excess, 0.0);
  return pull * (std::max(excess, 0.0) - before) / (excess - start.excess);
}

template <Gradient gradient>
void expect_law(bool one_sided) {
  test::Random random(5);
  int slack = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    Rod rod = random_rod(random, one_sided, gradient);
    Giving<double>& at = rod.giving;
    for (int i = 0; i < 200; ++i) {
      at.e = rod.free - at.shift;
      at.shift = next_shift<gradient>(at);
    }
    at.e = rod.free - at.shift;
    const Triple<double> end2 = at.d2 + 2.0 * at.e;
    const double end = 0.5 * std::sqrt(dot(end2, end2)), excess = end - at.length;
    const Triple<double> along = gradient == Gradient::new_  ? 0.5 / end * end2
                                 : gradient == Gradient::old ? 0.5 / at.start.length * at.d2
                                                             : 1 / (at.start.length + end) * (at.d2 + at.e);
    const double pull = dot(at.shift, along) / dot(along, along);
    const Triple<double> across = at.shift - pull * along;
    EXPECT_LT(std::sqrt(dot(across, across)), 1e-12) << "it pulls along its direction";
    if (std::isinf(rod.slope)) {
      EXPECT_LT(one_sided ? excess : std::abs(excess), 1e-12);
      EXPECT_TRUE(!one_sided || pull >= 0);
      EXPECT_TRUE(!one_sided || std::min(pull, std::abs(excess)) < 1e-12) << "it pulls only if it is taut";
    } else {
      const double wanted =
          one_sided ? cable_pull(rod, gradient, excess) : rod.slope * (excess + at.start.off);
      EXPECT_NEAR(pull, wanted, 1e-12 * (1 + rod.slope));
    }
    slack += excess < 0 ? 1 : 0;
  }
  EXPECT_GT(slack, 200) << "some are slack";
  EXPECT_LT(slack, 1800) << "some are taut";
}

TEST(LawVisit, EndsWhereTheLawSays) {
  for (const bool one_sided : {false, true}) {
    expect_law<Gradient::new_>(one_sided);
    expect_law<Gradient::old>(one_sided);
    expect_law<Gradient::mid>(one_sided);
  }
}

// One visit is enough along the new direction, which a pull does not turn.
TEST(LawVisit, IsExactAlongTheNewDirection) {
  test::Random random(6);
  for (int trial = 0; trial < 100; ++trial) {
    Rod rod = random_rod(random, false, Gradient::new_);
    rod.giving.e = rod.free;
    const Triple<double> first = next_shift<Gradient::new_>(rod.giving);
    rod.giving.shift = first;
    rod.giving.e = rod.free - first;
    const Triple<double> change = next_shift<Gradient::new_>(rod.giving) - first;
    EXPECT_LT(std::sqrt(dot(change, change)), 1e-14);
  }
}

}  // namespace
}  // namespace plumb::simd::PLUMB_TEST_FILE
