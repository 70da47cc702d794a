#pragma once

#include <algorithm>
#include <cmath>

#include "direct/loops/loop_state.hpp"
#include "direct/loops/loop_vectors.hpp"

namespace plumb::detail {

/// The line from a drum to the first free particle carries a particle at `share` of its way, which changes at
/// `share_rate` (1/s).
struct ReelLine {
  double share, share_rate;
  Vec3 way;  ///< in m
};

/// Reads one reel of an island.
class ReelView {
 public:
  ReelView(const LoopState& island, std::size_t i)
      : state(island),
        shape(island.topology->reels[i]),
        numbers(island.reel_numbers[i]),
        motion(island.reels[i]) {}

  std::uint32_t drum() const { return shape.vertices.front(); }
  std::uint32_t last() const { return static_cast<std::uint32_t>(shape.vertices.size()) - 1; }
  /// These are the first free particle, and the one before it, which may be carried.
  std::uint32_t free() const { return shape.vertices[motion.first]; }
  std::uint32_t carried() const { return shape.vertices[motion.first - 1]; }
  bool may_carry() const { return motion.first > 1; }
  /// This is the rod that leaves the drum, the length (m) that it was made with, and its own law.
  std::uint32_t rod() const { return shape.rods[motion.first - 1]; }
  double made_length() const { return numbers.length[motion.first - 1]; }
  double length() const { return state.laws.length[rod()]; }

  double corner(double turned) const {
    if (turned >= motion.span) return 0;
    const double share = turned / motion.span, rest = 1 - share;
    return rest * rest * ((1 + 2 * share) * motion.corner + turned * motion.corner_slope);
  }
  double corner_slope(double turned) const {
    if (turned >= motion.span) return 0;
    const double share = turned / motion.span, rest = 1 - share;
    return rest * ((1 - 3 * share) * motion.corner_slope - 6 * share * motion.corner / motion.span);
  }
  /// Returns how long the rod will be in a time (s). Half of what is out is the least, where the end of a
  /// chain comes in round a corner.
  double length_after(double time) const {
    const double whole = motion.out + time * motion.rate - numbers.behind[motion.first];
    return std::max(whole - corner(motion.turned + time * std::abs(motion.rate)), whole / 2);
  }
  double length_rate(double time) const {
    const double speed = std::abs(motion.rate);
    return motion.rate - corner_slope(motion.turned + time * speed) * speed;
  }

  /// Returns the line at a length (m) of the rod and its rate (m/s).
  ReelLine line(double length, double rate) const {
    const double made = made_length();
    const Vec3 way = state.position(free()) - state.position(drum()) + motion.aside;
    if (!may_carry() || length <= made) return {0, 0, way};
    return {(length - made) / length, rate * made / (length * length), way};
  }
  ReelLine line() const { return line(length(), state.laws.rate[rod()]); }

  Vec3 drum_velocity() const { return state.fixed_velocity[drum() - state.topology->nodes]; }
  /// Returns the velocity of a node as the last substep left it.
  Vec3 velocity(std::uint32_t node) const {
    return state.u_step != 0 ? 1 / state.u_step * at(state.u, node) : at(state.u, node);
  }
  Vec3 place_on(const ReelLine& line) const { return state.position(drum()) + line.share * line.way; }
  /// Returns the velocity of a particle on the line, for those of the drum and of the free particle.
  static Vec3 velocity_on(const ReelLine& line, Vec3 drum, Vec3 free) {
    return (1 - line.share) * drum + line.share * free + line.share_rate * line.way;
  }

  /// Returns what the carried particle adds to the mass of its neighbour.
  double added_mass() const {
    if (!may_carry()) return 0;
    const double share = line().share;
    return share * share * numbers.mass[motion.first - 1];
  }
  /// Returns the momentum of what is wound or carried, in kg m/s.
  Vec3 momentum() const {
    const Vec3 still = drum_velocity();
    Vec3 sum{};
    for (std::uint32_t j = 1; j < motion.first; ++j) sum += numbers.mass[j] * still;
    if (may_carry())
      sum += numbers.mass[motion.first - 1] * (velocity_on(line(), still, velocity(free())) - still);
    return state.mass_unit * sum;
  }

  const LoopState& state;
  const LoopReel& shape;
  const LoopReelNumbers& numbers;
  const LoopReelMotion& motion;
};

/// Gives the rod that leaves the drum its length now, its rate and its law.
void set_leaving_rod(LoopState& state, const ReelView& reel);
/// Lets masses of carried particles act on their neighbours.
void weigh_carried(LoopState& state);

}  // namespace plumb::detail
