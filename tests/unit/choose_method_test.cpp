// What method automatic chooses for an island, by its shape, its masses and the accuracy asked for.

#include "step/compile/choose_method.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

#include "interface/island_shape.hpp"
#include "support/graphs.hpp"
#include "support/worlds.hpp"

namespace plumb::detail {
namespace {

layouts::LocalGraph ring(std::uint32_t n) {
  layouts::LocalGraph g;
  g.movable.assign(n, 1);
  for (std::uint32_t i = 0; i < n; ++i) g.edges.push_back({i, (i + 1) % n});
  return g;
}

// A ring is two particles wide however long it is, and a ladder stays thin; a square net gets as wide as its
// diagonal.
TEST(IslandShape, ThinIslandsStayThinAtAnyLength) {
  for (const std::uint32_t n : {3u, 30u, 3000u}) {
    EXPECT_TRUE(is_thin(ring(n).view())) << n;
    EXPECT_TRUE(is_thin(test::lattice(n, 2).view())) << n;
  }
  EXPECT_FALSE(is_thin(test::lattice(64, 64).view()));
}

TEST(IslandShape, TheNumberingDoesNotMatter) {
  test::Random random(11);
  for (int i = 0; i < 10; ++i) {
    EXPECT_TRUE(is_thin(test::renumbered(test::lattice(100, 2), random).view()));
    EXPECT_FALSE(is_thin(test::renumbered(test::lattice(64, 64), random).view()));
  }
}

Scene two_rods(double mass) {
  Scene scene;
  scene.particles = {test::movable({0, 0, 0}), test::movable({1, 0, 0}), test::movable({2, 0, 0})};
  scene.rods = {{.a = 0, .b = 1}, {.a = 1, .b = 2, .mass = mass}};
  return scene;
}
const std::uint32_t first[] = {0}, both[] = {0, 1};

TEST(IslandShape, MassIsCarriedByRodsOfTheIslandThatHaveIt) {
  EXPECT_FALSE(carries_mass(two_rods(0), both, MassModel::consistent));
  EXPECT_TRUE(carries_mass(two_rods(2), both, MassModel::consistent));
  EXPECT_FALSE(carries_mass(two_rods(2), first, MassModel::consistent)) << "the other rod has it";
  EXPECT_FALSE(carries_mass(two_rods(2), both, MassModel::lumped));
}

std::vector<std::uint32_t> numbers(std::size_t count) {
  std::vector<std::uint32_t> out(count);
  std::iota(out.begin(), out.end(), 0u);
  return out;
}

TEST(ChooseMethod, RelaxesWideIslandsOfMasslessRodsAlone) {
  const Settings plain{.method = Method::automatic}, accurate{.method = Method::automatic, .accuracy = 1e-3};
  EXPECT_EQ(choose_method(two_rods(0), false, both, plain), Method::relax);
  EXPECT_EQ(choose_method(two_rods(0), true, both, plain), Method::direct);
  EXPECT_EQ(choose_method(two_rods(2), false, both, plain), Method::direct);
  EXPECT_EQ(choose_method(two_rods(0), false, both, accurate), Method::direct);
}

TEST(ChooseMethod, TakesTheGradientThatIsSet) {
  Settings settings{.method = Method::automatic};
  EXPECT_EQ(choose_gradient(two_rods(0), true, both, settings), Gradient::mid);
  settings.accuracy = 1e-3;
  EXPECT_EQ(choose_gradient(two_rods(0), true, both, settings), Gradient::old);
  EXPECT_EQ(choose_gradient(two_rods(2), false, both, settings), Gradient::mid) << "loops with mass";
  settings.gradient = Gradient::new_;
  EXPECT_EQ(choose_gradient(two_rods(0), true, both, settings), Gradient::new_);
}

// Order 4 is for gradient old in double, and the longer the tree, the finer the accuracy from which it pays.
TEST(ChooseMethod, OrderFourPaysFromSomeAccuracyOn) {
  const auto order = [](double accuracy, bool is_tree, std::size_t rods, Gradient gradient = Gradient::old,
                        Precision precision = Precision::double_) {
    Scene scene;
    scene.rods.resize(rods);
    return choose_time_order(scene, gradient, is_tree, numbers(rods),
                             {.method = Method::automatic, .precision = precision, .accuracy = accuracy});
  };
  const auto from = [&](bool is_tree, std::size_t rods) {
    double accuracy = 1;
    while (order(accuracy, is_tree, rods) == 2) accuracy /= 1.01;
    return accuracy;
  };
  EXPECT_GT(from(true, 10), 10 * from(true, 100));
  EXPECT_NEAR(from(false, 10), from(false, 100), 1e-12) << "of loops it does not depend on their size";
  EXPECT_EQ(order(1e-15, true, 10, Gradient::mid), 2u);
  EXPECT_EQ(order(1e-15, true, 10, Gradient::old, Precision::single), 2u);
  EXPECT_EQ(choose_time_order(two_rods(0), Gradient::old, true, both, {.method = Method::automatic}), 2u);
  Scene elastic = two_rods(0);
  elastic.rods[1].law = {.stiffness = 100, .damping = 1};
  EXPECT_EQ(
      choose_time_order(elastic, Gradient::old, true, both, {.method = Method::automatic, .accuracy = 1e-15}),
      2u);
}

}  // namespace
}  // namespace plumb::detail
