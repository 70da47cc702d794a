#include "direct/tackles/loop_pulleys.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "math/elementary.hpp"

namespace plumb::detail {
namespace {

/// A cord that sticks creeps by this share of how far what it holds would fall in a substep. So its pulls are
/// known where nothing else says them.
constexpr double creep = 1e-10;
/// Pulls may differ by this share too much, and cords slide by this share of their length the wrong way:
/// rounding.
constexpr double pull_rounding = 1e-12, slide_rounding = 1e-13;
/// A segment that is shorter than this many times what its ends would move by in a substep, if nothing held
/// them, has no direction to speak of. Where a block reaches a pulley there is no friction.
constexpr double least_way = 1.5;
/// Cords that stick and move by more than this share of their length in a substep are stopped.
constexpr double at_rest = 1e-12;

/// Returns the angle between two unit vectors to rounding, also near 0 and pi, or 0 if one is zero.
double angle_between(Vec3 u, Vec3 v) {
  if (u == Vec3{} || v == Vec3{}) return 0;
  const double sum = norm(u + v) / 2, difference = norm(u - v) / 2;
  return sum < difference ? 2 * acos(sum) : std::numbers::pi - 2 * acos(difference);
}

/// Calls f(pulley, segment behind, slid) for the pulleys of a tackle, where part(pull, a, b) says what a
/// segment adds to how far a cord slid.
template <class Part, class F>
void walk_pulleys(const Cords& cords, std::uint32_t t, Part&& part, F&& f) {
  double behind = 0;
  cords.along(t, [&](std::uint32_t s, std::uint32_t a, std::uint32_t b, const Pull& pull) {
    if (s > 0) behind += part(pull, a, b);
  });
  const std::uint32_t first = cords.tackle(t).first_pulley;
  cords.along(t, [&](std::uint32_t s, std::uint32_t a, std::uint32_t b, const Pull& pull) {
    if (s == 0) return;
    f(first + s - 1, s, behind);
    behind -= part(pull, a, b);
  });
}
double growth(const Pull& pull, std::uint32_t, std::uint32_t) {
  return pull.growth;
}

/// Returns how a pulley goes on from how it was, between multipliers of both sides. Those of pulls are
/// negative.
Slide next_slide(const Pulley& pulley, double before, double behind, double slid, double rounding) {
  if (!(before < 0) || pulley.most == 1) return Slide::even;
  const bool goes_on = slid > rounding, goes_back = slid < -rounding;
  switch (pulley.slide) {
    case Slide::even:
      return goes_on ? Slide::on : goes_back ? Slide::back : Slide::sticks;
    case Slide::on:
      return goes_back ? Slide::sticks : Slide::on;
    case Slide::back:
      return goes_on ? Slide::sticks : Slide::back;
    case Slide::sticks:
      break;
  }
  if (behind < (1 + pull_rounding) * pulley.most * before) return Slide::on;
  if (pulley.most * behind > (1 - pull_rounding) * before) return Slide::back;
  return Slide::sticks;
}

/// The row of a pulley is  slid (use) + own (multiplier behind) + before (multiplier before) = 0.
struct PulleyRow {
  double use, own, before;
};
PulleyRow row_of(const Pulley& pulley, SlideOf slide) {
  switch (slide ? pulley.*slide : Slide::even) {
    case Slide::sticks:
      return {1, creep, -creep};
    case Slide::on:
      return {0, 1, -pulley.most};
    case Slide::back:
      return {0, 1, -1 / pulley.most};
    case Slide::even:
      break;
  }
  return {0, 1, -1};
}

std::uint32_t position_of(const Cords& cords, std::uint32_t t, std::uint32_t segment,
                          const LoopState& state) {
  const LoopTopology& shape = *state.topology;
  return shape.system->analysis.position(shape.nodes + cords.multiplier(t, segment));
}

}  // namespace

void start_pulleys(const LoopState& state, LoopWorkspace& work) {
  const std::uint32_t nodes = state.topology->nodes;
  const auto& tackles = state.topology->tackles;
  // Without cords and rods a vertex would go so far.
  const auto fall = [&](std::uint32_t i) {
    return i < nodes ? 1 / state.mass[i] * at(work.load, i) : at(work.delta, i);
  };
  const auto direction = [&](std::uint32_t a, std::uint32_t b) {
    const Vec3 way = state.position(b) - state.position(a) + 0.5 * (at(work.delta, b) - at(work.delta, a));
    return norm(way) > least_way * norm(fall(b) - fall(a)) ? 1 / norm(way) * way : Vec3{};
  };
  for (std::size_t t = 0; t < tackles.size(); ++t)
    for (std::uint32_t p = 0; p < tackles[t].pulleys(); ++p) {
      const auto* const v = tackles[t].vertices.data() + p;
      const double angle = angle_between(direction(v[0], v[1]), direction(v[1], v[2]));
      work.tackles.pulleys[tackles[t].first_pulley + p].most =
          work.tackles.are_smooth ? 1 : exp(state.tackle_laws[t].friction * angle);
    }
}

bool set_slides(const LoopState& state, double theta, LoopWorkspace& work) {
  if (work.tackles.pulleys.empty()) return false;
  const Cords cords(state, work, theta);
  bool switched = false;
  for (std::uint32_t t = 0; t < cords.count(); ++t) {
    if (!cords.tackle(t).rubs) continue;
    const double rounding = slide_rounding * work.tackles.lengths[t];
    walk_pulleys(cords, t, growth, [&](std::uint32_t p, std::uint32_t s, double slid) {
      Pulley& pulley = work.tackles.pulleys[p];
      const double before = state.mu[cords.multiplier(t, s - 1)], behind = state.mu[cords.multiplier(t, s)];
      const Slide next = next_slide(pulley, before, behind, slid, rounding);
      switched = switched || next != pulley.slide;
      pulley.slide = next;
    });
  }
  return switched;
}

void write_pulleys(const Cords& cords, std::uint32_t t, SlideOf slide, const TackleWorkspace& work,
                   double* values) {
  const LoopTackle& tackle = cords.tackle(t);
  cords.along(t, [&](std::uint32_t s, std::uint32_t, std::uint32_t, const Pull& pull) {
    for (std::uint32_t p = 0; p < s; ++p) {
      const auto [use, own, before] = row_of(work.pulleys[tackle.first_pulley + p], slide);
      double* const to = values + tackle.at_pulley(p);
      double* const gradient = to + LoopTackle::in_pulley + 3 * (s - p - 1);
      for (std::uint32_t c = 0; c < 3; ++c) {
        const double along = use * (c == 0 ? pull.gradient.x : c == 1 ? pull.gradient.y : pull.gradient.z);
        gradient[c] += along;
        gradient[3 + c] -= along;
      }
      if (p + 1 < s) continue;
      put(to, -1.0 * pull.force);
      put(to + 3, pull.force);
      to[tackle.in_own(p)] = own;
      to[tackle.in_own(p) + 1] = before;
    }
  });
}

void leave_out_locked_pulleys(const LoopState& state, const LoopTackle& tackle, double* values) {
  for (std::uint32_t p = 0; p < tackle.pulleys(); ++p)
    for (std::uint32_t o = p + 1; o <= tackle.segments(); ++o) {
      if (!state.locks.has(tackle.vertices[o])) continue;
      double* const to = values + tackle.at_pulley(p);
      const std::uint32_t behind = o - p - 1;
      if (behind < 2) put(to + 3 * behind, {});
      put(to + LoopTackle::in_pulley + 3 * behind, {});
    }
}

void lack_of_pulleys(const Cords& cords, std::uint32_t t, SlideOf slide, const PulleyView& of,
                     std::span<double> right) {
  if (!cords.tackle(t).rubs) return;
  walk_pulleys(cords, t, growth, [&](std::uint32_t p, std::uint32_t s, double slid) {
    const auto [use, own, before] = row_of(of.work.tackles.pulleys[p], slide);
    const double lack = use * slid + own * of.state.mu[cords.multiplier(t, s)] +
                        before * of.state.mu[cords.multiplier(t, s - 1)];
    right[position_of(cords, t, s, of.state)] = -lack;
  });
}

void lack_of_projected_pulleys(const Cords& cords, std::uint32_t t, const PulleyView& of,
                               std::span<double> right) {
  if (!cords.tackle(t).rubs) return;
  const auto rate = [&](const Pull& pull, std::uint32_t a, std::uint32_t b) {
    return dot(pull.gradient, at(of.work.delta, a) - at(of.work.delta, b));
  };
  walk_pulleys(cords, t, rate, [&](std::uint32_t p, std::uint32_t s, double slid) {
    const PulleyRow row = row_of(of.work.tackles.pulleys[p], &Pulley::blow);
    right[position_of(cords, t, s, of.state)] = -row.use * slid;
  });
}

void begin_blow(TackleWorkspace& work) {
  for (Pulley& pulley : work.pulleys) pulley.blow = pulley.slide;
}

bool finds_other_slides(const LoopState& state, std::span<const double> before, LoopWorkspace& work) {
  if (state.pulley_impulses.empty()) return false;
  const Cords cords(state, work, 1, false);
  const std::uint32_t nodes = state.topology->nodes;
  // A blow acts along the mean of both velocities: only so friction never gives energy.
  const auto twice = [&](std::uint32_t i) {
    return i < nodes ? at(before, i) + at(state.u, i)
                     : state.fixed_last_velocity[i - nodes] + state.fixed_velocity[i - nodes];
  };
  const auto rate = [&](const Pull& pull, std::uint32_t a, std::uint32_t b) {
    return dot(pull.gradient, twice(a) - twice(b));
  };
  bool any = false;
  for (std::uint32_t t = 0; t < cords.count(); ++t) {
    if (!cords.tackle(t).rubs) continue;
    walk_pulleys(cords, t, rate, [&](std::uint32_t p, std::uint32_t s, double slid) {
      Pulley& pulley = work.tackles.pulleys[p];
      const double ahead = work.blows[cords.multiplier(t, s - 1)],
                   behind = work.blows[cords.multiplier(t, s)];
      Slide next = pulley.blow;
      if (next == Slide::sticks) next = next_slide({pulley.most, Slide::sticks}, ahead, behind, 0, 0);
      if (next == Slide::on && slid < 0)
        next = Slide::back;
      else if (next == Slide::back && slid > 0)
        next = Slide::on;
      // A cord that pushes has no friction. In one substep it pulled as it did in the last.
      const double pulled = std::sqrt(2 * state.mu_kick) * -state.mu[cords.multiplier(t, s - 1)];
      if (ahead > 0 && state.mu_kick * ahead >= pulled) next = Slide::even;
      any = any || next != pulley.blow;
      pulley.blow = next;
    });
  }
  return any;
}

bool begin_stop(const LoopState& state, double h, LoopWorkspace& work) {
  TackleWorkspace& tackles = work.tackles;
  const auto sticks = [](const Pulley& pulley) { return pulley.slide == Slide::sticks; };
  if (std::none_of(tackles.pulleys.begin(), tackles.pulleys.end(), sticks)) return false;
  measure_tackles(state, tackles);
  const Cords cords(state, work, 1, false);
  const std::uint32_t nodes = state.topology->nodes;
  const auto velocity = [&](std::uint32_t i) {
    return i < nodes ? at(state.u, i) : state.fixed_velocity[i - nodes];
  };
  const auto rate = [&](const Pull& pull, std::uint32_t a, std::uint32_t b) {
    return dot(pull.gradient, velocity(a) - velocity(b));
  };
  bool moves = false;
  for (std::uint32_t t = 0; t < cords.count(); ++t) {
    if (!cords.tackle(t).rubs) continue;
    walk_pulleys(cords, t, rate, [&](std::uint32_t p, std::uint32_t, double slid) {
      moves = moves || (sticks(tackles.pulleys[p]) && std::abs(slid) * h > at_rest * tackles.lengths[t]);
    });
  }
  for (Pulley& pulley : tackles.pulleys) pulley.blow = moves && sticks(pulley) ? Slide::sticks : Slide::even;
  return moves;
}

void end_blow(TackleWorkspace& work) {
  for (Pulley& pulley : work.pulleys) pulley.blow = Slide::even;
}

}  // namespace plumb::detail
