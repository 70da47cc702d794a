#include "direct/nets/rod_lines.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace plumb::detail {
namespace {

/// A pivot of a line below this share of what both ends could yield is taken for 1. A line drawn straight
/// between fixed particles has such. Only the preconditioner sees it, which need not be exact.
constexpr double least_pivot = 1e-6;

/// A hub of more rods has no way straight on, and all their pairs are many.
constexpr std::size_t most_at_joint = 64;

/// Joins rods at every node, straightest pairs first, and walks the paths that result.
class Paths {
 public:
  Paths(std::span<const LoopRod> rods, std::uint32_t nodes, std::span<const Vec3> positions)
      : rods_(rods), next_(rods.size(), {RodLines::none, RodLines::none}) {
    Array<Array<std::uint32_t>> at(nodes);
    for (std::uint32_t k = 0; k < rods.size(); ++k)
      for (const std::uint32_t end : {rods[k].a, rods[k].b})
        if (end < nodes) at[end].push_back(k);
    for (std::uint32_t i = 0; i < nodes; ++i) join(i, at[i], positions);
  }

  Array<Line> walk() const {
    Array<std::uint8_t> seen(rods_.size(), 0);
    Array<Line> paths;
    const auto follow = [&](std::uint32_t from) {
      Line path;
      for (std::uint32_t k = from, last = RodLines::none; k != RodLines::none && seen[k] == 0;) {
        seen[k] = 1;
        path.push_back(k);
        const auto& next = next_[k];
        const std::uint32_t on = next[0] != last && next[0] != RodLines::none ? next[0] : next[1];
        last = std::exchange(k, on != last ? on : RodLines::none);
      }
      paths.push_back(std::move(path));
    };
    const auto is_end = [&](std::uint32_t k) {
      return next_[k][0] == RodLines::none || next_[k][1] == RodLines::none;
    };
    for (std::uint32_t k = 0; k < rods_.size(); ++k)
      if (seen[k] == 0 && is_end(k)) follow(k);
    for (std::uint32_t k = 0; k < rods_.size(); ++k)  // what is left are rings
      if (seen[k] == 0) follow(k);
    return paths;
  }

 private:
  void join(std::uint32_t node, std::span<const std::uint32_t> at, std::span<const Vec3> positions) {
    const auto outward = [&](std::uint32_t k) {
      const Vec3 d = positions[rods_[k].a == node ? rods_[k].b : rods_[k].a] - positions[node];
      return (1 / norm(d)) * d;
    };
    struct Pair {
      double cosine;
      std::uint32_t one, other;
    };
    Array<Pair> pairs;
    if (at.size() > most_at_joint) return;
    for (std::size_t i = 0; i < at.size(); ++i)
      for (std::size_t j = i + 1; j < at.size(); ++j)
        if (const double cosine = dot(outward(at[i]), outward(at[j])); cosine < 0)
          pairs.push_back({cosine, at[i], at[j]});
    std::stable_sort(pairs.begin(), pairs.end(),
                     [](const Pair& a, const Pair& b) { return a.cosine < b.cosine; });
    const auto free = [&](std::uint32_t k) -> std::uint32_t& { return next_[k][rods_[k].a == node ? 0 : 1]; };
    for (const auto& [cosine, one, other] : pairs) {
      if (free(one) != RodLines::none || free(other) != RodLines::none) continue;
      free(one) = other;
      free(other) = one;
    }
  }

  std::span<const LoopRod> rods_;
  Array<std::array<std::uint32_t, 2>> next_;  ///< It is by rod, at its ends a and b.
};

using Lanes = std::array<double, RodLines::lanes>;

double sum_of(const Lanes& lanes) {
  double sum = 0;
  for (const double each : lanes) sum += each;
  return sum;
}

}  // namespace

Array<Line> find_lines(std::span<const LoopRod> rods, std::uint32_t nodes, std::span<const Vec3> positions) {
  Array<Line> lines = Paths(rods, nodes, positions).walk();
  std::stable_sort(lines.begin(), lines.end(),
                   [](const Line& a, const Line& b) { return a.size() > b.size(); });
  return lines;
}

