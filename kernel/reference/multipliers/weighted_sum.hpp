#pragma once

#include <cstdint>
#include <span>
#include <utility>

#include "plumb/layouts/memory.hpp"
#include "plumb/scene.hpp"

namespace plumb::detail {

/// This is a weighted sum of an island's particles: a place, or the way from one to another.
struct WeightedSum {
  Array<std::pair<std::uint32_t, double>> terms;

  void add(const Point& point, double by) {
    for (std::size_t i = 0; i < 4; ++i) add(point.particles[i], by * point.weights[i]);
  }
  void add(std::uint32_t particle, double weight) {
    if (weight == 0) return;
    for (auto& [known, sum] : terms)
      if (known == particle) {
        sum += weight;
        return;
      }
    terms.emplace_back(particle, weight);
  }
  Vec3 of(std::span<const Vec3> values) const {
    Vec3 sum{};
    for (const auto& [particle, weight] : terms) sum += weight * values[particle];
    return sum;
  }
};

inline WeightedSum way(const Point& from, const Point& to) {
  WeightedSum out;
  out.add(to, 1);
  out.add(from, -1);
  return out;
}
inline WeightedSum way(const Direction& direction) {
  return way(direction.from, direction.to);
}

}  // namespace plumb::detail
