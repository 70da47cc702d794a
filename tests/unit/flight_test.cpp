// How a linkage alone in the air moves through one step.

#include "contact/linkage/flight.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "plumb/inertia.hpp"
#include "support/bodies.hpp"
#include "support/linkages.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

/// Two boxes on a hinge, which spin about it at different rates.
Scene hinged_boxes() {
  Scene scene;
  for (std::uint32_t i = 0; i < 2; ++i) {
    MassProperties box = solid_box(1 + i, {0.3, 0.2, 0.1});
    box.center = {0.4 * i, 0, 0};
    add_body(scene, box);
  }
  add_revolute(scene, 0, 1, {0.2, 0, 0}, {0, 0, 1});
  test::set_motion(scene, 0, {0, -1.2, 0}, {0, 0, 6});
  return scene;
}

/// The position of the first particle after 0.1 s in that many steps.
Vec3 after(std::uint32_t order, int steps) {
  test::Linkages islands(hinged_boxes());
  LinkageState& state = islands.states[0];
  Flight flight;
  Tally tally;
  for (int i = 0; i < steps; ++i) EXPECT_TRUE(flight.step(state, order, 0.1 / steps, tally)) << order;
  return state.x[0];
}

TEST(Flight, HasItsOrder) {
  const Vec3 truth = after(6, 64);
  for (const std::uint32_t order : {4u, 6u}) {
    const double coarse = norm(after(order, 4) - truth), fine = norm(after(order, 8) - truth);
    EXPECT_GT(std::log2(coarse / fine), order - 0.5) << coarse << " " << fine;
  }
}

// A step that its constraints cannot follow is refused, and nothing has moved.
TEST(Flight, PutsBackWhatItCannotLand) {
  test::Linkages islands(hinged_boxes());
  LinkageState& state = islands.states[0];
  const Array<Vec3> x = state.x, v = state.v;
  Flight flight;
  Tally tally;
  EXPECT_FALSE(flight.step(state, 4, 10, tally));
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_EQ(state.x[i], x[i]);
    EXPECT_EQ(state.v[i], v[i]);
  }
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
