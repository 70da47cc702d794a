#include "relax/plan.hpp"

#include <gtest/gtest.h>

#include <string>

#include "plumb/error.hpp"
#include "plumb/layouts/stores.hpp"
#include "support/refusals.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

std::string refusal(std::uint64_t particles, std::uint64_t rods) {
  return test::refusal([&] { require_addressable(particles, rods); });
}

constexpr std::uint32_t most_particles = (1u << 30) - (1u << 18);

TEST(Addressable, IsWhatHas32BitPlaces) {
  EXPECT_EQ(refusal(0, 0), "");
  EXPECT_EQ(refusal(most_particles, (1u << 31) - 1), "");
  EXPECT_EQ(
      refusal(most_particles + 1, 0),
      "1073479681 particles, with those that the layout adds, are too many: at most 1073479680 have 32-bit "
      "places");
  EXPECT_EQ(refusal(0, 1u << 31),
            "2147483648 rods, with those that the layout adds, are too many: at most 2147483647 have 32-bit "
            "places");
  EXPECT_NE(refusal(std::uint64_t{1} << 32, 0), "") << "beyond 32 bits";
  EXPECT_NE(refusal(0, (std::uint64_t{1} << 32) + 1), "") << "beyond 32 bits";
}

// What is let through does not wrap round in any store: the last particle's z is inside the array, after all
// others.
TEST(Addressable, FitsEveryStore) {
  using namespace layouts;
  const auto fits = [](const auto& store) {
    const std::uint64_t last = std::uint64_t{store.offset(most_particles - 1)} + 2 * store.component_stride();
    return last < store.elements() && store.elements() > 3ull * most_particles;
  };
  for (const std::uint32_t lanes : {8u, 16u}) {
    EXPECT_TRUE(fits(AosStore(most_particles, lanes)));
    EXPECT_TRUE(fits(AosoaStore(most_particles, lanes)));
    for (const std::uint32_t parts : {1u, 2u})
      EXPECT_TRUE(fits(SoaStore(most_particles, lanes, 64 / lanes, parts)));
  }
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
