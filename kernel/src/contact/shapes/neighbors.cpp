#include "contact/shapes/neighbors.hpp"

#include <algorithm>
#include <cmath>
#include <queue>
#include <set>
#include <utility>

namespace plumb::detail {
namespace {

/// Particles and what joins them.
class Graph {
 public:
  explicit Graph(const Scene& part) : rods_(part.particles.size()), pins_(part.particles.size()) {
    for (std::size_t i = 0; i < part.rods.size(); ++i) {
      const std::uint32_t from = part.rods[i].a, to = part.rods[i].b;
      rods_[from].push_back({to, rod_length(part, i)});
      rods_[to].push_back({from, rod_length(part, i)});
    }
    for (const Pin& pin : part.pins)
      for_particles(pin.a, [&](std::uint32_t a) {
        for_particles(pin.b, [&](std::uint32_t b) {
          pins_[a].push_back(b);
          pins_[b].push_back(a);
        });
      });
  }

  /// Calls f(particle) for all particles that have a weight in a place.
  template <class F>
  static void for_particles(const Point& point, F&& f) {
    for (std::size_t i = 0; i < point.particles.size(); ++i)
      if (point.weights[i] != 0) f(point.particles[i]);
  }

  /// Calls f(particle, distance) for all that rods join to a capsule's particles within `most` (m), and for
  /// those that are pinned to them.
  template <class F>
  void for_near(const Capsule& capsule, double most, F&& f) const {
    using Stop = std::pair<double, std::uint32_t>;
    std::priority_queue<Stop, Array<Stop>, std::greater<>> next;
    std::set<std::uint32_t> seen;
    for (const Point* const point : {&capsule.a, &capsule.b})
      for_particles(*point, [&](std::uint32_t i) {
        next.push({0, i});
        for (const std::uint32_t pinned : pins_[i]) f(pinned, 0.0);
      });
    while (!next.empty()) {
      const auto [distance, i] = next.top();
      next.pop();
      if (!seen.insert(i).second) continue;
      f(i, distance);
      for (const auto& [to, length] : rods_[i])
        if (distance + length <= most) next.push({distance + length, to});
    }
  }

 private:
  Array<Array<std::pair<std::uint32_t, double>>> rods_;  ///< of each, the other end and the length
  Array<Array<std::uint32_t>> pins_;
};

}  // namespace

Neighbors::Neighbors(const Scene& part) {
  double widest = 0;
  Array<Array<std::uint32_t>> capsules_at(part.particles.size());
  for (std::uint32_t k = 0; k < part.capsules.size(); ++k) {
    const Capsule& capsule = part.capsules[k];
    if (!capsule.filter.own_island) continue;
    own_.resize(part.capsules.size(), 0);
    own_[k] = 1;
    widest = std::max(widest, capsule.radius);
    for (const Point* const point : {&capsule.a, &capsule.b})
      Graph::for_particles(*point, [&](std::uint32_t i) { capsules_at[i].push_back(k); });
  }
  if (own_.empty()) return;
  const Graph graph(part);
  neighbors_.resize(part.capsules.size());
  for (std::uint32_t k = 0; k < part.capsules.size(); ++k) {
    if (own_[k] == 0) continue;
    std::set<std::uint32_t> near{k};
    const double radius = part.capsules[k].radius;
    graph.for_near(part.capsules[k], radius + widest, [&](std::uint32_t particle, double distance) {
      for (const std::uint32_t other : capsules_at[particle])
        if (distance <= radius + part.capsules[other].radius) near.insert(other);
    });
    neighbors_[k].assign(near.begin(), near.end());
  }
}

bool Neighbors::may_touch(std::uint32_t one, std::uint32_t other) const {
  return !own_.empty() && own_[one] != 0 && own_[other] != 0 &&
         !std::binary_search(neighbors_[one].begin(), neighbors_[one].end(), other);
}

}  // namespace plumb::detail
