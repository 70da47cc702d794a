#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "plumb/scene.hpp"

namespace plumb::detail {

/// This is a weighted sum of particles, which have their island's numbers.
struct Combination {
  struct Term {
    std::uint32_t particle = 0;
    double weight = 0;
  };
  std::array<Term, 8> terms{};
  std::uint32_t count = 0;

  void add(std::uint32_t particle, double weight);
  Vec3 of(std::span<const Vec3> values) const {
    Vec3 sum{};
    for (std::uint32_t i = 0; i < count; ++i) sum += terms[i].weight * values[terms[i].particle];
    return sum;
  }
};

/// Returns the sum that a place is, and that of the way from one place to another.
Combination combination(const Point& point);
Combination difference(const Point& to, const Point& from);

}  // namespace plumb::detail
