#include "contact/linkage/visitor.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace plumb::detail {
namespace {

/// A violation of constraints below this share of lengths is left to the substep, since it makes no velocity
/// that matters.
constexpr double unnoticed = 1e-9;
constexpr int most_corrections = 20;
/// Where a correction leaves no more than this share of what was violated, the next one is along the same
/// gradients: to factorise a net's matrix takes fifteen times as long as to solve with it.
constexpr double good_progress = 0.2;
/// Ground holds places by so many times the mass of their heaviest particle. What it leaves is that share of
/// what they would go without it.
constexpr double firm = 1e6;

/// Finds which rods that break or hang slack are among constraints where the island is: `acts` adds to them.
template <class Acts>
void take_up(const LinkageState& state, ProjectionWork& work, Acts&& acts) {
  for (std::size_t i = 0; i < state.laws.size(); ++i) {
    const ElasticLaw& law = state.laws[i];
    if (!std::isinf(law.stiffness) || work.acts[i] != 0) continue;
    work.acts[i] = !law.one_sided || acts(state.linkage->elastics()[i], law);
    work.is_new = work.is_new || work.acts[i] != 0;
  }
}

/// Writes by how much rods that act are off their lengths, times -1. Returns the largest share of a length.
double misfit_of_elastics(const LinkageState& state, ProjectionWork& work, std::span<double> right) {
  const Linkage& linkage = *state.linkage;
  take_up(state, work, [&](const Elastic& elastic, const ElasticLaw& law) {
    return linkage.number(elastic, state.x, law.rest) > (1 + unnoticed) * law.rest;
  });
  double worst = 0;
  for (std::size_t i = 0; i < state.laws.size(); ++i) {
    if (work.acts[i] == 0) continue;
    const Elastic& elastic = linkage.elastics()[i];
    const double off = linkage.number(elastic, state.x, state.laws[i].rest) - state.laws[i].rest;
    right[linkage.plan().position(elastic.row)] = -off;
    worst = std::max(worst, std::abs(off) / state.laws[i].rest);
  }
  return worst;
}

/// Factorises the matrix where the island is, with rods that act and what ground holds.
bool factor_with_holds(LinkageState& state, ProjectionWork& work) {
  if (std::exchange(work.is_new, false)) state.find_gives();
  if (work.holds.empty() && state.laws.empty()) return state.factor();
  state.assemble_with_elastics(state.x, [&](std::size_t i) { return work.acts[i] != 0 ? 0.0 : -1.0; });
  for (const Hold& hold : work.holds)
    state.linkage->stiffen(hold.at, outer(firm * state.linkage->heaviest(hold.at), hold.along),
                           state.factors);
  return state.linkage->plan().factor(state.factors);
}

/// Returns whether some velocity is not zero.
bool moves(std::span<const Vec3> velocities) {
  return std::any_of(velocities.begin(), velocities.end(), [](Vec3 v) { return v != Vec3{}; });
}

}  // namespace

IslandGradients::IslandGradients(const Settings& settings)
    : homeless(settings.method == Method::relax ? gradient_of(settings)
                                                : settings.gradient.value_or(Gradient::old)),
      visiting(settings.gradient.value_or(Gradient::mid) == Gradient::mid && !settings.accuracy &&
                       settings.method != Method::relax
                   ? Gradient::mid
                   : Gradient::old) {}

double Visitor::look(LinkageState& state) const {
  double fastest = home_->read(slots_, std::span(state.x).first(slots_.size()));
  for (const Vec3 anchor : std::span(state.v).subspan(slots_.size()))
    fastest = std::max(fastest, norm(anchor));
  return fastest + state.lengths.speed();
}

void Visitor::come(LinkageState& state, ProjectionWork* work) {
  look(state);
  state.lengths.follow_last();
  for (std::size_t k = 0; k < slots_.size(); ++k) state.v[k] = home_->velocity(slots_[k]);
  home_->set_away(slots_.front(), true);
  is_visiting_ = true;
  state.factored = false;
  state.kept.clear();
  state.forget_leftovers();
  state.leftovers.go_on(home_->past(slots_.front()).leftovers);
  state.energy.reset();
  std::fill(state.acceleration.begin(), state.acceleration.end(), Vec3{});
  if (work == nullptr) return;
  state.strain = project_positions(state, *work) <= most_left ? Strain::none : Strain::drawn;
  // Those of gradient mid have parts along rods that its next substep gives back.
  if (state.gradient != Gradient::mid || state.strain != Strain::none) project_velocities(state, *work);
}

