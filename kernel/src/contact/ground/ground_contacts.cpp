#include "contact/ground/ground_contacts.hpp"

#include <algorithm>
#include <cmath>

#include "contact/rows.hpp"

namespace plumb::detail {
namespace {

/// The stiffness of a contact is so many times the mass of its heaviest particle. A larger one needs fewer
/// steps where much rests on little, and rounds more.
constexpr double stiffness_over_mass = 1e4;
/// Its grip is so many times that mass.
constexpr double grip_over_mass = 1e3;
/// Where contacts are new, they grip by that mass alone at first, and more firmly by this factor once pushes
/// lack less than this share.
constexpr double firmer = 30, enough_to_grip = 0.1, loose = 1 / grip_over_mass;
/// Slopes that differ by less than this share do not need a new factorisation.
constexpr double stale = 0.05;
/// A push that moves its place by less than this share of the island's largest rod is rounding.
constexpr double residual_rounding = 1e-13;
/// A correction is taken whole if it leaves pushes to lack no more than this share of what they did.
constexpr double better = 0.7;
/// Pushes count as lacking by this share until the grip is whole, so that no looser one is taken for a
/// solution.
constexpr double loose_lack = 1e-3;
/// Pushes that lack no more than this share may start anew from what they are, so often in a solution, if
/// what they started from was larger by this share of the largest.
constexpr double settled_enough = 1e-7, let_go = 0.1;
constexpr int most_settlements = 3;
/// A search is worth its while if the slope at the end of a correction is this share of that at its start,
/// and ends where it is below this share.
constexpr double worth_search = 0.5, flat_enough = 0.2;
/// A search along a correction ends after so many cuts.
constexpr int most_shortenings = 12;

double size_of(const Sym3& m) {
  return std::max(
      {std::abs(m.xx), std::abs(m.yy), std::abs(m.zz), std::abs(m.xy), std::abs(m.xz), std::abs(m.yz)});
}

/// Returns whether the slope in the matrix leads astray, along the unit vector n and across it. The two parts
/// are far apart in size, and what holds against sliding matters next to masses.
bool leads_astray(const Sym3& slope, const Sym3& next, Vec3 n, double mass) {
  const double along = dot(n, slope * n), along_next = dot(n, next * n);
  if ((along > 0) != (along_next > 0) || along_next > 2 * along) return true;
  const Sym3 across = slope - outer(along, n), across_next = next - outer(along_next, n);
  const double least = std::min(size_of(across), size_of(across_next));
  return size_of(across_next - across) > stale * (mass + least);
}

}  // namespace

const GroundContact::More GroundContact::no_more{};

GroundContacts::Wanted GroundContacts::wanted(const Row& row, Vec3 moved_to) const {
  const Vec3 at = moved_to - row.carried, n = row.contact.normal;
  const double held_along = dot(row.held, n), along = dot(at, n);
  return {held_along - stiffness_ * row.mass * (along + row.gap),
          row.held - held_along * n - grip_ * row.mass * (at - along * n)};
}

auto GroundContacts::state_at(const Row& row, Vec3 at) const -> State {
  const auto [normal, across] = wanted(row, at);
  if (row.is_open || !(normal > 0)) return State::open;
  return dot(across, across) <= row.bound * row.bound ? State::sticks : State::slides;
}

Vec3 GroundContacts::law_at(const Row& row, Vec3 at, State as) const {
  const auto [normal, across] = wanted(row, at);
  if (as == State::open) return {};
  return normal * row.contact.normal + (as == State::sticks ? 1 : row.bound / norm(across)) * across;
}

Sym3 GroundContacts::slope_at(const Row& row, Vec3 at, State as) const {
  if (as == State::open) return {};
  const double stiffness = stiffness_ * row.mass, grip = grip_ * row.mass;
  const Sym3 along = outer(1, row.contact.normal);
  if (as == State::sticks) return stiffness * along + grip * (Sym3::diagonal(1) - along);
  const Vec3 across = wanted(row, at).across;
  const double size = norm(across);
  return stiffness * along +
         (grip * row.bound / size) * (Sym3::diagonal(1) - along - outer(1 / (size * size), across));
}

void GroundContacts::clear() {
  rows_.clear();
  more_.clear();
  terms_.clear();
  answering_.clear();
}

void GroundContacts::add(const GroundContact& contact, double heaviest) {
  Row& row = rows_.add();
  row.contact = contact;
  row.contact.at = terms_.keep(contact.at);
  if (contact.more != &GroundContact::no_more) row.contact.more = &(more_.add() = *contact.more);
  row.mass = heaviest;
}

void GroundContacts::begin(Row& row, double gap, Vec3 held, bool is_open) {
  row.gap = gap;
  row.held = row.push = row.law = held;
  row.is_open = is_open;
  row.bound = 0;
  row.moved = {};
}

void GroundContacts::grip() {
  stiffness_ = ease_ * stiffness_over_mass;
  grip_ = (is_loose_ ? loose : ease_) * grip_over_mass;
}

void GroundContacts::begin_grip() {
  bool all_held = true;
  for (const Row& row : rows_) all_held = all_held && row.contact.is_held;
  ease_ = all_held && !is_loose_ ? 1 : loose;
  lack_ = 1;
  settlements_ = settles_ ? most_settlements : 0;
  grip();
}

void GroundContacts::begin_positions(bool is_loose, bool settles) {
  is_loose_ = is_loose;
  settles_ = settles;
  begin_grip();
  for (Row& row : rows_) {
    row.position = {};
    row.carried = row.contact.more->carried;
    begin(row, row.contact.gap, row.contact.held, false);
  }
}

void GroundContacts::begin_velocities() {
  begin_grip();
  for (Row& row : rows_) {
    row.position = row.push;
    row.carried = row.contact.more->carried_at_end;
    begin(row, -row.contact.bounce, row.contact.held_end, row.position == Vec3{});
  }
}

/// Returns where a line at x is close to round ground, which has moved by `carried` (m).
Touch GroundContacts::near_round(const LinkageState& state, const GroundContact& contact,
                                 std::span<const Vec3> x, Vec3 carried) {
  const Linkage::Shape& shape = state.linkage->shape_of(contact.shape);
  return touch({shape.a.of(x) - carried, shape.b.of(x) - carried, shape.radius}, *contact.more->round);
}

void GroundContacts::follow_gaps(const LinkageState& state, std::span<const Vec3> there) {
  for (Row& row : rows_) {
    const GroundContact& contact = row.contact;
    if (!contact.more->round) continue;
    const Vec3 moved = contact.at.of(there) - contact.at.of(state.x) - row.carried;
    const double taken_straight = contact.more->apart + dot(contact.normal, moved);
    row.gap = contact.gap + near_round(state, contact, there, row.carried).gap - taken_straight;
  }
}

void GroundContacts::follow_round(const LinkageState& state) {
  for (Row& row : rows_) {
    GroundContact& contact = row.contact;
    if (!contact.more->round) continue;
    const Linkage::Shape& shape = state.linkage->shape_of(contact.shape);
    const Touch near = near_round(state, contact, state.x, {});
    if (!(near.a > 0 && near.a < 1)) continue;
    contact.at = terms_.keep(blend(shape.a, shape.b, near.a));
    contact.normal = near.normal;
  }
}

void GroundContacts::look(const Linkage& linkage, std::span<const Vec3> motion, bool bounds_follow) {
  const bool firms = lack_ < enough_to_grip && ease_ < 1;
  for (Row& row : rows_) {
    row.moved = row.contact.at.of(motion);
    if (bounds_follow) {
      row.bound = row.contact.friction * std::max(0.0, dot(row.push, row.contact.normal));
    }
    row.state = state_at(row, row.moved);
  }
  // What sticks, slides and is open with a looser grip is expected to do so with a firmer one.
  if (firms) {
    ease_ = std::min(1.0, firmer * ease_);
    grip();
  }
  find_laws(linkage);
  if (lack_ > settled_enough || settlements_ == 0 || !springs_back()) return;
  // What they start from pushes too much: they start anew from what they push by.
  --settlements_;
  for (Row& row : rows_) {
    row.held = row.push;
    row.state = state_at(row, row.moved);
  }
  find_laws(linkage);
}

/// Returns whether something that was held more firmly a substep ago is lifted by what its contact yielded.
bool GroundContacts::springs_back() const {
  double most = 0, back = 0;
  for (const Row& row : rows_) {
    most = std::max(most, norm(row.push));
    back = std::max(back, norm(row.held) - norm(row.push));
  }
  return back > let_go * most;
}

void GroundContacts::find_laws(const Linkage& linkage) {
  double most = 0, most_lack = 0, stiffest = 0;
  is_stale_ = false;
  for (Row& row : rows_) {
    row.law = law_at(row, row.moved, row.state);
    stiffest = std::max(stiffest, stiffness_ * row.mass);
    most = std::max(most, norm(row.law));
    most_lack = std::max(most_lack, norm(row.law - row.push));
    is_stale_ = is_stale_ || leads_astray(row.slope, slope(row), row.contact.normal, row.mass);
  }
  const double least = residual_rounding * linkage.size() * stiffest;
  lack_ = most_lack <= least ? 0 : most_lack / std::max(most, most_lack);
  if (ease_ < 1) lack_ = std::max(lack_, loose_lack);
}

bool GroundContacts::factor(LinkageState& state) {
  for (Row& row : rows_) {
    row.slope = slope(row);
    if (row.slope.xx + row.slope.yy + row.slope.zz > 0)
      state.linkage->stiffen(row.contact.at, row.slope, state.factors);
  }
  return state.linkage->plan().factor(state.factors);
}

template <class Push>
void GroundContacts::add(const Linkage& linkage, std::span<double> right, Push&& push) const {
  for (const Row& row : rows_) {
    const Vec3 by = push(row);
    if (by != Vec3{}) linkage.add(row.contact.at, by, right);
  }
}

void GroundContacts::add_pushes(const Linkage& linkage, std::span<const Vec3> motion,
                                std::span<double> right) const {
  add(linkage, right, [&](const Row& row) {
    return row.law + row.slope * (row.moved - linkage.of_fixed(row.contact.at, motion));
  });
}

void GroundContacts::add_lack(const Linkage& linkage, std::span<double> right) const {
  add(linkage, right, [](const Row& row) { return row.law - row.push; });
}

void GroundContacts::follow_solution(std::span<const Vec3> motion) {
  for (Row& row : rows_) {
    const Vec3 moved = row.contact.at.of(motion);
    row.push = row.law - row.slope * (moved - row.moved);
    row.moved = moved;
  }
}

void GroundContacts::keep_slopes() {
  answering_.clear();
  for (const Row& row : rows_) answering_.push_back(row.slope);
}

void GroundContacts::follow_change(std::span<const Vec3> motion) {
  auto answering = answering_.begin();
  for (Row& row : rows_) {
    const Vec3 moved = row.contact.at.of(motion);
    if (answering != answering_.end()) row.push = row.push - *answering++ * (moved - row.moved);
    row.moved = moved;
  }
}

void GroundContacts::aim(std::span<const Vec3> correction) {
  for (Row& row : rows_) row.correction = row.contact.at.of(correction);
}

double GroundContacts::share_of(double inertia) const {
  double now = 0, then = 0;
  for (const Row& row : rows_) {
    const Vec3 whole = row.law - row.slope * row.correction;
    now = std::max(now, norm(row.law - row.push));
    then = std::max(then, norm(law_at(row, row.moved + row.correction) - whole));
  }
  if (then <= better * now) return 1;
  // The derivative of what is minimised, along the correction.
  const auto slope = [&](double share) {
    double sum = share * inertia;
    for (const Row& row : rows_)
      sum += dot(row.correction, row.push - law_at(row, row.moved + share * row.correction));
    return sum;
  };
  const double at_start = slope(0);
  if (!(at_start < 0)) return 1;
  double low = 0, high = 1, at_low = at_start, at_high = slope(1);
  if (!(at_high > worth_search * std::abs(at_start))) return 1;
  for (int cut = 0; cut < most_shortenings; ++cut) {
    const double middle =
        cut % 2 == 0 ? low - at_low * (high - low) / (at_high - at_low) : 0.5 * (low + high);
    const double there = slope(middle);
    if (std::abs(there) <= flat_enough * std::abs(at_start)) return middle;
    (there < 0 ? low : high) = middle;
    (there < 0 ? at_low : at_high) = there;
  }
  return high;
}

void GroundContacts::take(double share) {
  for (Row& row : rows_) {
    row.push += share * (row.law - row.push - row.slope * row.correction);
    row.moved += share * row.correction;
  }
}

std::size_t GroundContacts::count_pushes() const {
  std::size_t count = 0;
  for (const Row& row : rows_) count += row.push != Vec3{} ? 1 : 0;
  return count;
}

}  // namespace plumb::detail
