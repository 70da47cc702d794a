#include "group_stepper.hpp"

#include <algorithm>
#include <cmath>

namespace plumb::detail {
namespace {

/// Radians that a rod turns by in a substep, at most: corrections along the gradients of the start then take
/// a digit off what is left every time.
constexpr double most_turn = 0.35;
/// Of the radii of two that approach, how far they do in a substep.
constexpr double most_approach = 0.5;
/// A step is cut into no more than so many.
constexpr double most_cuts = 4096;
/// Nor into more because it would gain energy.
constexpr double most_guards = 64;
/// Of a weight's energy, gained at rest.
constexpr double unnoticed = 3e-9;
/// Of a motion's energy, left in free flight rather than taken from a rigid whole, whose momentum it would
/// be.
constexpr double let_be = 1e-6;
/// Left of constraints, relative to lengths.
constexpr double exact = 1e-8;
constexpr int most_corrections = 16;
/// What a sweep may still change when it is the last, of what gravity does in a substep, and in m.
constexpr double still = 1e-3, least_still = 1e-9;
constexpr int most_sweeps = 60;
constexpr int most_rounds = 4;
/// Left of contacts, m, a substep is taken again, shorter.
constexpr double too_much = 1e-5;
/// Slower than this nothing bounces, m/s: it would for ever.
constexpr double least_bounce = 0.05;
/// What is near enough to be kept from touching, m.
constexpr double margin = 2e-3;
/// Overlap beyond this is taken back, a tenth a substep, m.
constexpr double most_overlap = 5e-4;

Combination blend(const Combination& a, const Combination& b, double t) {
  if (t <= 0) return a;
  if (t >= 1) return b;
  Combination out;
  for (std::uint32_t i = 0; i < a.count; ++i) out.add(a.terms[i].particle, (1 - t) * a.terms[i].weight);
  for (std::uint32_t i = 0; i < b.count; ++i) out.add(b.terms[i].particle, t * b.terms[i].weight);
  return out;
}

void include(Bounds& bounds, Vec3 p, double radius) {
  bounds.low = {std::min(bounds.low.x, p.x - radius), std::min(bounds.low.y, p.y - radius),
                std::min(bounds.low.z, p.z - radius)};
  bounds.high = {std::max(bounds.high.x, p.x + radius), std::max(bounds.high.y, p.y + radius),
                 std::max(bounds.high.z, p.z + radius)};
}

constexpr Bounds nowhere{{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};

Bounds bounds_of(const Linkage& linkage, std::span<const Vec3> x, double further) {
  Bounds out = nowhere;
  for (const Linkage::Shape& shape : linkage.shapes()) {
    include(out, shape.a.of(x), shape.radius + further);
    include(out, shape.b.of(x), shape.radius + further);
  }
  return out;
}

/// How far apart two boxes are along the axis that says most; negative: they overlap.
double distance(const Bounds& a, const Bounds& b) {
  return std::max({a.low.x - b.high.x, b.low.x - a.high.x, a.low.y - b.high.y, b.low.y - a.high.y,
                   a.low.z - b.high.z, b.low.z - a.high.z});
}

double least_radius(const Linkage& linkage) {
  double least = linkage.size();
  for (const Linkage::Shape& shape : linkage.shapes()) least = std::min(least, shape.radius);
  return std::max(least, 0.01 * linkage.size());
}

/// Two directions across n, of length one.
std::pair<Vec3, Vec3> across(Vec3 n) {
  const Vec3 other = std::abs(n.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 t = cross(n, other);
  const Vec3 first = (1 / norm(t)) * t;
  return {first, cross(n, first)};
}

std::uint32_t padded(std::size_t batches) {
  return static_cast<std::uint32_t>(batches * simd::kkt_lanes);
}

/// Who touches whom, in one number.
std::uint64_t contact_key(std::uint64_t kind, std::uint64_t own, std::uint64_t island, std::uint64_t other) {
  return ((kind << 60) | (own << 44) | (other << 28)) ^ island;
}

bool is_finite(const LinkageState& state) {
  const auto all = [](std::span<const Vec3> of) {
    return std::all_of(of.begin(), of.end(), [](Vec3 v) { return plumb::is_finite(v); });
  };
  return all(state.x) && all(state.v);
}

double dot_with(const Combination& sum, Vec3 along, std::span<const Vec3> motion) {
  double out = 0;
  for (std::uint32_t i = 0; i < sum.count; ++i)
    out += sum.terms[i].weight * dot(along, motion[sum.terms[i].particle]);
  return out;
}

}  // namespace

double top_speed(const LinkageState& state) {
  double square = 0;
  for (std::uint32_t i = 0; i < state.linkage->movable(); ++i)
    square = std::max(square, dot(state.v[i], state.v[i]));
  return std::sqrt(square);
}

Bounds reach(const LinkageState& state, double dt) {
  const double fall = 0.5 * norm(state.linkage->gravity()) * dt * dt;
  return bounds_of(*state.linkage, state.x, 1.1 * top_speed(state) * dt + fall + margin);
}

void GroupStepper::step(std::span<LinkageState* const> group, const Surroundings& surroundings,
                        const ContactRules& rules, double dt, StepReport& report) {
  count_ = static_cast<std::uint32_t>(group.size());
  if (islands_.size() < count_) islands_.resize(count_);
  for (std::uint32_t i = 0; i < count_; ++i) {
    islands_[i].state = group[i];
    islands_[i].awake = !group[i]->asleep && !group[i]->frozen;
  }
  double left = dt;
  const double least = dt / most_cuts;
  shortest_ = dt / most_guards;
  while (left > 1e-12 * dt) {
    const double longest = std::max(std::min(dt / rules.substeps, longest_substep(dt)), least);
    double h = left / std::ceil(left / longest - 1e-9);
    while (!substep(surroundings, h, report)) {
      h /= 2;
      ++report.halvings;
      if (h >= least / 16) continue;
      // Nothing more can be done: what cannot be solved stays where it is.
      ++report.unsolved;
      for (std::uint32_t i = 0; i < count_; ++i)
        if (islands_[i].awake)
          std::fill_n(islands_[i].state->v.begin(), islands_[i].state->linkage->movable(), Vec3{});
      return;
    }
    ++report.tree_substeps;
    left -= h;
  }
}

double GroupStepper::longest_substep(double most) const {
  double out = most;
  for (std::uint32_t i = 0; i < count_; ++i) {
    const Island& a = islands_[i];
    if (a.awake) {
      const double turning = a.state->linkage->turning(a.state->x, a.state->v);
      if (turning * out > most_turn) out = most_turn / turning;
    }
    if (count_ == 1) break;
    const Bounds own = bounds_of(*a.state->linkage, a.state->x, 0);
    for (std::uint32_t j = i + 1; j < count_; ++j) {
      const Island& b = islands_[j];
      if (!a.awake && !b.awake) continue;
      const double speed = (a.awake ? top_speed(*a.state) : 0) + (b.awake ? top_speed(*b.state) : 0);
      const double near = most_approach * (least_radius(*a.state->linkage) + least_radius(*b.state->linkage));
      const double far = distance(own, bounds_of(*b.state->linkage, b.state->x, 0));
      out = std::min(out, std::max(near, far) / (speed + 1e-30));
    }
  }
  return out;
}

bool GroupStepper::factor(LinkageState& state) {
  state.factors.resize(state.linkage->plan().values());
  state.linkage->assemble(state.x, state.factors);
  state.factored = state.linkage->plan().factor(state.factors);
  return state.factored;
}

// Back to where it was before the substep, for good.
void GroupStepper::freeze(Island& island, StepReport& report) {
  LinkageState& state = *island.state;
  std::swap(state.x, island.there);
  std::fill_n(state.v.begin(), state.linkage->movable(), Vec3{});
  state.kept.clear();
  state.energy.reset();
  state.frozen = true;
  island.awake = false;
  ++report.frozen_islands;
}

void GroupStepper::start(Island& island, double h) {
  LinkageState& state = *island.state;
  const Linkage& linkage = *state.linkage;
  const std::uint32_t movable = linkage.movable();
  if (!state.factored) factor(state);
  island.d.resize(state.x.size());
  island.there.resize(state.x.size());
  island.v.resize(state.x.size());
  island.momentum.resize(movable);
  island.force.resize(movable);
  island.right.resize(linkage.plan().unknowns());
  const double kept = linkage.drag() == 0 ? 1 : std::exp(-0.5 * h * linkage.drag());
  for (std::size_t i = 0; i < state.x.size(); ++i) {
    island.v[i] = i < movable ? kept * state.v[i] : state.v[i];
    island.d[i] = h * island.v[i];
    island.there[i] = state.x[i] + island.d[i];
  }
  linkage.forces(state.x, island.v, state.force, h, island.force);
  linkage.momenta(island.v, island.momentum);
  linkage.targets(state.x, island.d, island.there, island.right);
  for (std::uint32_t i = 0; i < movable; ++i) {
    const Vec3 push = h * island.momentum[i] + (0.5 * h * h) * island.force[i];
    const std::uint32_t slot = linkage.slot(i);
    island.right[slot] = push.x;
    island.right[slot + 1] = push.y;
    island.right[slot + 2] = push.z;
  }
  linkage.plan().solve(state.factors, island.right);
  for (std::uint32_t i = 0; i < movable; ++i) {
    const double* at = &island.right[linkage.slot(i)];
    island.d[i] = {at[0], at[1], at[2]};
  }
}

bool GroupStepper::substep(const Surroundings& surroundings, double h, StepReport& report) {
  all_near_ = false;
  still_ = least_still;
  for (std::uint32_t i = 0; i < count_; ++i)
    still_ = std::max(still_, still * 0.5 * h * h * norm(islands_[i].state->linkage->gravity()));
  if (!find_positions(surroundings, h, report)) return false;
  if (is_contact_missed()) {
    all_near_ = true;
    if (!find_positions(surroundings, h, report)) return false;
  }
  const double before = energy();
  const bool touched = std::any_of(rows_.begin(), rows_.end(), [](const Row& row) { return row.p != 0; });
  finish(h, touched);
  if (touched) bounce(h);
  for (std::uint32_t i = 0; i < count_; ++i)
    if (islands_[i].awake) brake(islands_[i], h);
  if (!guard_energy(before, touched, h > shortest_, report)) {
    for (std::uint32_t i = 0; i < count_; ++i) {
      Island& island = islands_[i];
      if (!island.awake) continue;
      std::swap(island.state->x, island.there);
      island.state->factored = false;
    }
    return false;
  }
  for (std::uint32_t i = 0; i < count_; ++i)
    if (islands_[i].awake)
      std::copy_n(islands_[i].v.begin(), islands_[i].state->linkage->movable(), islands_[i].state->v.begin());
  keep_contacts(h);
  for (std::uint32_t i = 0; i < count_; ++i)
    if (islands_[i].awake && !is_finite(*islands_[i].state)) freeze(islands_[i], report);
  report.contacts = std::max<std::uint64_t>(
      report.contacts, std::count_if(rows_.begin(), rows_.end(),
                                     [](const Row& row) { return row.kind == Kind::normal && row.p > 0; }));
  return true;
}

bool GroupStepper::find_positions(const Surroundings& surroundings, double h, StepReport& report) {
  for (std::uint32_t i = 0; i < count_; ++i)
    if (islands_[i].awake) start(islands_[i], h);
  do {
    woken_ = false;
    find_contacts(surroundings, h);
    for (std::uint32_t i = 0; woken_ && i < count_; ++i)
      if (!islands_[i].state->asleep && !islands_[i].awake && !islands_[i].state->frozen) {
        islands_[i].awake = true;
        islands_[i].state->calm = 0;
        start(islands_[i], h);
      }
  } while (woken_);
  if (!rows_.empty()) find_responses();
  return solve_positions(report);
}

/// Whether something went through what it was not expected to reach, pushed by other contacts.
bool GroupStepper::is_contact_missed() const {
  return std::any_of(left_out_.begin(), left_out_.end(), [&](const LeftOut& each) {
    const auto moved = [&](std::uint32_t i, const Combination& at) {
      return i != none && islands_[i].awake ? at.of(islands_[i].d) : Vec3{};
    };
    const Vec3 shift = moved(each.island, each.at) - moved(each.other, each.at_other);
    return each.touch.gap + dot(each.touch.normal, shift) < -too_much;
  });
}

std::uint32_t GroupStepper::add_side(Island& island, const Side& side) {
  island.sides.push_back(side);
  return static_cast<std::uint32_t>(island.sides.size() - 1);
}

void GroupStepper::add_contact(std::uint32_t i, const Combination& at, std::uint32_t j,
                               const Combination& at_other, const Touch& touch, const Surface& a,
                               const Surface& b, std::uint64_t key, double h) {
  Island* const one = &islands_[i];
  Island* const two = j == none ? nullptr : &islands_[j];
  const auto motion = [&](const Island* island, const Combination& sum, std::span<const Vec3> of) {
    return island && island->awake ? sum.of(of) : Vec3{};
  };
  const Vec3 shift = motion(one, at, one->d) - (two ? motion(two, at_other, two->d) : Vec3{});
  const double closing = dot(touch.normal, shift);
  if (!all_near_ && touch.gap + closing > margin + 0.25 * norm(shift)) {
    if (touch.gap < 0.1 + 2 * norm(shift)) left_out_.push_back({i, j, at, at_other, touch});
    return;
  }
  for (Island* island : {one, two})
    if (island && !island->awake) {
      if (island->state->asleep && touch.gap + closing < 0) {
        island->state->asleep = false;
        woken_ = true;
      }
      return;
    }
  const Vec3 speed = at.of(one->v) - (two ? at_other.of(two->v) : Vec3{});
  // With what it arrives at the surface, having been sped up on the way there.
  const double arriving = dot(touch.normal, speed), gain = 2 * (closing - h * arriving) / (h * h);
  const double square = arriving * arriving - 2 * gain * std::max(touch.gap, 0.0);
  const double hit = arriving < 0 ? std::sqrt(std::max(square, 0.0)) : 0;
  const double restitution = std::max(a.restitution, b.restitution);
  const auto [t1, t2] = across(touch.normal);
  Vec3 warm{};
  for (const KeptContact& kept : one->state->kept)
    if (kept.key == key) warm = (h * h) * kept.force;
  const Vec3 axes[3] = {touch.normal, t1, t2};
  for (int axis = 0; axis < 3; ++axis) {
    Row row;
    row.kind = axis == 0 ? Kind::normal : Kind::sliding;
    row.island[0] = i;
    row.side[0] = add_side(*one, {at, {}, axes[axis], {}});
    row.ends = two ? 2 : 1;
    if (two) {
      row.island[1] = j;
      row.side[1] = add_side(*two, {at_other, {}, -1.0 * axes[axis], {}});
    }
    row.key = key;
    row.p = dot(warm, axes[axis]);
    if (axis == 0) {
      row.gap = touch.gap >= 0 ? touch.gap : std::min(0.0, 0.1 * (touch.gap + most_overlap));
      row.bound = std::sqrt(a.friction * b.friction);
      row.bounce = hit > least_bounce ? restitution * hit : 0;
      row.p = std::max(row.p, 0.0);
    }
    rows_.push_back(row);
  }
}

void GroupStepper::add_angles(std::uint32_t i, double h) {
  Island& island = islands_[i];
  const LinkageState& state = *island.state;
  std::uint64_t number = 0;
  for (const Linkage::Angle& angle : state.linkage->angles()) {
    const std::uint64_t key = contact_key(4, number++, 0, 0);
    const auto [value, along_u, along_v] = Linkage::slope(angle, state.x);
    const Side side{angle.u, angle.v, along_u, along_v};
    const double by = dot_with(side.a, side.along_a, island.d) + dot_with(side.b, side.along_b, island.d);
    const auto add = [&](Kind kind, double sign) -> Row& {
      Row row;
      row.kind = kind;
      row.island[0] = i;
      row.ends = 1;
      row.side[0] = add_side(island, {side.a, side.b, sign * side.along_a, sign * side.along_b});
      row.key = key + static_cast<std::uint64_t>(kind) * 2 + (sign < 0);
      for (const KeptContact& kept : state.kept)
        if (kept.key == row.key) row.p = h * h * kept.force.x;
      return rows_.emplace_back(row);
    };
    const double near = 0.05 + std::abs(by);
    if (angle.lower > 0 && value + by - angle.lower < near) add(Kind::limit, 1).gap = value - angle.lower;
    if (angle.upper < std::numbers::pi && angle.upper - value - by < near)
      add(Kind::limit, -1).gap = angle.upper - value;
    if (angle.friction > 0) {
      // Half in either half of the substep.
      Row& row = add(Kind::brake, 1);
      row.bound = 0.5 * h * h * angle.friction;
      row.bounce = 0.5 * h * angle.friction;
    }
    if (angle.stiffness > 0) {
      const double stiff = h * h * angle.stiffness + h * angle.damping;
      Row& row = add(Kind::drive, 1);
      row.softness = 1 / stiff;
      row.gap = h * h * angle.stiffness / stiff * (value - angle.target);
    }
  }
}

void GroupStepper::find_contacts(const Surroundings& surroundings, double h) {
  rows_.clear();
  left_out_.clear();
  for (std::uint32_t i = 0; i < count_; ++i) {
    Island& island = islands_[i];
    island.sides.clear();
    island.bounds = bounds_of(*island.state->linkage, island.state->x, margin);
    if (!island.awake) continue;
    for (const Linkage::Shape& shape : island.state->linkage->shapes())
      for (const Combination* end : {&shape.a, &shape.b})
        include(island.bounds, end->of(island.state->x) + 1.25 * end->of(island.d), shape.radius + margin);
  }
  for (std::uint32_t i = 0; i < count_; ++i) {
    Island& island = islands_[i];
    const Linkage& linkage = *island.state->linkage;
    const std::span<const Vec3> x = island.state->x;
    if (island.awake) {
      for (std::uint32_t p = 0; p < surroundings.planes.size(); ++p) {
        const Plane& plane = surroundings.planes[p];
        for (std::uint32_t k = 0; k < linkage.balls().size(); ++k) {
          const Linkage::Ball& ball = linkage.balls()[k];
          const Touch touch{dot(plane.normal, ball.center.of(x)) - plane.offset - ball.radius, plane.normal};
          add_contact(i, ball.center, none, {}, touch, ball.surface, plane.surface, contact_key(1, k, 0, p),
                      h);
        }
      }
      for (std::uint32_t b = 0; b < surroundings.boxes.size(); ++b) {
        const Surroundings::Solid& box = surroundings.boxes[b];
        if (!box.bounds.overlaps(island.bounds)) continue;
        for (std::uint32_t k = 0; k < linkage.shapes().size(); ++k) {
          const Linkage::Shape& shape = linkage.shapes()[k];
          const Vec3 p = box.frame.to_local(shape.a.of(x) - box.center);
          const Vec3 q = box.frame.to_local(shape.b.of(x) - box.center);
          const double nearest = p == q ? 0 : nearest_to_box(p, q, box.half);
          std::uint64_t which = 0;
          for (const double t : touching_box(p, q, box.half, nearest)) {
            ++which;
            if (which > 1 && (!(t >= 0 && t <= 1) || p == q || std::abs(t - nearest) < 1e-3)) continue;
            Touch touch = touch_box(between(p, q, t), shape.radius, box.half);
            touch.normal = box.frame.to_space(touch.normal);
            add_contact(i, blend(shape.a, shape.b, t), none, {}, touch, shape.surface, box.surface,
                        contact_key(2, 16 * k + which, 0, b), h);
          }
        }
      }
      add_angles(i, h);
    }
    for (std::uint32_t j = i + 1; j < count_; ++j) {
      const Island& other = islands_[j];
      if ((!island.awake && !other.awake) || !island.bounds.overlaps(other.bounds)) continue;
      const Linkage& linkage_j = *other.state->linkage;
      for (std::uint32_t k = 0; k < linkage.shapes().size(); ++k) {
        const Linkage::Shape& a = linkage.shapes()[k];
        const Segment first{a.a.of(x), a.b.of(x), a.radius};
        for (std::uint32_t l = 0; l < linkage_j.shapes().size(); ++l) {
          const Linkage::Shape& b = linkage_j.shapes()[l];
          const Touches near = touches(first, {b.a.of(other.state->x), b.b.of(other.state->x), b.radius});
          for (std::uint32_t n = 0; n < near.count; ++n) {
            const Touch& at = near.at[n];
            add_contact(i, blend(a.a, a.b, at.a), j, blend(b.a, b.b, at.b), at, a.surface, b.surface,
                        contact_key(3, 4 * k + n, other.state->number, l), h);
          }
        }
      }
    }
  }
}

void GroupStepper::find_responses() {
  for (std::uint32_t i = 0; i < count_; ++i)
    if (!islands_[i].sides.empty()) couple(islands_[i]);
  for (Row& row : rows_) {
    double own = row.softness;
    row.across[0] = row.across[1] = 0;
    for (std::uint32_t i = 0; i < row.ends; ++i) {
      Island& island = islands_[row.island[i]];
      const std::uint32_t side = row.side[i];
      row.end[i] = {island.speed.front().of, island.push.front().of, island.row(side), side,
                    padded(island.batches())};
      own += row.end[i].coupling[side];
      if (row.kind != Kind::normal) continue;
      for (std::uint32_t axis = 0; axis < 2; ++axis) row.across[axis] += row.end[i].coupling[side + 1 + axis];
    }
    row.own = own;
    row.over = own > 0 ? 1 / own : 0;
  }
}

/// Solves for what a push of one on each side does, eight at a time, and what every side sees of that.
void GroupStepper::couple(Island& island) {
  constexpr std::size_t lanes = simd::kkt_lanes;
  const Linkage& linkage = *island.state->linkage;
  const std::uint32_t unknowns = linkage.plan().unknowns();
  const std::size_t batches = island.batches(), count = island.sides.size();
  island.response.assign(batches * unknowns, Lanes{});
  island.coupling.resize(count * batches);
  island.speed.resize(batches);
  island.push.assign(batches, Lanes{});

  // Of a side, its unknowns and how it weighs them.
  std::uint32_t slots[48];
  double factors[48];
  const auto gather = [&](const Side& side) {
    std::uint32_t used = 0;
    const auto add = [&](const Combination& sum, Vec3 along) {
      for (std::uint32_t k = 0; k < sum.count; ++k) {
        if (sum.terms[k].particle >= linkage.movable()) continue;
        const std::uint32_t slot = linkage.slot(sum.terms[k].particle);
        const Vec3 by = sum.terms[k].weight * along;
        for (const auto& [axis, value] : {std::pair{0u, by.x}, std::pair{1u, by.y}, std::pair{2u, by.z}}) {
          slots[used] = slot + axis;
          factors[used++] = value;
        }
      }
    };
    add(side.a, side.along_a);
    add(side.b, side.along_b);
    return used;
  };
  for (std::size_t s = 0; s < count; ++s) {
    const std::uint32_t used = gather(island.sides[s]);
    for (std::uint32_t k = 0; k < used; ++k)
      island.response[s / lanes * unknowns + slots[k]].of[s % lanes] += factors[k];
  }
  const simd::KktView view = linkage.plan().view(island.state->factors);
  for (std::size_t batch = 0; batch < batches; ++batch)
    kernels_->solve(view, island.response[batch * unknowns].of);
  for (std::size_t s = 0; s < count; ++s) {
    const std::uint32_t used = gather(island.sides[s]);
    for (std::size_t batch = 0; batch < batches; ++batch)
      kernels_->combine(island.response[batch * unknowns].of, slots, factors, used,
                        island.coupling[s * batches + batch].of);
  }
}

void GroupStepper::see(Island& island, std::span<const Vec3> motion) {
  double* const speed = island.speed.front().of;
  for (std::size_t s = 0; s < island.sides.size(); ++s) {
    const Side& side = island.sides[s];
    speed[s] = dot_with(side.a, side.along_a, motion) + dot_with(side.b, side.along_b, motion);
  }
}

double GroupStepper::see(const Row& row) {
  double out = row.end[0].speed[row.end[0].side];
  if (row.ends == 2) out += row.end[1].speed[row.end[1].side];
  return out;
}

void GroupStepper::push(const Row& row, double by) {
  if (by == 0) return;
  for (std::uint32_t i = 0; i < row.ends; ++i) {
    const End& end = row.end[i];
    kernels_->add_three(end.speed, by, end.coupling, 0, end.coupling, 0, end.coupling, end.padded);
    end.push[end.side] += by;
  }
}

void GroupStepper::push(const Row& first, double by0, double by1, double by2) {
  for (std::uint32_t i = 0; i < first.ends; ++i) {
    const End& end = first.end[i];
    kernels_->add_three(end.speed, by0, end.coupling, by1, end.coupling + end.padded, by2,
                        end.coupling + 2 * end.padded, end.padded);
    end.push[end.side] += by0;
    end.push[end.side + 1] += by1;
    end.push[end.side + 2] += by2;
  }
}

/// What has been pushed since, onto a motion.
void GroupStepper::apply(Island& island, std::span<Vec3> motion) {
  const Linkage& linkage = *island.state->linkage;
  const std::uint32_t unknowns = linkage.plan().unknowns();
  island.sum.assign(unknowns, Lanes{});
  for (std::size_t batch = 0; batch < island.batches(); ++batch) {
    kernels_->accumulate(island.sum.front().of, island.push[batch].of, island.response[batch * unknowns].of,
                         unknowns);
    island.push[batch] = {};
  }
  const auto total = [&](std::uint32_t slot) {
    double out = 0;
    for (const double each : island.sum[slot].of) out += each;
    return out;
  };
  for (std::uint32_t k = 0; k < linkage.movable(); ++k) {
    const std::uint32_t slot = linkage.slot(k);
    motion[k] += {total(slot), total(slot + 1), total(slot + 2)};
  }
}

namespace {

/// Shortens (a, b) to `most`.
void into_disk(double& a, double& b, double most) {
  const double square = a * a + b * b;
  if (square <= most * most) return;
  const double by = most / std::sqrt(square);
  a *= by;
  b *= by;
}

}  // namespace

// The contact's three rows at once: into the cone from where their own responses lead. Both sweeps return
// the largest change that they made, in m or m/s.
double GroupStepper::sweep_positions() {
  double worst = 0;
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    Row& row = rows_[r];
    const double u = see(row);
    double p = 0;
    switch (row.kind) {
      case Kind::normal: {
        const double normal = std::max(0.0, row.p - row.over * (u + row.gap));
        if (normal > 0 || row.p > 0) worst = std::max(worst, contact(r, &Row::p, normal, row.bound * normal));
        r += 2;
        continue;
      }
      case Kind::sliding:
        continue;
      case Kind::limit:
        p = std::max(0.0, row.p - row.over * (u + row.gap));
        break;
      case Kind::drive:
        p = row.p - row.over * (u + row.softness * row.p + row.gap);
        break;
      case Kind::brake:
        p = std::clamp(row.p - row.over * u, -row.bound, row.bound);
        break;
    }
    const double by = p - row.p;
    row.p = p;
    push(row, by);
    worst = std::max(worst, std::abs(by) * row.own);
  }
  return worst;
}

double GroupStepper::sweep_velocities() {
  double worst = 0;
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    Row& row = rows_[r];
    const bool brakes = row.kind == Kind::brake;
    if (!brakes && (row.p <= 0 || (row.kind != Kind::normal && row.kind != Kind::limit))) continue;
    const double q = brakes ? std::clamp(row.q - row.over * see(row), -row.bounce, row.bounce)
                            : std::max(0.0, row.q - row.over * (see(row) - row.bounce));
    if (row.kind == Kind::normal) {
      worst = std::max(worst, contact(r, &Row::q, q, row.bound * q));
      r += 2;
      continue;
    }
    const double by = q - row.q;
    row.q = q;
    push(row, by);
    worst = std::max(worst, std::abs(by) * row.own);
  }
  return worst;
}

/// Gives the contact whose rows start at `r` a normal push and, within `most`, what keeps it from sliding.
double GroupStepper::contact(std::size_t r, double Row::*of, double normal, double most) {
  Row &n = rows_[r], &s = rows_[r + 1], &t = rows_[r + 2];
  const double by0 = normal - n.*of;
  // The normal push moves the others, too.
  const double u1 = see(s) + by0 * n.across[0], u2 = see(t) + by0 * n.across[1];
  double first = s.*of - s.over * u1, second = t.*of - t.over * u2;
  into_disk(first, second, most);
  const double by1 = first - s.*of, by2 = second - t.*of;
  n.*of = normal;
  s.*of = first;
  t.*of = second;
  push(n, by0, by1, by2);
  return std::max({std::abs(by0) * n.own, std::abs(by1) * s.own, std::abs(by2) * t.own});
}

bool GroupStepper::solve_positions(StepReport& report) {
  for (std::uint32_t i = 0; i < count_; ++i) {
    Island& island = islands_[i];
    if (!island.sides.empty()) see(island, island.d);
  }
  for (Row& row : rows_) {
    const double warm = row.p;
    push(row, warm);
  }
  double last = INFINITY;
  int sweeps = 0;
  for (int correction = 0; correction < most_corrections; ++correction) {
    double left = 0;
    if (!rows_.empty()) {
      const int most = correction == 0 ? most_sweeps : most_sweeps / 4;
      int taken = 0;
      do left = sweep_positions();
      while (++taken < most && left > still_);
      sweeps += taken;
    }
    double worst = 0;
    for (std::uint32_t i = 0; i < count_; ++i) {
      Island& island = islands_[i];
      if (!island.awake) continue;
      LinkageState& state = *island.state;
      const Linkage& linkage = *state.linkage;
      if (!island.sides.empty()) apply(island, island.d);
      for (std::size_t k = 0; k < state.x.size(); ++k) island.there[k] = state.x[k] + island.d[k];
      if (linkage.constraints() == 0) continue;
      std::fill(island.right.begin(), island.right.end(), 0.0);
      const double violation = linkage.violations(island.there, island.right);
      worst = std::max(worst, violation);
      if (violation <= exact) continue;
      if (!std::isfinite(violation)) return false;
      ++report.newton;
      linkage.plan().solve(state.factors, island.right);
      for (std::uint32_t k = 0; k < linkage.movable(); ++k) {
        const double* at = &island.right[linkage.slot(k)];
        island.d[k] += {at[0], at[1], at[2]};
        island.there[k] = state.x[k] + island.d[k];
      }
      if (!island.sides.empty()) see(island, island.d);
    }
    if (worst <= exact &&
        (left <= 10 * still_ || (correction + 1 >= most_corrections / 2 && left <= too_much))) {
      report.block_sweeps += static_cast<std::uint64_t>(sweeps);
      return true;
    }
    if (worst > 0.5 || (correction > 3 && worst > exact && worst > 0.9 * last)) return false;
    last = worst;
  }
  return false;
}

// Of Island::impulse and what its sides push, along the constraints where the island is now.
void GroupStepper::find_velocities(Island& island) {
  const LinkageState& state = *island.state;
  const Linkage& linkage = *state.linkage;
  linkage.anchor_rates(state.x, state.v, island.right);
  for (std::uint32_t k = 0; k < linkage.movable(); ++k) {
    double* const at = &island.right[linkage.slot(k)];
    at[0] = island.impulse[k].x;
    at[1] = island.impulse[k].y;
    at[2] = island.impulse[k].z;
  }
  const auto add = [&](const Combination& sum, Vec3 by) {
    for (std::uint32_t k = 0; k < sum.count; ++k) {
      if (sum.terms[k].particle >= linkage.movable()) continue;
      double* const at = &island.right[linkage.slot(sum.terms[k].particle)];
      at[0] += sum.terms[k].weight * by.x;
      at[1] += sum.terms[k].weight * by.y;
      at[2] += sum.terms[k].weight * by.z;
    }
  };
  for (std::size_t s = 0; s < island.sides.size(); ++s) {
    const double by = island.push.front().of[s];
    if (by == 0) continue;
    add(island.sides[s].a, by * island.sides[s].along_a);
    add(island.sides[s].b, by * island.sides[s].along_b);
  }
  linkage.plan().solve(state.factors, island.right);
  for (std::uint32_t k = 0; k < linkage.movable(); ++k) {
    const double* at = &island.right[linkage.slot(k)];
    island.v[k] = {at[0], at[1], at[2]};
  }
}

void GroupStepper::finish(double h, bool touched) {
  for (std::uint32_t i = 0; i < count_; ++i) {
    Island& island = islands_[i];
    if (!island.awake) continue;
    LinkageState& state = *island.state;
    const Linkage& linkage = *state.linkage;
    std::swap(state.x, island.there);  // there: where it was
    for (std::uint32_t k = 0; k < linkage.movable(); ++k) island.v[k] = (1 / h) * island.d[k];
    factor(state);
    if (linkage.has_air()) linkage.forces(state.x, island.v, state.force, h, island.force);
    island.impulse.resize(linkage.movable());
    linkage.momenta(island.v, island.impulse);
    for (std::uint32_t k = 0; k < linkage.movable(); ++k) island.impulse[k] += (0.5 * h) * island.force[k];
    std::fill(island.push.begin(), island.push.end(), Lanes{});
    if (island.sides.empty() || !touched) find_velocities(island);
  }
}

// Pushes act along the constraints where the islands are now; the responses of where they were only lead
// there, in a few rounds.
void GroupStepper::bounce(double h) {
  // At rest what pushes in the second half of a substep is what pushed in the first.
  for (Row& row : rows_) {
    const bool lasts = row.kind != Kind::drive && row.kind != Kind::brake && row.bounce == 0;
    row.q = lasts ? 0.5 / h * row.p : 0;
    push(row, row.q);
  }
  const double enough = still_ / h;
  for (int round = 0; round < most_rounds; ++round) {
    for (std::uint32_t i = 0; i < count_; ++i) {
      Island& island = islands_[i];
      if (island.sides.empty()) continue;
      find_velocities(island);
      see(island, island.v);
    }
    double left = sweep_velocities();
    if (left <= enough) return;
    for (int i = 1; i < most_sweeps && left > enough; ++i) left = sweep_velocities();
  }
  for (std::uint32_t i = 0; i < count_; ++i)
    if (!islands_[i].sides.empty()) find_velocities(islands_[i]);
}

void GroupStepper::brake(Island& island, double h) {
  const Linkage& linkage = *island.state->linkage;
  if (linkage.drag() != 0) {
    const double kept = std::exp(-0.5 * h * linkage.drag());
    for (std::uint32_t k = 0; k < linkage.movable(); ++k) island.v[k] = kept * island.v[k];
  }
  if (linkage.joint_drag() == 0 || (linkage.movable() == 1 && !linkage.is_grounded())) return;
  const double kept = std::exp(-h * linkage.joint_drag());
  island.rigid.assign(linkage.movable(), Vec3{});
  if (!linkage.is_grounded()) linkage.split(island.state->x, island.v, island.rigid);
  for (std::uint32_t k = 0; k < linkage.movable(); ++k)
    island.v[k] = island.rigid[k] + kept * (island.v[k] - island.rigid[k]);
}

double GroupStepper::energy() const {
  double sum = 0;
  for (std::uint32_t i = 0; i < count_; ++i) {
    const Island& island = islands_[i];
    if (!island.awake) continue;
    const LinkageState& state = *island.state;
    sum += state.linkage->kinetic(state.v) + state.linkage->potential(state.x, state.force);
  }
  return sum;
}

// Energy is that of the states with their new velocities still apart, in Island::v. False if there is not as
// much motion as energy was gained: something was lifted. If no shorter substep is to be tried, all stops.
bool GroupStepper::guard_energy(double before, bool touched, bool can_shorten, StepReport& report) {
  double now = 0, moving = 0, weight = 0;  // J; weight: what it takes to lift all by its size
  bool free = count_ == 1 && !touched, driven = false;
  for (std::uint32_t i = 0; i < count_; ++i) {
    const Island& island = islands_[i];
    if (!island.awake) continue;
    const LinkageState& state = *island.state;
    const double kinetic = state.linkage->kinetic(island.v);
    moving += kinetic;
    weight += state.linkage->mass() * norm(state.linkage->gravity()) * state.linkage->size();
    now += kinetic + state.linkage->potential(state.x, state.force);
    free = free && !state.linkage->has_air();
    driven = driven || state.linkage->has_drives();
    for (std::size_t k = state.linkage->movable(); k < state.v.size(); ++k)
      driven = driven || state.v[k] != Vec3{};
  }
  for (std::uint32_t i = 0; i < count_; ++i)
    if (!free || driven) islands_[i].state->energy.reset();
  if (driven || moving == 0) return true;
  LinkageState& first = *islands_[0].state;
  if (free && !first.energy) first.energy = before;
  const double wanted = free ? *first.energy : before;
  double excess = now - wanted;
  if (!free && excess <= 0) return true;
  if (std::abs(excess) <= 1e-15 * std::abs(now)) return true;
  if (excess > 0) ++report.guarded_energy;

  // Of the motion that is not a rigid whole's, then, if that is not enough, of all.
  double loose = 0;
  for (std::uint32_t i = 0; i < count_; ++i) {
    Island& island = islands_[i];
    if (!island.awake) continue;
    const Linkage& linkage = *island.state->linkage;
    island.rigid.assign(linkage.movable(), Vec3{});
    if (linkage.is_grounded())
      loose += linkage.kinetic(island.v);
    else if (linkage.movable() > 1)
      loose += linkage.split(island.state->x, island.v, island.rigid);
    else
      island.rigid[0] = island.v[0];
  }
  const auto scale = [&](double square, bool all) {
    const double by = std::sqrt(square);
    for (std::uint32_t i = 0; i < count_; ++i) {
      Island& island = islands_[i];
      if (!island.awake) continue;
      for (std::uint32_t k = 0; k < island.state->linkage->movable(); ++k) {
        const Vec3 rigid = all ? Vec3{} : island.rigid[k];
        island.v[k] = rigid + by * (island.v[k] - rigid);
      }
    }
  };
  const double square = 1 - excess / loose;
  if (square >= 0.25 && square <= 1.5) {
    scale(square, false);
  } else if (excess > (free ? let_be * moving : 0)) {
    if (can_shorten && excess > moving + unnoticed * weight) return false;
    scale(std::max(0.0, 1 - excess / moving), true);
  }
  return true;
}

void GroupStepper::keep_contacts(double h) {
  for (std::uint32_t i = 0; i < count_; ++i) islands_[i].state->kept.clear();
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const Row& row = rows_[r];
    if (row.kind == Kind::sliding || row.p == 0) continue;
    Island& island = islands_[row.island[0]];
    Vec3 force{row.p, 0, 0};
    if (row.kind == Kind::normal)
      force = row.p * island.sides[row.side[0]].along_a +
              rows_[r + 1].p * island.sides[rows_[r + 1].side[0]].along_a +
              rows_[r + 2].p * island.sides[rows_[r + 2].side[0]].along_a;
    island.state->kept.push_back({row.key, (1 / (h * h)) * force});
  }
}

}  // namespace plumb::detail
