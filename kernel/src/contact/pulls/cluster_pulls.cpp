// This file adds up what holds and pushes a cluster's islands in a substep.

#include <cmath>
#include <utility>

#include "contact/solved/cluster_stepper.hpp"

namespace plumb::detail {

/// Returns the impulses (N s or N m s) with which an elastic that acts pulled at the start and at the end.
std::array<double, 2> ClusterStepper::impulses_of(const Island& island, std::size_t elastic, double h) {
  const ElasticStep& step = island.elastics[elastic];
  const bool is_held = step.soft_at_end() >= 0;
  const double end = is_held ? island.end_pulls[island.state->linkage->constraints() + elastic] : 0;
  return {-step.p / h, end - step.end_push};
}

std::uint32_t ClusterStepper::break_rods(Island& island, double h) {
  LinkageState& state = *island.state;
  if (state.broken.empty()) return 0;
  const Linkage& linkage = *state.linkage;
  island.by_bends.assign(state.broken.size(), 0);
  for (const BendElastics& bend : linkage.bends())
    for (std::size_t i = bend.first; i < bend.first + bend.count; ++i) {
      if (!island.elastics[i].acts) continue;
      const Elastic& elastic = linkage.elastics()[i];
      const auto [start, end] = impulses_of(island, i, h);
      const auto add = [&](std::span<const Vec3> x, double impulse) {
        const Vec3 pull = impulse * linkage.slope(elastic, x)[0];
        for (const AlongRod& each : along_rods(bend, elastic.sums[0], x, pull))
          if (const auto at = each.rod ? linkage.elastic_of_rod(*each.rod) : std::nullopt)
            island.by_bends[*at] += each.pull;
      };
      add(island.theta > 0 ? island.at : island.there, start);
      add(state.x, end);
    }
  return state.break_rods([&](std::size_t i) {
    const auto [start, end] = impulses_of(island, i, h);
    return island.elastics[i].acts ? (start + end + island.by_bends[i]) / h : 0;
  });
}

void ClusterStepper::find_overload() {
  overload_ = {};
  double most = 1;
  for (std::uint32_t i = 0; i < count_; ++i) {
    const Island& island = islands_[i];
    for (std::size_t k = 0; island.awake && k < island.state->broken.size(); ++k) {
      const ElasticStep& step = island.elastics[k];
      const double share = -step.p / (step.kick * island.state->laws[k].strength);
      if (!step.acts || !std::isfinite(share) || share <= most) continue;
      most = share;
      overload_ = {island.state, k};
    }
  }
}

bool ClusterStepper::break_overload(Tally& report) {
  if (overload_.state == nullptr) return false;
  overload_.state->break_rod(overload_.rod);
  overload_ = {};
  ++report.broken_rods;
  return true;
}

/// Adds what constraints and elastics pulled with. Island::there is where the substep began, and the state
/// has still the velocities from then.
void ClusterStepper::count_pulls(Island& island, double h) const {
  LinkageState& state = *island.state;
  const Linkage& linkage = *state.linkage;
  const std::span<const Vec3> along = island.theta > 0 ? island.at : island.there;
  state.lengths.begin_pulls(state.pulls.rods);
  linkage.count_pulls(along, state.lengths.squares(), island.pulls, (island.theta == 0.5 ? 2 : 1) / h,
                      state.pulls);
  linkage.count_pulls(state.x, state.lengths.squares(), island.end_pulls, 1, state.pulls);
  state.lengths.end_pulls(state.pulls.rods);
  linkage.count_wave_pulls(state.wave_inertia, state.waves_at_start(), state.v, island.v, state.pulls);
  for (std::size_t i = 0; i < state.laws.size(); ++i) {
    if (!island.elastics[i].acts) continue;
    const auto [start, end] = impulses_of(island, i, h);
    linkage.count_pull(i, along, start, state.pulls);
    linkage.count_pull(i, state.x, end, state.pulls);
  }
  const auto near = [&](std::size_t i) { return island.elastics[i].start; };
  state.count_motors((island.theta == 1 ? 1 : 0.5) * h, island.there, near);
  if (island.theta == 0) state.count_motors(0.5 * h, state.x, near);
}

/// Adds what a contact, or a limit or the friction of an angle, pushed with.
void ClusterStepper::count_pushes(const Row& row, double h) {
  const double impulse = row.p / h + row.q;
  if (impulse == 0) return;
  const bool is_contact = row.kind == Kind::normal || row.kind == Kind::sliding;
  for (std::uint32_t i = 0; i < row.ends; ++i) {
    Island& island = islands_[row.island[i]];
    LinkagePulls& pulls = island.state->pulls;
    if (!pulls.counts) continue;
    const Side& side = island.sides[row.side[i]];
    if (is_contact)
      pulls.shapes[row.of[i]] += impulse * side.along_a;
    else if (!row.follows_normal())
      pulls.angles[row.of[i]] += row.of[1] != 0 ? -impulse : impulse;
    for (const auto& [sum, along] : {std::pair{side.a, side.along_a}, std::pair{side.b, side.along_b}}) {
      Combination at;
      for (std::uint32_t k = sum.first; k < sum.end; ++k)
        at.add(island.terms[k].particle, island.terms[k].weight);
      island.state->linkage->push_fixed(at, impulse * along, pulls);
    }
  }
}

/// Keeps where a contact is whose rows are about to be added, if that counts.
void ClusterStepper::note_touch(const GroundContact& contact, std::span<const ContactEnd> ends) {
  if (!islands_[ends[0].island].state->pulls.touched.counts) return;
  RowsTouch& touch = touches_.emplace_back();
  touch.row = static_cast<std::uint32_t>(rows_.size());
  touch.ends = static_cast<std::uint32_t>(ends.size());
  touch.other = contact.other;
  touch.approach = contact.approach;
  for (std::uint32_t i = 0; i < touch.ends; ++i) {
    touch.at[i] = ends[i].at;
    touch.radius[i] = islands_[ends[i].island].state->linkage->shape_of(ends[i].shape).radius;
  }
}

/// Adds what a contact with rows pushed shapes with. It acts half way between them where the substep ends.
void ClusterStepper::count_touch(const RowsTouch& touch, double h) {
  const Row& normal = rows_[touch.row];
  Vec3 impulse{};
  for (std::uint32_t i = touch.row; i < touch.row + 3; ++i)
    impulse += (rows_[i].p / h + rows_[i].q) * rows_[i].along;
  const auto surface = [&](std::uint32_t i, double sign) {
    const LinkageState& state = *islands_[normal.island[i]].state;
    return touch.at[i].of(state.x) - sign * touch.radius[i] * normal.along;
  };
  const Vec3 place = touch.ends == 1 ? surface(0, 1) : 0.5 * (surface(0, 1) + surface(1, -1));
  islands_[normal.island[0]].state->pulls.touched.add(
      normal.of[0], touch.ends == 1 ? TouchedPair::ground : islands_[normal.island[1]].state->number,
      touch.other, {impulse, place, normal.along, touch.approach});
}

void ClusterStepper::count_pushes(double h) {
  for (const Row& row : rows_) count_pushes(row, h);
  for (const RowsTouch& touch : touches_) count_touch(touch, h);
  for (std::uint32_t i = 0; i < count_; ++i) {
    LinkageState& state = *islands_[i].state;
    if (!state.pulls.counts && !state.pulls.touched.counts) continue;
    islands_[i].ground.for_kept([&](const GroundContact& contact, Vec3 position, Vec3 end) {
      const Vec3 impulse = (1 / h) * position + end;
      if (state.pulls.counts) {
        state.pulls.shapes[contact.shape] += impulse;
        state.linkage->push_fixed(contact.at, impulse, state.pulls);
      }
      const double radius = state.linkage->shape_of(contact.shape).radius;
      const Vec3 place = contact.at.of(state.x) - radius * contact.normal;
      state.pulls.touched.add(contact.shape, TouchedPair::ground, contact.other,
                              {impulse, place, contact.normal, contact.approach});
    });
  }
}

}  // namespace plumb::detail
