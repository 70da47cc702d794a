#include "step/places.hpp"

#include <gtest/gtest.h>

namespace plumb::detail {
namespace {

TEST(Places, ListEveryPlaceOfAParticleInOrder) {
  const Places::Entry entries[] = {{2, {0, 0}}, {0, {0, 1}}, {2, {0, 2}}, {1, {1, 0}}, {2, {1, 1}}};
  const Places places(3, entries);
  const auto of = [&](std::uint32_t particle) {
    const auto list = places.of(particle);
    return std::vector<Place>(list.begin(), list.end());
  };
  EXPECT_EQ(of(0), (std::vector<Place>{{0, 1}}));
  EXPECT_EQ(of(1), (std::vector<Place>{{1, 0}}));
  EXPECT_EQ(of(2), (std::vector<Place>{{0, 0}, {0, 2}, {1, 1}}));
}

TEST(Places, MayBeOfNothing) {
  const Places places(0, {});
  SUCCEED();
}

}  // namespace
}  // namespace plumb::detail
