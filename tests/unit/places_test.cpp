#include "step/places.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "interface/place.hpp"

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

TEST(Places, ComeInRunsOfOneSolver) {
  const Places::Entry entries[] = {{0, {0, 5}}, {1, {0, 4}}, {2, {1, 0}},
                                   {4, {1, 1}}, {4, {1, 2}}, {5, {1, 3}}};
  const Places places(7, entries);
  std::vector<std::uint32_t> firsts, counts, sizes;
  places.for_runs(6, [&](std::uint32_t first, std::uint32_t count, std::span<const Place> of) {
    firsts.push_back(first);
    counts.push_back(count);
    sizes.push_back(static_cast<std::uint32_t>(of.size()));
  });
  EXPECT_EQ(firsts, (std::vector<std::uint32_t>{0, 2, 3, 4, 5}));
  EXPECT_EQ(counts, (std::vector<std::uint32_t>{2, 1, 1, 1, 1}));
  EXPECT_EQ(sizes, (std::vector<std::uint32_t>{2, 1, 0, 2, 1}));
}

// Others keep theirs, also where many changes leave gaps that are closed again.
TEST(Places, MayBeReplaced) {
  const Places::Entry entries[] = {{0, {0, 0}}, {1, {0, 1}}, {1, {1, 0}}, {2, {1, 1}}};
  Places places(3, entries);
  const auto of = [&](std::uint32_t particle) {
    const auto list = places.of(particle);
    return std::vector<Place>(list.begin(), list.end());
  };
  EXPECT_EQ(places.uses(1), 2u);
  for (std::uint32_t i = 0; i < 20; ++i) {
    const std::vector<Place> more{{5, i}, {5, i + 1}, {1, i}}, one{{0, i}};
    places.replace(1, more);
    EXPECT_EQ(of(1), more);
    EXPECT_EQ(places.uses(5), 2u);
    EXPECT_EQ(places.uses(1), 2u);
    places.replace(1, one);
    EXPECT_EQ(of(1), one);
    EXPECT_EQ(places.uses(0), 2u);
    EXPECT_EQ(of(0), (std::vector<Place>{{0, 0}}));
    EXPECT_EQ(of(2), (std::vector<Place>{{1, 1}}));
  }
  places.replace(2, {});
  EXPECT_TRUE(places.of(2).empty());
  EXPECT_EQ(places.uses(1), 0u);
}

// A run ends where places do not follow each other any more.
TEST(Places, ComeInRunsAfterChanges) {
  const Places::Entry entries[] = {{0, {0, 0}}, {1, {0, 1}}, {2, {0, 2}}};
  Places places(3, entries);
  places.replace(1, std::vector<Place>{{0, 7}, {0, 8}});
  places.replace(1, std::vector<Place>{{0, 9}});
  std::vector<std::uint32_t> counts, slots;
  places.for_runs(3, [&](std::uint32_t, std::uint32_t count, std::span<const Place> of) {
    counts.push_back(count);
    for (const Place& place : of) slots.push_back(place.slot);
  });
  EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), 0u), 3u);
  EXPECT_EQ(slots, (std::vector<std::uint32_t>{0, 9, 2}));
}

TEST(Places, MayBeOfNothing) {
  const Places places(0, {});
  SUCCEED();
}

}  // namespace
}  // namespace plumb::detail