RodLines::RodLines(std::span<const Line> of, std::span<const LoopRod> rods, std::uint32_t movable)
    : nodes(movable), packs{0}, first{0} {
  for (std::size_t p = 0; p < of.size(); p += lanes) {
    for (std::size_t j = 0; j < of[p].size(); ++j)
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        const bool empty = p + lane >= of.size() || j >= of[p + lane].size();
        const std::uint32_t k = empty ? none : of[p + lane][j];
        numbers.push_back(k);
        ends.push_back(empty ? LoopRod{0, 0} : rods[k]);
        joints.push_back(0);
        turns.push_back(0);
        if (empty || j == 0) continue;
        const auto [a, b] = rods[of[p + lane][j - 1]];
        const bool by_a = rods[k].a == a || rods[k].a == b;
        // Of two rods between the same nodes both would be right. They are refused long before.
        joints.back() = by_a ? rods[k].a : rods[k].b;
        turns.back() = joints.back() == (by_a ? a : b) ? 1 : -1;
      }
    packs.push_back(slots());
  }
  Array<Array<Meeting>> at(nodes);
  for (std::uint32_t s = 0; s < slots(); ++s) {
    if (numbers[s] == none) continue;
    at[ends[s].a].push_back({s, 1});
    if (ends[s].b < nodes) at[ends[s].b].push_back({s, -1});
  }
  for (const auto& each : at) {
    meetings.insert(meetings.end(), each.begin(), each.end());
    first.push_back(static_cast<std::uint32_t>(meetings.size()));
  }
}

Array<std::uint32_t> RodLines::node_order() const {
  Array<std::uint32_t> order;
  Array<std::uint8_t> seen(nodes, 0);
  const auto meet = [&](std::uint32_t vertex) {
    if (vertex < nodes && std::exchange(seen[vertex], std::uint8_t{1}) == 0) order.push_back(vertex);
  };
  for (std::uint32_t s = 0; s < slots(); s += lanes) {
    for (std::uint32_t lane = 0; lane < lanes; ++lane)
      if (turns[s + lane] != 0) meet(joints[s + lane]);
    for (std::uint32_t lane = 0; lane < lanes; ++lane) {
      if (numbers[s + lane] == none) continue;
      meet(ends[s + lane].a);
      meet(ends[s + lane].b);
    }
  }
  return order;
}

LineSolver::LineSolver(const RodLines& lines, std::span<const double> mass)
    : lines_(&lines),
      directions_(3 * std::size_t{lines.slots()}),
      pivots_(lines.slots()),
      links_(lines.slots()),
      near_(lines.slots()),
      along_(lines.slots()),
      image_(lines.slots()) {
  std::uint32_t vertices = lines.nodes;
  for (const LoopRod rod : lines.ends) vertices = std::max({vertices, rod.a + 1, rod.b + 1});
  inverse_.assign(vertices, 0);
  motion_.assign(3 * std::size_t{vertices}, 0);
  give_.resize(lines.slots());
  share_.resize(lines.slots());
  set_masses(mass, [](std::uint32_t) { return false; });
}

void LineSolver::set_masses(std::span<const double> mass,
                            const std::function<bool(std::uint32_t)>& is_node_held) {
  for (std::uint32_t i = 0; i < lines_->nodes; ++i) inverse_[i] = is_node_held(i) ? 0 : 1 / mass[i];
  for (std::uint32_t s = 0; s < lines_->slots(); ++s) {
    const bool empty = lines_->numbers[s] == RodLines::none;
    give_[s] = empty ? 0 : inverse_[lines_->ends[s].a] + inverse_[lines_->ends[s].b];
    share_[s] = lines_->turns[s] * inverse_[lines_->joints[s]];
  }
}

void LineSolver::factorize() {
  constexpr std::uint32_t lanes = RodLines::lanes;
  const double* const d = directions_.data();
  for (std::size_t p = 0; p + 1 < lines_->packs.size(); ++p)
    for (std::uint32_t s = lines_->packs[p]; s < lines_->packs[p + 1]; ++s) {
      const double own =
          give_[s] * ((d[3 * s] * d[3 * s] + d[3 * s + 1] * d[3 * s + 1]) + d[3 * s + 2] * d[3 * s + 2]);
      double pivot = own;
      links_[s] = 0;
      if (share_[s] != 0) {
        const std::uint32_t t = s - lanes;
        const double off =
            share_[s] * ((d[3 * s] * d[3 * t] + d[3 * s + 1] * d[3 * t + 1]) + d[3 * s + 2] * d[3 * t + 2]);
        links_[s] = off * pivots_[t];
        pivot -= off * links_[s];
      }
      pivots_[s] = own > 0 ? 1 / std::max(pivot, least_pivot * own) : 0;
    }
}

