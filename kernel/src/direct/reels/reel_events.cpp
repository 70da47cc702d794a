#include <algorithm>
#include <cmath>

#include "direct/loops/loop_stepper.hpp"
#include "direct/reels/loop_reels.hpp"
#include "direct/reels/reel_view.hpp"

namespace plumb::detail {
namespace {

/// What a corner cuts off is wound in while the drum turns by this share of a rod. Where that is much, by so
/// many times itself, so that the rod never grows while the drum winds it in.
constexpr double span_of_rod = 0.5, span_of_corner = 4, steepest = 0.5;
/// A slope beyond the steepest by less is rounding.
constexpr double rounding = 1e-9;
/// Sharper corners leave less than this share of the way to the drum. Then a particle is wound at once.
constexpr double least_way = 0.5;

/// Returns the length (m) of the rod that leaves the drum where its next particle becomes free, if the drum
/// pays out, or carried. There may be none.
struct Threshold {
  bool exists;
  double length;
};
Threshold threshold_of(const ReelView& reel) {
  const std::uint32_t first = reel.motion.first;
  if (reel.motion.rate > 0)
    return {reel.may_carry(), first > 1 ? reel.made_length() + reel.numbers.length[first - 2] / 2 : 0};
  return {reel.motion.rate < 0 && first < reel.last(), reel.made_length() / 2};
}

bool is_past(const ReelView& reel, double length, double threshold) {
  return reel.motion.rate > 0 ? length >= threshold : length <= threshold;
}

/// Returns when the rod has the length (m) of a threshold, which it is past at the time `late` (s).
double time_of(const ReelView& reel, double threshold, double late) {
  if (reel.motion.turned >= reel.motion.span)
    return std::clamp((threshold - reel.length()) / reel.motion.rate, 0.0, late);
  double early = 0;
  for (int i = 0; i < 60; ++i) {
    const double middle = (early + late) / 2;
    (is_past(reel, reel.length_after(middle), threshold) ? late : early) = middle;
  }
  return late;
}

/// Begins with a corner (m) where the rod that leaves the drum grows at `length_rate` (m/s). Returns whether
/// it will grow at another rate.
bool begin_corner(LoopReelMotion& motion, double corner, double length_rate, double made_length) {
  const double slope = (motion.rate - length_rate) / std::abs(motion.rate);
  motion.corner = corner;
  motion.corner_slope = std::clamp(slope, -steepest, steepest);
  motion.turned = 0;
  motion.span = std::max(span_of_rod * made_length, span_of_corner * std::abs(corner));
  return std::abs(slope - motion.corner_slope) > rounding;
}

Vec3 direction(Vec3 way) {
  const double length = norm(way);
  return length > 0 ? 1 / length * way : Vec3{};
}

void set_node(LoopState& state, std::uint32_t node, Vec3 place, Vec3 velocity) {
  put(&state.x[3 * std::size_t{node}], place);
  put(&state.u[3 * std::size_t{node}], state.u_step != 0 ? state.u_step * velocity : velocity);
}

/// Changes the first free particle, and gives rods beside it their laws and lengths. They pull as before.
void set_first(LoopState& state, std::size_t i, std::uint32_t first) {
  const ReelView reel(state, i);
  const bool comes_in = first > reel.motion.first;
  const double pull = state.mu[reel.rod()] * reel.length();
  const double outer =
      comes_in ? state.mu[reel.shape.rods[first - 1]] * reel.numbers.length[first - 1] : pull;
  state.mu[reel.rod()] = comes_in ? 0 : pull / reel.made_length();
  state.reels[i].first = first;
  restore_reels(state);
  state.mu[reel.rod()] = outer / reel.length();
}

/// Lets the carried particle go free. Returns whether velocities do not fit.
bool free_carried(LoopState& state, std::size_t i) {
  const ReelView reel(state, i);
  LoopReelMotion& motion = state.reels[i];
  const ReelLine line = reel.line();
  const Vec3 drum = state.position(reel.drum()), next = state.position(reel.free());
  const Vec3 next_velocity = reel.velocity(reel.free());
  Vec3 place = reel.place_on(line);
  Vec3 velocity = ReelView::velocity_on(line, reel.drum_velocity(), next_velocity);
  const bool is_aside = motion.aside != Vec3{}, is_rigid = reel.numbers.laws[motion.first - 1][2] != 0;
  const std::uint32_t node = reel.carried();
  const double mass = state.mass_unit * reel.numbers.mass[motion.first - 1];
  if (is_aside && is_rigid) {  // beside the straight line, it does not fit the rod to its neighbour
    const Vec3 along = direction(next - place);
    place = next - reel.made_length() * along;
    velocity += dot(along, next_velocity - velocity) * along;
  }
  motion.aside = {};
  motion.momentum = motion.momentum - mass * velocity;
  set_node(state, node, place, velocity);
  bool jolts = false;
  if (is_aside && is_rigid) {
    const Vec3 way = place - drum;
    jolts = begin_corner(motion, motion.out - reel.numbers.behind[motion.first - 1] - norm(way),
                         dot(direction(way), velocity - reel.drum_velocity()),
                         reel.numbers.length[motion.first - 2]);
  }
  set_first(state, i, motion.first - 1);
  return jolts;
}

/// Returns the length (m) at which the rod beyond the first free particle goes on as the rod that leaves the
/// drum, when its end is `distance` (m) from the drum. It is as taut as before: both less the corner.
double joined_length(const ReelView& reel, double distance) {
  const std::uint32_t first = reel.motion.first, outer = reel.shape.rods[first];
  const auto& law = reel.numbers.laws[first];
  const double whole = reel.length() + reel.numbers.length[first];
  if (law[3] != 0 && (reel.state.mu[reel.rod()] >= 0 || reel.state.mu[outer] >= 0))
    return std::max(whole, law[2] != 0 ? distance : 0);  // it is slack
  if (law[2] != 0) return distance;
  const Vec3 place = reel.state.position(reel.free());
  return whole + distance - norm(place - reel.state.position(reel.drum())) -
         norm(reel.state.position(reel.shape.vertices[first + 1]) - place);
}

/// Lets the first free particle be carried. Returns whether velocities do not fit.
bool carry_first(LoopState& state, std::size_t i) {
  const ReelView reel(state, i);
  LoopReelMotion& motion = state.reels[i];
  const std::uint32_t first = motion.first, node = reel.free(), next = reel.shape.vertices[first + 1];
  const Vec3 drum = state.position(reel.drum());
  const Vec3 place = state.position(node) - drum, way = state.position(next) - drum;
  const double made = reel.numbers.length[first], rate = state.laws.rate[reel.rod()];
  const double distance = norm(way), length = joined_length(reel, distance);
  const bool holds = reel.numbers.laws[first][2] != 0 && length == distance;
  const double grows = dot(direction(way), reel.velocity(next) - reel.drum_velocity());
  motion.momentum += state.mass_unit * reel.numbers.mass[first] * reel.velocity(node);
  const bool jolts =
      begin_corner(motion, motion.out - reel.numbers.behind[first + 1] - length, holds ? grows : rate, made);
  const double share = (length - made) / length;
  motion.aside = length - made > least_way * reel.length() ? 1 / share * place - way : Vec3{};
  set_node(state, node, drum, reel.drum_velocity());
  set_first(state, i, first + 1);
  return jolts;
}

}  // namespace

double next_reel_event(const LoopState& state, double h) {
  double next = h;
  for (std::size_t i = 0; i < state.reels.size(); ++i) {
    const ReelView reel(state, i);
    const auto [exists, length] = threshold_of(reel);
    if (exists && is_past(reel, reel.length_after(next), length)) next = time_of(reel, length, next);
  }
  return next;
}

ReelEvents pass_reel_events(LoopState& state, double soon) {
  ReelEvents events;
  for (std::size_t i = 0; i < state.reels.size(); ++i) {
    const ReelView reel(state, i);
    for (;;) {
      const auto [exists, length] = threshold_of(reel);
      if (!exists || !is_past(reel, reel.length_after(soon), length)) break;
      const bool jolts = reel.motion.rate > 0 ? free_carried(state, i) : carry_first(state, i);
      events.jolts = events.jolts || jolts;
      events.any = true;
    }
  }
  if (events.any) state.known = 0;
  return events;
}

}  // namespace plumb::detail
