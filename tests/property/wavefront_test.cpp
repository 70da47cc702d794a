// Sweeps pipelined over positions give what one sweep after the other gives, alone and cut between threads.
// The model is a line of integers whose updates do not commute, so any visit too early, too late, twice or
// never shows.

#include "threads/wavefront.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <thread>
#include <vector>

#include "support/graphs.hpp"
#include "support/sanitizers.hpp"
#include "threads/team.hpp"

namespace plumb::detail::PLUMB_TEST_FILE {
namespace {

using test::below;
using test::Random;

/// Two numbers per position, its two ends: within() changes both, across() the right end of one position and
/// the left end of the next, so that across stages of neighbours share no number, as those of packings share
/// no particle.
class Line {
 public:
  explicit Line(std::int64_t positions) : at_(static_cast<std::size_t>(positions)) {
    for (std::size_t q = 0; q < at_.size(); ++q) at_[q] = {q, ~q, 0, 0};
  }
  std::int64_t positions() const { return static_cast<std::int64_t>(at_.size()); }

  void within(std::int64_t q) {
    mix(at_[q].left, at_[q].right);
    ++at_[q].within;
  }
  /// The last position has no next one: its across stages hold only padding.
  void across(std::int64_t q) {
    if (q + 1 < positions()) mix(at_[q].right, at_[q + 1].left);
    ++at_[q].across;
  }

  void sweep() {
    for (std::int64_t q = 0; q < positions(); ++q) within(q);
    for (std::int64_t q = 0; q < positions(); ++q) across(q);
  }

  template <class Bounds>
  void run(std::int64_t sweeps, const Bounds& bounds) {
    run_wavefront(
        sweeps, bounds, [&](std::int64_t q) { within(q); }, [&](std::int64_t q) { across(q); });
  }

  friend bool operator==(const Line&, const Line&) = default;

 private:
  static void mix(std::uint64_t& a, std::uint64_t& b) {
    const std::uint64_t old = a;
    a = (a ^ (b >> 7)) * 0x9e3779b97f4a7c15u + b;
    b = (b ^ (old >> 11)) * 0xbf58476d1ce4e5b9u + old;
  }

  struct Position {
    std::uint64_t left = 0, right = 0;
    int within = 0, across = 0;  ///< visits
    friend bool operator==(const Position&, const Position&) = default;
  };
  std::vector<Position> at_;
};

Line swept(std::int64_t positions, std::int64_t sweeps) {
  Line line(positions);
  for (std::int64_t s = 0; s < sweeps; ++s) line.sweep();
  return line;
}

/// The bounds of part `part` of `parts`, cut as threads cut positions.
std::int64_t cut(std::int64_t positions, unsigned part, unsigned parts) {
  return Team::begin_of(static_cast<std::uint32_t>(positions), part, parts);
}
Trapezoid trapezoid(std::int64_t positions, unsigned part, unsigned parts) {
  return {cut(positions, part, parts), cut(positions, part + 1, parts), part == 0, part + 1 == parts};
}

TEST(Wavefront, AloneEqualsPlainSweeps) {
  for (std::int64_t positions = 1; positions <= 40; ++positions)
    for (std::int64_t sweeps = 0; sweeps <= sweeps_in_flight; ++sweeps) {
      Line line(positions);
      line.run(sweeps, Trapezoid{0, positions, true, true});
      EXPECT_TRUE(line == swept(positions, sweeps)) << positions << " positions, " << sweeps << " sweeps";
    }
}

// The model must be able to tell orders apart, or the tests here could not fail.
TEST(Wavefront, TheModelSeesAWrongOrder) {
  for (std::int64_t positions = 2; positions <= 40; ++positions) {
    Line early(positions);
    for (std::int64_t q = 0; q < positions; ++q) {
      early.within(q);
      early.across(q);  // before the next position has been visited
    }
    EXPECT_FALSE(early == swept(positions, 1)) << positions << " positions";
  }
}

TEST(Wavefront, CutBetweenThreadsEqualsPlainSweepsInAnyOrderOfParts) {
  Random random(7);
  for (int i = 0; i < test::scaled(2000); ++i) {
    const unsigned parts = 1 + below(random, 6);
    const std::int64_t positions = 4 * parts + below(random, 60);
    const std::int64_t most = std::min(sweeps_in_flight, sweeps_between_barriers(positions, parts));
    ASSERT_GE(most, 1);
    const std::int64_t sweeps = 1 + below(random, static_cast<std::uint32_t>(most));
    std::vector<unsigned> order;
    for (unsigned part = 0; part < parts; ++part) order.push_back(part);

    Line line(positions);
    for (int round = 0; round < 2; ++round) {
      test::shuffle(order, random);
      for (const unsigned part : order) line.run(sweeps, trapezoid(positions, part, parts));
      test::shuffle(order, random);
      for (const unsigned part : order)
        if (part > 0) line.run(sweeps, CutTriangle{cut(positions, part, parts)});
    }
    EXPECT_TRUE(line == swept(positions, 2 * sweeps))
        << positions << " positions, " << sweeps << " sweeps, " << parts << " parts";
  }
}

// The same with real threads, for the thread sanitizer: parts share no number.
TEST(Wavefront, PartsRunSideBySide) {
  Random random(11);
  for (int i = 0; i < test::scaled(200); ++i) {
    const unsigned parts = 2 + below(random, 3);
    const std::int64_t positions = 4 * parts + below(random, 40);
    const std::int64_t sweeps = std::min(sweeps_in_flight, sweeps_between_barriers(positions, parts));
    Line line(positions);
    std::vector<std::thread> threads;
    for (unsigned part = 0; part < parts; ++part)
      threads.emplace_back([&, part] { line.run(sweeps, trapezoid(positions, part, parts)); });
    for (std::thread& thread : threads) thread.join();
    threads.clear();
    for (unsigned part = 1; part < parts; ++part)
      threads.emplace_back([&, part] { line.run(sweeps, CutTriangle{cut(positions, part, parts)}); });
    for (std::thread& thread : threads) thread.join();
    EXPECT_TRUE(line == swept(positions, sweeps)) << positions << " positions, " << parts << " parts";
  }
}

}  // namespace
}  // namespace plumb::detail::PLUMB_TEST_FILE