void LineSolver::spread(std::span<const double> m, std::span<double> motion) const {
  for (std::uint32_t i = 0; i < lines_->nodes; ++i) {
    double x = 0, y = 0, z = 0;
    for (std::uint32_t k = lines_->first[i]; k < lines_->first[i + 1]; ++k) {
      const auto [slot, sign] = lines_->meetings[k];
      const double by = sign * m[slot];
      const double* const d = &directions_[3 * std::size_t{slot}];
      x += by * d[0];
      y += by * d[1];
      z += by * d[2];
    }
    double* const at = &motion[3 * std::size_t{i}];
    at[0] = inverse_[i] * x;
    at[1] = inverse_[i] * y;
    at[2] = inverse_[i] * z;
  }
}

/// Sets near_ to the inverse of the lines' part of A times the residual. Returns the inner product of both.
double LineSolver::precondition(std::span<const double> residual) {
  constexpr std::size_t lanes = RodLines::lanes;
  Lanes sum{};
  for (std::size_t p = 0; p + 1 < lines_->packs.size(); ++p) {
    const std::size_t begin = lines_->packs[p], end = lines_->packs[p + 1];
    Lanes last{};
    for (std::size_t s = begin; s < end; s += lanes)
      for (std::size_t lane = 0; lane < lanes; ++lane)
        near_[s + lane] = last[lane] = residual[s + lane] - links_[s + lane] * last[lane];
    last = {};  // the rod after takes this, and a line's first rod takes nothing
    for (std::size_t s = end; s > begin;) {
      s -= lanes;
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        const double own = near_[s + lane] * pivots_[s + lane] - last[lane];
        near_[s + lane] = own;
        last[lane] = links_[s + lane] * own;
        sum[lane] += residual[s + lane] * own;
      }
    }
  }
  return sum_of(sum);
}

/// Sets image_ = A along_, by way of motion_. Returns their inner product.
double LineSolver::multiply() {
  constexpr std::size_t lanes = RodLines::lanes;
  spread(along_, motion_);
  Lanes sum{};
  for (std::size_t s = 0; s < image_.size(); s += lanes)
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const LoopRod rod = lines_->ends[s + lane];
      const double* const a = &motion_[3 * std::size_t{rod.a}];
      const double* const b = &motion_[3 * std::size_t{rod.b}];
      const double* const d = &directions_[3 * (s + lane)];
      image_[s + lane] = (d[0] * (a[0] - b[0]) + d[1] * (a[1] - b[1])) + d[2] * (a[2] - b[2]);
      sum[lane] += along_[s + lane] * image_[s + lane];
    }
  return sum_of(sum);
}

bool LineSolver::solve(std::span<double> b, double goal, int most, std::span<double> m,
                       std::span<double> motion) {
  constexpr std::size_t lanes = RodLines::lanes;
  Lanes sum{};
  for (std::size_t s = 0; s < b.size(); s += lanes)
    for (std::size_t lane = 0; lane < lanes; ++lane) sum[lane] += b[s + lane] * b[s + lane];
  double height = 0;
  for (int i = 0; !(sum_of(sum) <= goal * goal); ++i) {
    if (i == most || !std::isfinite(sum_of(sum))) return false;
    const double last = std::exchange(height, precondition(b));
    const double beta = i > 0 ? height / last : 0;
    for (std::size_t s = 0; s < along_.size(); ++s)
      along_[s] = i > 0 ? near_[s] + beta * along_[s] : near_[s];
    const double step = height / multiply();
    if (!std::isfinite(step)) return false;  // rods can do nothing about what is left
    sum = {};
    for (std::size_t s = 0; s < along_.size(); s += lanes)
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        m[s + lane] += step * along_[s + lane];
        const double rest = b[s + lane] - step * image_[s + lane];
        b[s + lane] = rest;
        sum[lane] += rest * rest;
      }
    for (std::size_t k = 0; k < 3 * std::size_t{lines_->nodes}; ++k) motion[k] += step * motion_[k];
  }
  return true;
}

}  // namespace plumb::detail
