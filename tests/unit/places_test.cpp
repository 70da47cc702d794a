#include "step/places.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <numeric>
#include <random>
#include <span>
#include <vector>

#include "interface/place.hpp"
#include "interface/read_rows.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
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

/// Returns that of one of ropes side by side, with an anchor between each and the next.
Run rope(std::uint32_t number) {
  return Run{.first = 1 + 17 * number,
             .every = 1,
             .count = 16,
             .solver = 3,
             .slot = number,
             .slot_stride = 8,
             .address = number,
             .address_stride = 24};
}

TEST(Runs, TakeEqualOnesEvenlyApartAsRows) {
  detail::Run run = rope(0);
  EXPECT_TRUE(run.takes(rope(1)));
  EXPECT_TRUE(run.takes(rope(2)));
  EXPECT_FALSE(run.takes(rope(4)));
  for (std::uint32_t detail::Run::*const member :
       {&detail::Run::first, &detail::Run::every, &detail::Run::count, &detail::Run::solver,
        &detail::Run::slot, &detail::Run::slot_stride, &detail::Run::address, &detail::Run::address_stride,
        &detail::Run::rows}) {
    detail::Run other = rope(3);
    ++(other.*member);
    EXPECT_FALSE(run.takes(other));
  }
  EXPECT_TRUE(run.takes(rope(3)));
  EXPECT_EQ(run.rows, 4u);
  std::vector<std::uint32_t> slots(17 * 4, 99), expected = slots;
  for (std::uint32_t row = 0; row < 4; ++row)
    for (std::uint32_t i = 0; i < 16; ++i) expected[17 * row + 1 + i] = row + 8 * i;
  run.read_slots(slots.data(), [](std::uint32_t slot) { return slot; });
  EXPECT_EQ(slots, expected);
}

/// Reads runs of all forms by vectors, and one particle after the other.
template <class T>
void expect_rows_read_alike() {
  std::mt19937 random(7);
  const auto number = [&](std::uint32_t most) { return 1 + static_cast<std::uint32_t>(random()) % most; };
  for (int round = 0; round < 300; ++round) {
    const bool is_backwards = number(3) == 1;
    const std::uint32_t lanes = 8 * number(2), count = number(9), rows = number(lanes), every = number(2);
    const std::uint32_t stride = is_backwards ? 0u - 3 * lanes : 3 * lanes;
    const Run run{.first = number(5),
                  .every = every,
                  .count = count,
                  .solver = 0,
                  .slot = 0,
                  .slot_stride = 0,
                  .address = is_backwards ? 3 * lanes * (count - 1) : 0,
                  .address_stride = stride,
                  .rows = rows,
                  .row_first = every * count + number(4),
                  .row_slot = 0,
                  .row_address = 1};
    std::vector<T> numbers(3 * std::size_t{lanes} * count);
    for (T& each : numbers) each = static_cast<T>(random()) / 7;
    std::vector<Vec3> out(run.first + std::size_t{rows} * run.row_first), expected = out;
    run.read_addresses(expected.data(), [&](std::uint32_t at) {
      return Vec3{numbers[at], numbers[at + lanes], numbers[at + 2 * lanes]};
    });
    read_rows(run,
              RowsAt<T>{numbers.data() + run.address, lanes, static_cast<std::int32_t>(run.address_stride)},
              out.data());
    ASSERT_EQ(out, expected) << round;
  }
}

TEST(Runs, AreReadByVectorsAsOneByOne) {
  expect_rows_read_alike<double>();
  expect_rows_read_alike<float>();
}

TEST(Places, MayBeOfNothing) {
  const Places places(0, {});
  SUCCEED();
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
