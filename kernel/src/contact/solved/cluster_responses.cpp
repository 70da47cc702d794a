// This file finds how islands answer to pushes, and lets rods buckle that do not.

#include <algorithm>
#include <cmath>

#include "contact/levers/lever.hpp"
#include "contact/solved/cluster_limits.hpp"
#include "contact/solved/cluster_stepper.hpp"

namespace plumb::detail {
using namespace contact_limits;

namespace {

std::uint32_t padded(std::size_t batches) {
  return static_cast<std::uint32_t>(batches * simd::kkt_lanes);
}

}  // namespace

/// Finds answers of all islands, or of those alone whose factors are others. No pushes lie on their sides
/// then.
void ClusterStepper::find_responses(bool of_others_alone) {
  last_pushes_.resize(rows_.size());
  swept_from_.resize(rows_.size());
  if (is_wide_) return find_free_responses();
  for (std::uint32_t i = 0; i < count_; ++i)
    if (Island& each = islands_[i]; !each.sides.empty() && (each.answers_anew || !of_others_alone))
      couple(each);
  for (std::size_t r = rows_.size(); r-- > 0;) {
    Row& row = rows_[r];
    double own = 0, heaviest = 0, held = 0;
    row.across[0] = row.across[1] = 0;
    for (std::uint32_t i = 0; i < row.ends; ++i) {
      Island& island = islands_[row.island[i]];
      const std::uint32_t side = row.side[i];
      row.end[i] = {island.speed.front().of, island.push.front().of, island.row(side), side,
                    padded(island.batches())};
      own += row.end[i].coupling[side];
      heaviest = std::max(heaviest, island.state->linkage->mass());
      if (row.kind == Kind::normal || row.kind == Kind::sliding) held = std::max(held, island.held);
      if (row.kind != Kind::normal) continue;
      for (std::uint32_t axis = 0; axis < 2; ++axis) row.across[axis] += row.end[i].coupling[side + 1 + axis];
    }
    if (row.ends == 2 && row.island[0] == row.island[1]) own += couple_ends(row);
    row.own = own;
    row.over = own > std::max(held, held_response / heaviest) ? 1 / own : 0;
    if (row.kind != Kind::normal) continue;
    for (std::uint32_t axis = 0; axis < 2; ++axis) row.across[axis] *= rows_[r + 1 + axis].over;
  }
}

/// Finds answers again where ground or elastics hold islands otherwise than as they were found. Pushes
/// between islands and on ground would else come closer by a few percent in a correction. Returns whether
/// there are any.
bool ClusterStepper::renew_responses() {
  const auto is_other = [](const Island& each) { return !each.sides.empty() && each.answers_anew; };
  if (is_wide_ || std::none_of(islands_.begin(), islands_.begin() + count_, is_other)) return false;
  find_responses(true);
  return true;
}

/// Returns by how much the ends of a row within one island answer to each other, and adds what a normal push
/// takes from the rows of sliding so.
double ClusterStepper::couple_ends(Row& row) {
  const auto [one, two] = row.side;
  for (std::uint32_t axis = 0; row.kind == Kind::normal && axis < 2; ++axis)
    row.across[axis] += row.end[0].coupling[two + 1 + axis] + row.end[1].coupling[one + 1 + axis];
  return 2 * row.end[0].coupling[two];
}

/// Lists a side's unknowns, and the weights that they have in it.
ClusterStepper::SideUnknowns ClusterStepper::gather(const Island& island, const Side& side) {
  const Linkage& linkage = *island.state->linkage;
  SideUnknowns out;
  const auto add = [&](Sum sum, Vec3 along) {
    for (std::uint32_t k = sum.first; k < sum.end; ++k) {
      const auto [particle, weight] = island.terms[k];
      if (particle >= linkage.movable()) continue;
      const std::uint32_t slot = linkage.slot(particle);
      const double by[3] = {weight * along.x, weight * along.y, weight * along.z};
      for (std::uint32_t axis = 0; axis < 3; ++axis) {
        out.slots[out.used] = slot + axis;
        out.factors[out.used++] = by[axis];
      }
    }
  };
  add(side.a, side.along_a);
  add(side.b, side.along_b);
  return out;
}

/// Finds what every side of the island moves by when one side gets a push of one. Eight sides are solved
/// at once.
void ClusterStepper::couple(Island& island) {
  constexpr std::size_t lanes = simd::kkt_lanes;
  const KktPlan& plan = island.state->linkage->plan();
  const std::uint32_t unknowns = plan.unknowns();
  const std::size_t batches = island.batches(), count = island.sides.size();
  island.held = rounding * island.state->softness();
  island.keeps_responses = batches * unknowns <= most_kept_responses;
  const std::size_t kept = island.keeps_responses ? batches : 1;
  island.coupling.resize(count * batches);
  for (auto* const each : {&island.speed, &island.last_speed, &island.last_push}) each->resize(batches);
  island.push.assign(batches, Lanes{});
  for (std::size_t batch = 0; batch < batches; batch += kept) {
    island.response.assign(kept * unknowns, Lanes{});
    const std::size_t first = batch * lanes, end = std::min(count, first + kept * lanes);
    for (std::size_t s = first; s < end; ++s) {
      const SideUnknowns of = gather(island, island.sides[s]);
      Lanes* const response = &island.response[(s - first) / lanes * unknowns];
      for (std::uint32_t k = 0; k < of.used; ++k) response[of.slots[k]].of[s % lanes] += of.factors[k];
    }
    kernels_->solve_lanes(plan.pattern(), island.state->factors.data(), kept, island.response.front().of);
    for (std::size_t s = 0; s < count; ++s) {
      const SideUnknowns of = gather(island, island.sides[s]);
      kernels_->combine(island.response.front().of, unknowns, kept,
                        {of.slots.data(), of.factors.data(), of.used},
                        island.coupling[s * batches + batch].of);
    }
  }
  island.ground.keep_slopes();
  island.answers_anew = false;
}

/// Adds the pushes on an island's sides to the right hand side.
void ClusterStepper::add_pushes(Island& island) {
  const Linkage& linkage = *island.state->linkage;
  const std::span<double> right = island.right();
  const auto add = [&](Sum sum, Vec3 by) {
    for (std::uint32_t k = sum.first; k < sum.end; ++k) {
      const auto [particle, weight] = island.terms[k];
      if (particle >= linkage.movable()) continue;
      double* const at = &right[linkage.slot(particle)];
      at[0] += weight * by.x;
      at[1] += weight * by.y;
      at[2] += weight * by.z;
    }
  };
  for (std::size_t s = 0; s < island.sides.size(); ++s) {
    const double by = island.push[s / simd::kkt_lanes].of[s % simd::kkt_lanes];
    if (by == 0) continue;
    add(island.sides[s].a, by * island.sides[s].along_a);
    add(island.sides[s].b, by * island.sides[s].along_b);
  }
}

/// Adds up what pushes do by the response of each side.
void ClusterStepper::add_responses(Island& island) {
  const std::uint32_t unknowns = island.state->linkage->plan().unknowns();
  island.sum.assign(unknowns, Lanes{});
  for (std::size_t batch = 0; batch < island.batches(); ++batch)
    kernels_->accumulate(island.sum.front().of, island.push[batch].of, island.response[batch * unknowns].of,
                         unknowns);
  const std::span<double> right = island.right();
  for (std::uint32_t slot = 0; slot < unknowns; ++slot) {
    double total = 0;
    for (const double each : island.sum[slot].of) total += each;
    right[slot] = total;
  }
}

/// Finds what they do by one solve, where the responses were not kept.
void ClusterStepper::solve_pushes(Island& island) {
  const std::span<double> right = island.right();
  std::fill(right.begin(), right.end(), 0.0);
  add_pushes(island);
  island.state->linkage->plan().solve(island.state->factors, island.unknowns);
  island.ground.keep_slopes();
}

/// Adds to `motion` what the pushes since the last call have done, and clears them.
void ClusterStepper::apply(Island& island, std::span<Vec3> motion) {
  const Linkage& linkage = *island.state->linkage;
  island.keeps_responses ? add_responses(island) : solve_pushes(island);
  std::fill(island.push.begin(), island.push.end(), Lanes{});
  const std::span<const double> moved = island.right();
  for (std::uint32_t k = 0; k < linkage.movable(); ++k) motion[k] += linkage.taken(moved, k);
  for (std::uint32_t c = 0; c < island.pulls.size(); ++c)
    island.pulls[c] += moved[linkage.plan().position(3 * linkage.movable() + c)];
  for (std::size_t k = 0; k < island.elastics.size(); ++k)
    island.elastics[k].p -= moved[linkage.plan().position(linkage.elastics()[k].row)];
}

/// Looks for islands whose rods stand straight on what they touch and are driven into it, so that they are to
/// buckle, once in a step. Where no positions were found, rods of what is anchored may lean a little, and all
/// that touch are squeezed. Returns whether there are any.
bool ClusterStepper::find_buckling(bool is_found) {
  for (std::uint32_t i = 0; i < count_; ++i) islands_[i].buckles = false;
  if (is_buckled_) return false;
  for (const Row& row : rows_)
    if (is_driven_in(row))
      for (std::uint32_t k = 0; k < row.ends; ++k) islands_[row.island[k]].buckles = buckles_ = true;
  if (is_found || is_wide_) return buckles_;
  Answer all;
  for (std::uint32_t i = 0; i < count_; ++i) {
    const Answer one = answer(islands_[i], i);
    islands_[i].squeezed = islands_[i].state->linkage->is_grounded() && one.is_little();
    all.given += one.given;
    all.free += one.free;
  }
  for (std::uint32_t i = 0; i < count_ && all.is_little(); ++i)
    if (islands_[i].squeezed) islands_[i].buckles = buckles_ = true;
  return buckles_;
}

/// Returns what an island answers to all that pushes it where it touches, and free particles would answer.
ClusterStepper::Answer ClusterStepper::answer(Island& island, std::uint32_t i) const {
  const Linkage& linkage = *island.state->linkage;
  Array<Vec3>& push = island.impulse;  // which the end of a substep writes anew
  push.assign(linkage.movable(), Vec3{});
  Answer out;
  const auto for_sides = [&](auto&& f) {
    for (const Row& row : rows_)
      for (std::uint32_t k = 0; row.kind == Kind::normal && row.p > 0 && k < row.ends; ++k)
        if (row.island[k] == i) f(row.side[k], row.p);
  };
  for_sides([&](std::uint32_t one, double p) {
    add_push(island, island.sides[one], p, push);
    for_sides([&](std::uint32_t two, double q) { out.given += p * q * island.row(one)[two]; });
  });
  for (std::uint32_t k = 0; k < linkage.movable(); ++k)
    out.free += push[k] == Vec3{} ? 0 : dot(push[k], push[k]) / linkage.mass_of(k);
  return out;
}

/// Makes room below rods that stand straight on ground and are driven into it: they could buckle, but have no
/// direction to. Particles are nudged aside, always alike, by turns to both sides, and far enough for rods to
/// be as much shorter along the line as the substep asks for. That is done once in a step.
void ClusterStepper::buckle(std::span<LinkageState* const> cluster, const Surroundings& surroundings) {
  is_buckled_ = true;
  keep_motion(cluster);
  for (std::uint32_t i = 0; i < count_; ++i) {
    bool has_room = !islands_[i].buckles;
    for (double share = least_nudge; !has_room && share <= most_nudge; share *= wider)
      has_room = make_room(i, share, surroundings);
    if (!has_room) return return_to_motion(cluster);
  }
}

/// Nudges an island's particles aside by this share of its largest rod, if it is to buckle, or as far as all
/// its rods have to lean alike, and lifts what touches. Returns whether its rods fit to that, and little work
/// is done.
bool ClusterStepper::make_room(std::uint32_t i, double share, const Surroundings& surroundings) {
  Island& island = islands_[i];
  LinkageState& state = *island.state;
  state.return_to(before_[i]);
  island.there = state.x;
  projection_.holds.clear();
  Vec3 along{};
  double lean = 2 * share;  // the sine of the angle
  double highest = 0;       // m
  for (const Row& row : rows_)
    for (std::uint32_t k = 0; row.kind == Kind::normal && row.closes > still_ && k < row.ends; ++k) {
      if (row.island[k] != i || (row.over != 0 && row.p <= 0)) continue;
      const Side& side = island.sides[row.side[k]];
      Combination at;
      for (std::uint32_t t = side.a.first; t < side.a.end; ++t)
        at.add(island.terms[t].particle, island.terms[t].weight);
      const double lift = (row.closes - std::min(0.0, row.gap)) / row.ends;
      highest = std::max(highest, lift);
      projection_.holds.push_back({at, side.along_a, dot(side.along_a, at.of(state.x)) + lift});
      const double below = dot(side.along_a, state.x.back() - at.of(state.x));
      if (lift < below) lean = std::max(lean, std::sqrt(1 - (1 - lift / below) * (1 - lift / below)));
      along = side.along_a;
    }
  if (projection_.holds.empty()) return true;
  lean = std::min(lean, 2 * most_nudge);
  const Vec3 aside = (0.5 * lean * state.linkage->size()) * across(along).front(), last = state.x.back();
  const double nearer = 1 - std::sqrt(1 - lean * lean);
  for (std::uint32_t k = 0; k < state.linkage->movable(); ++k)
    state.x[k] += (k % 2 == 0 ? aside : -1 * aside) - (nearer * dot(along, state.x[k] - last)) * along;
  if (!bring_to_lengths(i, 0, surroundings)) return false;
  const double work =
      state.linkage->potential(state.x, state.force) - state.linkage->potential(before_[i].x, state.force);
  return std::abs(work) <=
         most_work_of_room * highest * state.linkage->mass() * norm(state.linkage->gravity());
}

/// Leans trees of rods faintly that have just landed exactly upright, so that a push moves them as one. They
/// stand as long as no rod leans, and have no direction to fall to.
void ClusterStepper::unbalance() {
  for (const Row& row : rows_) {
    if (row.kind != Kind::normal || row.p <= 0 || row.held || row.ends != 1 || is_wide_) continue;
    const Island& island = islands_[row.island[0]];
    LinkageState& state = *island.state;
    const Linkage& linkage = *state.linkage;
    const bool is_tree = linkage.rods() > 1 && linkage.rods() == linkage.constraints() &&
                         linkage.rods() + 1 == linkage.movable() && state.laws.empty();
    if (!is_tree || row.own > (1 + balanced) / linkage.mass() + island.held) continue;
    const auto [aside, aslant] = across(row.along);
    const double by = faint * linkage.size();
    for (std::uint32_t k = 0; k < linkage.movable(); ++k)
      state.x[k] += (k % 2 == 0 ? by : -by) * aside + (k % 4 < 2 ? by : -by) * aslant;
    state.factored = false;
  }
}

}  // namespace plumb::detail
