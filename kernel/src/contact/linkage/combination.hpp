#pragma once

#include <algorithm>
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

/// This is a place on a shape, which is a sum of no more particles than a body has. Shapes are many, and most
/// of a Combination would be empty there.
struct ShapePlace {
  std::array<Combination::Term, 4> terms{};
  std::uint32_t count = 0;

  ShapePlace() = default;
  ShapePlace(const Combination& of) : count(of.count) {
    std::copy_n(of.terms.begin(), terms.size(), terms.begin());
  }
  operator Combination() const {
    Combination out;
    std::copy(terms.begin(), terms.end(), out.terms.begin());
    out.count = count;
    return out;
  }
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
