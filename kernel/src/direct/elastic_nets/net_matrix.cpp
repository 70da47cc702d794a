#include "direct/elastic_nets/net_matrix.hpp"

#include <algorithm>
#include <cmath>

namespace plumb::detail {
namespace {

using Tile = std::array<double, 6>;

Vec3 times(const Tile& t, Vec3 v) {
  return {t[0] * v.x + t[1] * v.y + t[2] * v.z, t[1] * v.x + t[3] * v.y + t[4] * v.z,
          t[2] * v.x + t[4] * v.y + t[5] * v.z};
}
Vec3 times(const NetMatrix::RodPart& rod, Vec3 v) {
  return rod.along * dot(rod.f, v) * rod.f + rod.across * v;
}

Tile tile_of(const NetMatrix::RodPart& rod) {
  const auto [x, y, z] = rod.f;
  const double w = rod.along, p = rod.across;
  return {w * x * x + p, w * x * y, w * x * z, w * y * y + p, w * y * z, w * z * z + p};
}
void add(Tile& to, double factor, const Tile& tile) {
  for (std::size_t i = 0; i < 6; ++i) to[i] += factor * tile[i];
}

Tile inverse_of(const Tile& t) {
  const double a = t[3] * t[5] - t[4] * t[4], b = t[2] * t[4] - t[1] * t[5], c = t[1] * t[4] - t[2] * t[3];
  const double over = 1 / (t[0] * a + (t[1] * b + t[2] * c));
  return {over * a,
          over * b,
          over * c,
          over * (t[0] * t[5] - t[2] * t[2]),
          over * (t[1] * t[2] - t[0] * t[4]),
          over * (t[0] * t[3] - t[1] * t[1])};
}

/// Returns S t S of a rod's tile S, and a symmetric t.
Tile sandwich(const NetMatrix::RodPart& rod, const Tile& t) {
  const Vec3 f = rod.f, g = times(t, f);
  const double w = rod.along, p = rod.across, own = w * w * dot(f, g), cross = w * p;
  Tile out{
      own * f.x * f.x + 2 * cross * f.x * g.x,           own * f.x * f.y + cross * (f.x * g.y + f.y * g.x),
      own * f.x * f.z + cross * (f.x * g.z + f.z * g.x), own * f.y * f.y + 2 * cross * f.y * g.y,
      own * f.y * f.z + cross * (f.y * g.z + f.z * g.y), own * f.z * f.z + 2 * cross * f.z * g.z};
  add(out, p * p, t);
  return out;
}

double dot_of(std::span<const Vec3> a, std::span<const Vec3> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += dot(a[i], b[i]);
  return sum;
}

}  // namespace

Array<std::uint32_t> order_by_levels(std::span<const LoopRod> rods, std::uint32_t nodes) {
  Array<Array<std::uint32_t>> neighbours(nodes);
  for (const auto [a, b] : rods)
    if (b < nodes) {
      neighbours[a].push_back(b);
      neighbours[b].push_back(a);
    }
  Array<std::uint32_t> order;
  std::uint32_t start = 0;
  for (int pass = 0; pass < 2; ++pass) {  // the second pass starts where the first ended, at one end
    Array<std::uint8_t> seen(nodes, 0);
    order.clear();
    for (std::uint32_t i = 0; i < nodes; ++i) {
      const std::uint32_t root = i == 0 ? start : i;
      if (seen[root] != 0) continue;
      std::size_t done = order.size();
      order.push_back(root);
      seen[root] = 1;
      for (; done < order.size(); ++done)
        for (const std::uint32_t next : neighbours[order[done]]) {
          if (seen[next] != 0) continue;
          seen[next] = 1;
          order.push_back(next);
        }
    }
    start = order.back();
  }
  return order;
}

NetPattern::NetPattern(std::span<const LoopRod> of, std::uint32_t count)
    : nodes(count), rods(of.begin(), of.end()), first(count + std::size_t{1}, 0) {
  for (std::uint32_t k = 0; k < rods.size(); ++k)
    if (rods[k].b < nodes)
      number.push_back(k);
    else
      tied.push_back(k);
  const auto ends = [&](std::uint32_t k) { return std::minmax(rods[k].a, rods[k].b); };
  std::sort(number.begin(), number.end(), [&](std::uint32_t a, std::uint32_t b) {
    const auto [low_a, high_a] = ends(a);
    const auto [low_b, high_b] = ends(b);
    return high_a != high_b ? high_a < high_b : low_a < low_b;
  });
  for (const std::uint32_t k : number) {
    before.push_back(ends(k).first);
    ++first[ends(k).second + std::size_t{1}];
  }
  for (std::uint32_t i = 0; i < nodes; ++i) first[i + 1] += first[i];
}

NetMatrix::NetMatrix(const NetPattern& pattern)
    : pattern_(&pattern),
      parts_(pattern.number.size()),
      pivot_(pattern.nodes),
      inverse_(pattern.nodes),
      beyond_(pattern.nodes),
      rest_(pattern.nodes),
      near_(pattern.nodes),
      along_(pattern.nodes),
      image_(pattern.nodes) {}

void NetMatrix::set(std::span<const double> mass, std::span<const RodPart> rods) {
  const NetPattern& shape = *pattern_;
  for (std::uint32_t i = 0; i < shape.nodes; ++i) {
    pivot_[i] = {mass[i], 0, 0, mass[i], 0, mass[i]};
    beyond_[i] = pivot_[i];
  }
  const auto add_diagonal = [&](std::uint32_t node, const RodPart& rod) {
    add(beyond_[node], 1, tile_of(rod));
    // The factors exist if nothing pushes, so they leave pushes out.
    add(pivot_[node], 1, tile_of({rod.f, rod.along, std::max(rod.across, 0.0)}));
  };
  for (std::size_t s = 0; s < parts_.size(); ++s) {
    const std::uint32_t k = shape.number[s];
    parts_[s] = rods[k];
    add_diagonal(shape.rods[k].a, rods[k]);
    add_diagonal(shape.rods[k].b, rods[k]);
  }
  for (const std::uint32_t k : shape.tied) add_diagonal(shape.rods[k].a, rods[k]);
  factorize();
}

void NetMatrix::factorize() {
  const NetPattern& shape = *pattern_;
  for (std::uint32_t i = 0; i < shape.nodes; ++i) {
    for (std::uint32_t s = shape.first[i]; s < shape.first[i + 1]; ++s) {
      RodPart rod = parts_[s];
      rod.across = std::max(rod.across, 0.0);
      add(pivot_[i], -1, sandwich(rod, inverse_[shape.before[s]]));
    }
    inverse_[i] = inverse_of(pivot_[i]);
    add(beyond_[i], -2, pivot_[i]);
  }
}

void NetMatrix::forward(std::span<Vec3> v) const {
  const NetPattern& shape = *pattern_;
  for (std::uint32_t i = 0; i < shape.nodes; ++i) {
    Vec3 sum = v[i];
    for (std::uint32_t s = shape.first[i]; s < shape.first[i + 1]; ++s)
      sum += times(parts_[s], v[shape.before[s]]);
    v[i] = times(inverse_[i], sum);
  }
}

void NetMatrix::backward(std::span<Vec3> v) const {
  const NetPattern& shape = *pattern_;
  for (std::uint32_t i = shape.nodes; i-- > 0;) {
    v[i] = times(inverse_[i], v[i]);
    for (std::uint32_t s = shape.first[i]; s < shape.first[i + 1]; ++s)
      v[shape.before[s]] += times(parts_[s], v[i]);
  }
}

auto NetMatrix::solve(std::span<const Vec3> b, double goal, int most, std::span<Vec3> x) -> Outcome {
  const std::uint32_t n = pattern_->nodes;
  std::copy(b.begin(), b.end(), rest_.begin());
  std::fill(x.begin(), x.end(), Vec3{});
  forward(rest_);
  double height = 0, least = 0;
  for (int i = 0;; ++i) {
    for (std::uint32_t k = 0; k < n; ++k) near_[k] = times(pivot_[k], rest_[k]);
    const double last = height;
    height = dot_of(rest_, near_);
    if (i == 0) least = goal * goal * height;
    if (!(height > least)) return std::isfinite(height) ? Outcome::solved : Outcome::stalled;
    if (i == most) return Outcome::stalled;
    const double beta = i > 0 ? height / last : 0;
    for (std::uint32_t k = 0; k < n; ++k) near_[k] = along_[k] = near_[k] + beta * along_[k];
    backward(near_);  // the direction itself
    for (std::uint32_t k = 0; k < n; ++k) image_[k] = along_[k] + times(beyond_[k], near_[k]);
    forward(image_);
    for (std::uint32_t k = 0; k < n; ++k) image_[k] += near_[k];
    const double bend = dot_of(along_, image_);
    if (!(bend > 0)) return Outcome::indefinite;
    const double step = height / bend;
    for (std::uint32_t k = 0; k < n; ++k) {
      x[k] += step * near_[k];
      rest_[k] = rest_[k] - step * image_[k];
    }
  }
}

}  // namespace plumb::detail
