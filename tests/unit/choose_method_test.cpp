// What method automatic chooses for an island, by its shape, its masses and the accuracy asked for.

#include "step/compile/choose_method.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

#include "interface/island_shape.hpp"
#include "support/graphs.hpp"
#include "support/worlds.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
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

// Vast is what would need minutes and gigabytes to factorise. Long lattices are not, however many particles
// they have.
TEST(IslandShape, VastIslandsAreWideAndLarge) {
  EXPECT_FALSE(is_vast(test::lattice(300, 300).view()));
  EXPECT_FALSE(is_vast(test::lattice(10'000, 20).view()));
  EXPECT_TRUE(is_vast(test::lattice(400, 400).view()));
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

TEST(ChooseMethod, RelaxesVastIslandsOfMasslessRodsAlone) {
  const Settings plain{.method = Method::automatic}, accurate{.method = Method::automatic, .accuracy = 1e-3};
  for (const IslandShape shape : {IslandShape::tree, IslandShape::thin, IslandShape::wide})
    EXPECT_EQ(choose_method(two_rods(0), shape, both, plain), Method::direct);
  EXPECT_EQ(choose_method(two_rods(0), IslandShape::vast, both, plain), Method::relax);
  EXPECT_EQ(choose_method(two_rods(2), IslandShape::vast, both, plain), Method::direct);
  EXPECT_EQ(choose_method(two_rods(0), IslandShape::vast, both, accurate), Method::direct);
}

TEST(ChooseMethod, TakesTheGradientThatIsSet) {
  Settings settings{.method = Method::automatic};
  const auto choose = [&](IslandShape shape, double mass) {
    return choose_gradient(two_rods(mass), shape, both, settings);
  };
  for (const IslandShape shape : {IslandShape::tree, IslandShape::tied, IslandShape::thin})
    EXPECT_EQ(choose(shape, 0), Gradient::mid);
  for (const IslandShape shape : {IslandShape::wide, IslandShape::vast}) {
    EXPECT_EQ(choose(shape, 0), Gradient::new_);
    EXPECT_EQ(choose(shape, 2), Gradient::mid) << "rods with mass";
  }
  settings.accuracy = 1e-3;
  for (const IslandShape shape : {IslandShape::tree, IslandShape::thin, IslandShape::wide})
    EXPECT_EQ(choose(shape, 0), Gradient::old);
  EXPECT_EQ(choose(IslandShape::tree, 2), Gradient::old);
  EXPECT_EQ(choose(IslandShape::wide, 2), Gradient::mid) << "loops with mass";
  EXPECT_EQ(choose(IslandShape::tied, 2), Gradient::old) << "of order 4";
  settings.accuracy = 1e-2;
  EXPECT_EQ(choose(IslandShape::tied, 2), Gradient::mid) << "loops through anchors";
  EXPECT_EQ(choose(IslandShape::tied, 0), Gradient::old);
  settings.gradient = Gradient::new_;
  EXPECT_EQ(choose(IslandShape::tree, 0), Gradient::new_);
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
}  // namespace plumb::detail::PLUMB_TEST_FILE
