#include "direct/locks/locks.hpp"

#include <algorithm>
#include <cmath>

#include "direct/loops/loop_state.hpp"
#include "direct/loops/loop_vectors.hpp"

namespace plumb::detail {
namespace {

/// Rods of a straight line turn by no angle of a lesser cosine.
constexpr double straight = 0.9999;

/// A rod between locked nodes that is off its length by more than this share is no matter of rounding.
constexpr double most_off = 1e-6;

/// Velocities that differ by this share are the same but for the rounding of places.
constexpr double same_velocity = 1e-10;

/// Walks along lines from what is held to what is held.
class Walk {
 public:
  explicit Walk(const LoopState& state)
      : state_(state), shape_(*state.topology), first_(shape_.vertices + 1) {
    for (std::uint32_t i = 0; i < shape_.vertices; ++i) places_.push_back(state.position(i));
    for (const auto [a, b] : shape_.rods) {
      ++first_[a + 1];
      ++first_[b + 1];
    }
    for (std::uint32_t i = 0; i < shape_.vertices; ++i) first_[i + 1] += first_[i];
    rods_.resize(first_.back());
    Array<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (std::uint32_t k = 0; k < shape_.rods.size(); ++k)
      for (const std::uint32_t end : {shape_.rods[k].a, shape_.rods[k].b}) rods_[next[end]++] = k;
  }

  Locks run() {
    locks_.anchors.assign(shape_.nodes, Locks::none);
    Array<std::uint32_t> held;
    for (std::uint32_t i = shape_.nodes; i < shape_.vertices; ++i) held.push_back(i);
    for (std::size_t i = 0; i < held.size(); ++i)  // what gets locked holds others
      for (std::uint32_t at = first_[held[i]]; at < first_[held[i] + 1]; ++at)
        if (follow(held[i], rods_[at])) held.insert(held.end(), path_.begin(), path_.end());
    return locks_.ends.empty() || any_contradicts() ? Locks{} : std::move(locks_);
  }

 private:
  std::uint32_t anchor_of(std::uint32_t vertex) const {
    return vertex < shape_.nodes ? locks_.anchors[vertex] : vertex;
  }

  std::uint32_t other_end(std::uint32_t rod, std::uint32_t vertex) const {
    return shape_.rods[rod].a == vertex ? shape_.rods[rod].b : shape_.rods[rod].a;
  }

  /// Says whether a rod is rigid, and as long as its ends are apart in all of the step.
  bool fits(std::uint32_t rod) const {
    if (state_.laws.any() && (!state_.laws.is_rigid(rod) || state_.laws.rate[rod] != 0)) return false;
    const auto [a, b] = shape_.rods[rod];
    const Vec3 d = places_[a] - places_[b];
    return std::abs(dot(d, d) / state_.length2[rod] - 1) <= 2 * (state_.gave ? most_given : most_slack);
  }

  /// Returns whether a rod between locked nodes is, or is to be, of another length than they leave it.
  bool any_contradicts() const {
    for (std::uint32_t k = 0; k < shape_.rods.size(); ++k) {
      const auto [a, b] = shape_.rods[k];
      const bool is_held = anchor_of(a) != Locks::none && anchor_of(b) != Locks::none;
      if (!is_held || (state_.laws.any() && !state_.laws.is_rigid(k))) continue;
      const double strain = norm(places_[a] - places_[b]) / std::sqrt(state_.length2[k]) - 1;
      if (state_.laws.any() && state_.laws.is_one_sided(k) && strain < -most_off) continue;  // slack
      if (std::abs(strain) > most_off || (state_.laws.any() && state_.laws.rate[k] != 0)) return true;
    }
    return false;
  }

