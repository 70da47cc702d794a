#include "direct/twists/loop_twists.hpp"

#include <algorithm>
#include <cmath>

#include "direct/bends/loop_bends.hpp"
#include "direct/loops/loop_stepper.hpp"
#include "direct/loops/loop_vectors.hpp"
#include "direct/twists/twist_law.hpp"

namespace plumb::detail {
namespace {

using Joint = std::array<std::uint32_t, 3>;

/// A joint's vertices have these shares in its two rods.
constexpr double shares[3][2] = {{-1, 0}, {1, -1}, {0, 1}};

RodPair pair_at(std::span<const double> x, const Joint& joint) {
  return {at(x, joint[1]) - at(x, joint[0]), at(x, joint[2]) - at(x, joint[1])};
}

/// Returns rods when they have done this share of a substep.
RodPair rods_at(const RodPair& start, double share, const RodPair& change) {
  return {start.first + share * change.first, start.second + share * change.second};
}

double product(const RodPair& a, const RodPair& b) {
  return dot(a.first, b.first) + dot(a.second, b.second);
}

/// Returns m^T v.
Vec3 transposed(const std::array<double, 9>& m, Vec3 v) {
  return {m[0] * v.x + m[3] * v.y + m[6] * v.z, m[1] * v.x + m[4] * v.y + m[7] * v.z,
          m[2] * v.x + m[5] * v.y + m[8] * v.z};
}

/// How far into a substep the pull of a torque is taken, and by which share of the change of twist it grows.
struct Times {
  double pull, growth;
};
Times times_of(double theta, bool gives) {
  return gives ? Times{0, 1} : Times{theta, theta};
}

/// Returns the change of twist at a joint, to second order by the middle position. The linear response takes
/// the first.
double turn_of(const RodPair& start, const RodPair& change, bool gives) {
  return product(twist_direction(rods_at(start, gives ? 0 : 0.5, change)), change);
}

/// Returns the derivative of turn_of() by the change of rods.
RodPair turn_gradient(const RodPair& start, const RodPair& change, bool gives) {
  if (gives) return twist_direction(start);
  const RodPair middle = rods_at(start, 0.5, change);
  const auto& slopes = twist_slopes(middle).of;
  RodPair out = twist_direction(middle);
  out.first += 0.5 * (transposed(slopes[0][0], change.first) + transposed(slopes[1][0], change.second));
  out.second += 0.5 * (transposed(slopes[0][1], change.first) + transposed(slopes[1][1], change.second));
  return out;
}

double turn_of(const LoopState& state, std::uint32_t k, bool gives, const LoopWorkspace& work) {
  const LoopTwist& twist = state.topology->twists[k];
  double sum = 0;
  for (std::uint32_t j = 0; j < twist.joints(); ++j)
    sum += turn_of(pair_at(state.x, twist.joint(j)), pair_at(work.delta, twist.joint(j)), gives);
  return sum;
}

/// Writes, for each vertex of a joint, its share of what both rods have.
void write_shares(const LoopState& state, const Joint& joint, const RodPair& rods, double* to) {
  for (std::size_t i = 0; i < 3; ++i)
    put(to + 3 * i,
        state.locks.has(joint[i]) ? Vec3{} : shares[i][0] * rods.first + shares[i][1] * rods.second);
}

/// Writes a tile for every two vertices of a joint: `scale` times the derivative of the pull on the one by
/// the place of the other.
void write_tiles(const LoopState& state, const Joint& joint, double scale, const TwistSlopes& slopes,
                 double* to) {
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j, to += 9) {
      std::fill(to, to + 9, 0.0);
      if (state.locks.has(joint[i]) || state.locks.has(joint[j])) continue;
      for (std::size_t r = 0; r < 2; ++r)
        for (std::size_t s = 0; s < 2; ++s)
          for (std::size_t c = 0; c < 9; ++c)
            to[c] += scale * shares[i][r] * shares[j][s] * slopes.of[r][s][c];
    }
}

/// Adds up what the torque of a chain asks of fixed vertices.
void add_holds(LoopState& state, std::uint32_t k, const SubstepEnd& end, const LoopWorkspace& work) {
  const std::uint32_t nodes = state.topology->nodes;
  const LoopTwist& twist = state.topology->twists[k];
  const double impulse = end.h / end.kick * end.mass_unit * work.twists[k].torque;
  for (std::uint32_t j = 0; j < twist.joints(); ++j) {
    const Joint joint = twist.joint(j);
    const RodPair start = pair_at(state.x, joint), change = pair_at(work.delta, joint);
    const RodPair pull = twist_direction(rods_at(start, end.theta, change));
    for (std::size_t i = 0; i < 3; ++i)
      if (joint[i] >= nodes)
        state.hold[joint[i] - nodes] += impulse * (shares[i][0] * pull.first + shares[i][1] * pull.second);
  }
}

}  // namespace

LoopTwistNumbers twist_numbers(const BendTable& table, std::uint32_t twist, double mass_unit) {
  const Twist& from = table.scene.twists[twist];
  return {from.stiffness / (table.twist_lengths[twist] * mass_unit), {}, from.angle, from.angle};
}

void load_twists(LoopState& state, const BendTable& table, const IslandRods& rods,
                 std::span<const std::uint32_t> twists) {
  for (std::size_t k = 0; k < twists.size(); ++k) {
    LoopTwistNumbers numbers = twist_numbers(table, twists[k], state.mass_unit);
    const auto& vertices = state.topology->twists[k].vertices;
    for (std::size_t i = 1; i < vertices.size(); ++i)
      if (const std::uint32_t rod = rods.find(vertices[i - 1], vertices[i]); rod != IslandRods::none)
        numbers.rods.push_back(rod);
    state.twisted.push_back(numbers.imposed);
    state.twists.push_back(std::move(numbers));
  }
}