void Visitor::leave(const LinkageState& state) {
  for (std::size_t k = 0; k < slots_.size(); ++k) home_->set_motion(slots_[k], state.x[k], state.v[k]);
  if (state.leftovers.any()) home_->go_on(slots_.front(), {.leftovers = state.leftovers});
  home_->set_away(slots_.front(), false);
  is_visiting_ = false;
}

double project_positions(LinkageState& state, ProjectionWork& work) {
  const Linkage& linkage = *state.linkage;
  if (linkage.constraints() == 0 && state.laws.empty()) return 0;
  work.acts.assign(state.laws.size(), 0);
  work.is_new = false;
  work.unknowns.assign(linkage.plan().columns(), simd::Quad{});
  const std::span<double> right = numbers(work.unknowns);
  work.before = state.x;
  double first = 0, last = 0;
  bool fits = false;
  for (int i = 0; i < most_corrections; ++i) {
    std::fill(right.begin(), right.end(), 0.0);
    const double violation = std::max(linkage.violations(state.x, state.lengths.squares(), right),
                                      misfit_of_elastics(state, work, right));
    if (i == 0) first = violation;
    fits = violation <= unnoticed && (i > 0 || work.holds.empty());
    if (fits || !std::isfinite(violation)) break;
    const bool is_stale = i == 0 || work.is_new || violation > good_progress * last;
    if (is_stale && !factor_with_holds(state, work)) break;
    // Where rods fit at first, only what is held is missed.
    last = violation <= unnoticed ? INFINITY : violation;
    for (const Hold& hold : work.holds) {
      const double lack = hold.least - dot(hold.along, hold.at.of(state.x));
      linkage.add(hold.at, (firm * linkage.heaviest(hold.at) * lack) * hold.along, right);
    }
    state.solve(work.unknowns);
    for (std::uint32_t k = 0; k < linkage.movable(); ++k) state.x[k] += linkage.taken(right, k);
  }
  state.factored = false;
  if (fits) return 0;
  state.x = work.before;
  return first;
}

double project_velocities(LinkageState& state, ProjectionWork& work) {
  const Linkage& linkage = *state.linkage;
  if (linkage.constraints() == 0 && state.laws.empty()) return 0;
  work.acts.assign(state.laws.size(), 0);
  take_up(state, work, [&](const Elastic& elastic, const ElasticLaw& law) {
    return linkage.number(elastic, state.x, law.rest) >= (1 - unnoticed) * law.rest &&
           Linkage::rate(elastic, linkage.slope(elastic, state.x), state.v, {0, linkage.particles()}) > 0;
  });
  work.holds.clear();
  factor_with_holds(state, work);
  work.momentum.resize(linkage.movable());
  work.unknowns.assign(linkage.plan().columns(), simd::Quad{});
  const std::span<double> right = numbers(work.unknowns);
  if (moves(std::span(state.v).subspan(linkage.movable())) || !state.lengths.changes().empty())
    state.rates(state.v, linkage.fixed_ones(), right);
  for (std::size_t i = 0; i < state.laws.size(); ++i) {
    const Elastic& elastic = linkage.elastics()[i];
    if (work.acts[i] != 0)
      right[linkage.plan().position(elastic.row)] =
          -Linkage::rate(elastic, linkage.slope(elastic, state.x), state.v, linkage.fixed_ones());
  }
  linkage.momenta(state.v, work.momentum);
  linkage.put(work.momentum, right);
  state.solve(work.unknowns);
  work.before = state.v;
  for (std::uint32_t k = 0; k < linkage.movable(); ++k) state.v[k] = linkage.taken(right, k);
  if (linkage.is_redundant()) state.correct_velocities(state.v, work.unknowns);
  // Where rods lie on each other the matrix may have no factors.
  if (!std::all_of(state.v.begin(), state.v.end(), [](Vec3 v) { return is_finite(v); })) {
    state.v = work.before;
    return 0;
  }
  double largest = 0;
  for (std::uint32_t k = 0; k < linkage.movable(); ++k) {
    const Vec3 given = work.before[k];
    const double change = norm(state.v[k] - given);
    // Where nothing but rounding changed, velocities stay as they were given, bit for bit.
    if (change <= 1e-12 * norm(given)) state.v[k] = given;
    largest = std::max(largest, change);
  }
  return largest;
}

}  // namespace plumb::detail
