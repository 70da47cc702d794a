#include "step/places.hpp"

#include <gtest/gtest.h>

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

// Those of numbers that stay keep their order, and others take the place of what is gone.
TEST(Places, MayBeReplaced) {
  const Places::Entry entries[] = {{0, {0, 0}}, {1, {0, 1}}, {1, {1, 0}}, {2, {1, 1}}};
  const Places::Entry made[] = {{0, {0, 7}}, {1, {1, 8}}};
  const std::uint32_t numbers[] = {2, 1}, solvers[] = {1, 5};
  const Places places = Places(3, entries)
                            .replaced([](std::uint32_t, const Place& place) { return place.solver == 1; },
                                      Places(2, made), numbers, solvers);
  EXPECT_EQ(places.count(), 3u);
  EXPECT_EQ(places.of(0).front(), (Place{0, 0}));
  EXPECT_EQ(std::vector<Place>(places.of(1).begin(), places.of(1).end()),
            (std::vector<Place>{{0, 1}, {5, 8}}));
  EXPECT_EQ(std::vector<Place>(places.of(2).begin(), places.of(2).end()), (std::vector<Place>{{1, 7}}));
}

TEST(Places, MayBeOfNothing) {
  const Places places(0, {});
  SUCCEED();
}

}  // namespace
}  // namespace plumb::detail