void begin_twists(std::span<LoopTwistNumbers> twists, double dt) {
  for (LoopTwistNumbers& twist : twists) twist.rate = (twist.target - twist.imposed) / dt;
}

void finish_twists(std::span<LoopTwistNumbers> twists) {
  for (LoopTwistNumbers& twist : twists) twist.imposed = twist.target;
}

TwistSubstep twist_substep(const LoopTwistNumbers& twist, double twisted, double h, double kick,
                           bool is_mid) {
  const double stiffness = kick * twist.stiffness, growth = is_mid ? 0.5 : 1;
  const double start = twisted + growth * h * twist.rate;
  return {stiffness, start, stiffness * start};
}

void start_twists(const LoopState& state, double h, LoopWorkspace& work) {
  for (std::size_t k = 0; k < state.twists.size(); ++k) {
    const LoopTwistNumbers& twist = state.twists[k];
    const bool is_broken =
        state.laws.any() && std::any_of(twist.rods.begin(), twist.rods.end(),
                                        [&](auto rod) { return state.laws.is_broken(rod); });
    const double kick = is_broken ? 0 : work.laws.factors.kick;
    work.twists[k] = twist_substep(twist, state.twisted[k], h, kick, work.laws.is_mid);
  }
}

void write_twists(const LoopState& state, double theta, bool gives, const LoopWorkspace& work,
                  std::span<double> values) {
  const Times times = times_of(theta, gives);
  double* to = values.data();
  for (std::uint32_t k = 0; k < state.twists.size(); ++k) {
    const LoopTwist& twist = state.topology->twists[k];
    const TwistSubstep& now = work.twists[k];
    for (std::uint32_t j = 0; j < twist.joints(); ++j, to += LoopTwist::per_joint) {
      const Joint joint = twist.joint(j);
      const RodPair start = pair_at(state.x, joint), change = pair_at(work.delta, joint);
      const RodPair at_pull = rods_at(start, times.pull, change);
      write_tiles(state, joint, now.torque * times.pull, gives ? TwistSlopes{} : twist_slopes(at_pull), to);
      write_shares(state, joint, twist_direction(at_pull), to + LoopTwist::at_pulls);
      const double growth = now.stiffness * times.growth;
      const RodPair gradient = turn_gradient(start, change, gives);
      write_shares(state, joint, {growth * gradient.first, growth * gradient.second}, to + LoopTwist::at_row);
    }
    *to++ = -1;
  }
}

void pull_by_twists(const LoopState& state, double theta, bool gives, const LoopWorkspace& work,
                    std::span<double> right) {
  const SparseAnalysis& analysis = state.topology->system->analysis;
  const Times times = times_of(theta, gives);
  for (std::uint32_t k = 0; k < state.twists.size(); ++k) {
    const LoopTwist& twist = state.topology->twists[k];
    const TwistSubstep& now = work.twists[k];
    double turned = 0;
    for (std::uint32_t j = 0; j < twist.joints(); ++j) {
      const Joint joint = twist.joint(j);
      const RodPair start = pair_at(state.x, joint), change = pair_at(work.delta, joint);
      turned += turn_of(start, change, gives);
      double pulls[9];
      write_shares(state, joint, twist_direction(rods_at(start, times.pull, change)), pulls);
      for (std::size_t i = 0; i < 3; ++i) {
        if (joint[i] >= state.topology->nodes) continue;
        double* const node = right.data() + analysis.position(joint[i]);
        for (std::size_t c = 0; c < 3; ++c) node[c] -= now.torque * pulls[3 * i + c];
      }
    }
    right[analysis.position(state.topology->system->torque(k))] =
        now.torque - now.stiffness * (now.start + times.growth * turned);
  }
}

void change_torques(const LoopState& state, double scale, std::span<const double> change,
                    LoopWorkspace& work) {
  const LoopSystem& system = *state.topology->system;
  for (std::uint32_t k = 0; k < work.twists.size(); ++k)
    work.twists[k].torque += scale * change[system.analysis.position(system.torque(k))];
}

void set_linear_torques(const LoopState& state, LoopWorkspace& work) {
  for (std::uint32_t k = 0; k < work.twists.size(); ++k) {
    TwistSubstep& now = work.twists[k];
    now.torque = now.stiffness * (now.start + turn_of(state, k, true, work));
  }
}

LoopWork work_of_twists(const LoopState& state, const LoopWorkspace& work, double least) {
  LoopWork out;
  for (std::uint32_t k = 0; k < work.twists.size(); ++k) {
    const LoopTwist& twist = state.topology->twists[k];
    for (std::uint32_t j = 0; j < twist.joints(); ++j) {
      const double turn =
          turn_of(pair_at(state.x, twist.joint(j)), pair_at(work.delta, twist.joint(j)), false);
      out.done -= work.twists[k].torque * turn;
      out.scale += std::abs(work.twists[k].torque) * (std::abs(turn) + least);
    }
  }
  return out;
}

double energy_of_twists(const LoopState& state, const LoopWorkspace& work) {
  double sum = 0;
  for (std::uint32_t k = 0; k < work.twists.size(); ++k) {
    const double twisted = work.twists[k].start + turn_of(state, k, true, work);
    sum += 0.5 * work.twists[k].stiffness * twisted * twisted;
  }
  return sum;
}

void end_twists(LoopState& state, const SubstepEnd& end, const LoopWorkspace& work) {
  for (std::uint32_t k = 0; k < state.twists.size(); ++k) {
    state.twisted[k] += turn_of(state, k, false, work) + end.h * state.twists[k].rate;
    if (state.laws.pulls) add_holds(state, k, end, work);
  }
}

}  // namespace plumb::detail
