#include "step/places.hpp"

#include <gtest/gtest.h>

namespace plumb::detail {
namespace {

TEST(Places, ListEveryPlaceOfAParticleInOrder) {
  const std::uint32_t first[] = {2, 0, 2}, second[] = {1, 2};
  const std::span<const std::uint32_t> blocks[] = {first, second};
  const Places places(3, blocks);
  const auto of = [&](std::uint32_t particle) {
    const auto list = places.of(particle);
    return std::vector<Place>(list.begin(), list.end());
  };
  EXPECT_EQ(of(0), (std::vector<Place>{{0, 1}}));
  EXPECT_EQ(of(1), (std::vector<Place>{{1, 0}}));
  EXPECT_EQ(of(2), (std::vector<Place>{{0, 0}, {0, 2}, {1, 1}}));
  EXPECT_EQ(places.first(2), (Place{0, 0}));
}

TEST(Places, MayBeOfNothing) {
  const Places places(0, {});
  SUCCEED();
}

}  // namespace
}  // namespace plumb::detail