  /// Returns the rod that runs on from `rod` beyond `vertex`, or none.
  std::uint32_t straight_on(std::uint32_t rod, std::uint32_t vertex) const {
    const Vec3 here = places_[vertex], came = here - places_[other_end(rod, vertex)];
    double best = straight;
    std::uint32_t out = Locks::none;
    for (std::uint32_t at = first_[vertex]; at < first_[vertex + 1]; ++at) {
      const Vec3 on = places_[other_end(rods_[at], vertex)] - here;
      const double cosine = dot(came, on) / (norm(came) * norm(on));
      if (rods_[at] == rod || !(cosine > best)) continue;
      best = cosine;
      out = rods_[at];
    }
    return out;
  }

  /// Follows the line that begins at `from` with `rod`. If it is taut up to something held, path_ has its
  /// nodes, which are locked then.
  bool follow(std::uint32_t from, std::uint32_t rod) {
    path_.clear();
    path_rods_.clear();
    double length = 0;
    std::uint32_t vertex = from;
    for (; rod != Locks::none && fits(rod); rod = straight_on(rod, vertex)) {
      length += std::sqrt(state_.length2[rod]);
      vertex = other_end(rod, vertex);
      if (anchor_of(vertex) == Locks::none) {
        path_.push_back(vertex);
        path_rods_.push_back(rod);
        continue;
      }
      const double distance = norm(places_[vertex] - places_[from]);
      if (path_.empty() || !is_taut(length, distance) || distance > (1 + most_slack) * length) return false;
      for (const std::uint32_t node : path_) locks_.anchors[node] = anchor_of(from);
      if (state_.gave) straighten(from, vertex, length);
      locks_.ends.emplace_back(anchor_of(from), anchor_of(vertex));
      return true;
    }
    return false;
  }

  /// Says where the nodes of path_ are if its rods lie in a straight line of `length` (m).
  void straighten(std::uint32_t from, std::uint32_t to, double length) {
    const Vec3 start = places_[from], way = places_[to] - start;
    double done = 0;
    for (std::size_t k = 0; k < path_.size(); ++k) {
      done += std::sqrt(state_.length2[path_rods_[k]]);
      places_[path_[k]] = start + (done / length) * way;
      locks_.places.emplace_back(path_[k], places_[path_[k]]);
    }
  }

  const LoopState& state_;
  const LoopTopology& shape_;
  Array<std::uint32_t> first_, rods_;      ///< Rods of a vertex begin at first_.
  Array<Vec3> places_;                     ///< of vertices, m
  Array<std::uint32_t> path_, path_rods_;  ///< nodes of a line, and the rods before them
  Locks locks_;
};

}  // namespace

Locks find_locks(const LoopState& state) {
  const LoopTopology& shape = *state.topology;
  // A line needs two anchors, and most islands with loops have fewer.
  return shape.vertices < shape.nodes + 2 ? Locks{} : Walk(state).run();
}

bool locks_hold(const LoopState& state) {
  const auto velocity = [&](std::uint32_t anchor) {
    return state.fixed_velocity[anchor - state.topology->nodes];
  };
  return std::all_of(state.locks.ends.begin(), state.locks.ends.end(), [&](auto line) {
    const Vec3 one = velocity(line.first), other = velocity(line.second);
    return norm(one - other) <= same_velocity * norm(one);
  });
}

bool lies_between_held(const LoopState& state, std::uint32_t rod) {
  const auto [a, b] = state.topology->rods[rod];
  const auto is_held = [&](std::uint32_t vertex) {
    return vertex >= state.topology->nodes || state.locks.has(vertex);
  };
  return is_held(a) && is_held(b);
}

Vec3 locked_velocity(const LoopState& state, std::uint32_t node) {
  return state.fixed_velocity[state.locks.anchors[node] - state.topology->nodes];
}

void move_locked(const LoopState& state, double time, std::span<double> displacements) {
  for (std::uint32_t i = 0; i < state.locks.anchors.size(); ++i)
    if (state.locks.has(i)) put(&displacements[3 * std::size_t{i}], time * locked_velocity(state, i));
}

}  // namespace plumb::detail
