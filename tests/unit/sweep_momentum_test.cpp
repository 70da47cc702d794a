// Sweeps with momentum solve what piles ask for.

#include "contact/relaxed/visits/sweep_momentum.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

constexpr std::size_t layers = 100;

/// Visits the pushes between the layers of a pile once, each after the one below.
void sweep(std::vector<double>& pushes) {
  for (std::size_t i = 0; i < layers; ++i)
    pushes[i] = 0.5 * ((i > 0 ? pushes[i - 1] : 0) + (i + 1 < layers ? pushes[i + 1] : 0));
}

/// What `sweeps` leave of a push that all layers share.
double left_after(int sweeps, bool has_momentum) {
  std::vector<double> pushes(layers);
  for (std::size_t i = 0; i < layers; ++i)
    pushes[i] = std::sin(std::numbers::pi * static_cast<double>(i + 1) / (layers + 1));
  // One half lies apart from the other, as fields of vectors do.
  const std::array<SweptNumbers<double>, 2> swept{SweptNumbers<double>{pushes.data(), 10, 10, 5},
                                                  SweptNumbers<double>{pushes.data() + 50, 50, 0, 1}};
  SweepMomentum<double> momentum;
  momentum.begin(swept);
  for (int i = 0; i < sweeps; ++i) {
    sweep(pushes);
    if (has_momentum) momentum.go_on(swept);
  }
  double most = 0;
  for (const double each : pushes) most = std::max(most, std::abs(each));
  return most;
}

// A sweep leaves cos^2(pi/101) of the slowest mode, 1 - w^2 with w = 0.0311. With momentum, k sweeps leave
// 2 J1(wk)/(wk), which is 0 at k = 123 (Su, Boyd and Candes, JMLR 17, 2016, 153, equation 3). Bounds have
// room for what is not continuous in k.
TEST(SweepMomentum, SolvesAPileInAsManySweepsAsLayers) {
  EXPECT_GT(left_after(123, false), 0.85);
  EXPECT_LT(left_after(123, true), 0.1);
}

TEST(SweepMomentum, LeavesWhatIsSolved) {
  std::array<double, 4> numbers{1, 2, 3, 4};
  const std::array<SweptNumbers<double>, 1> swept{SweptNumbers<double>{numbers.data(), 4, 0, 1}};
  SweepMomentum<double> momentum;
  momentum.begin(swept);
  for (int i = 0; i < 5; ++i) momentum.go_on(swept);
  EXPECT_EQ(numbers, (std::array<double, 4>{1, 2, 3, 4}));
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
