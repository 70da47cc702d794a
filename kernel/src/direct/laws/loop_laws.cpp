#include "direct/laws/loop_laws.hpp"

#include <algorithm>
#include <cmath>

// These functions are for plain numbers.
#include "simd/tree/one_lane.hpp"

// The equation of a rod needs what the file above defines.
#include "simd/tree/law_math.hpp"

namespace plumb::detail {
namespace {

simd::LawNumbers<double> numbers_of(const LoopLaws& laws, std::uint32_t k) {
  const auto [stiffness, damping, rigid, one_sided, frequency2, strength] = laws.rods[k];
  return {stiffness, damping, rigid, one_sided, frequency2};
}
simd::LawFactors<double> factors_of(const LawWorkspace& work) {
  const auto [share, kick, kick_back, kick_before, rate, substep, substep_before] = work.factors.numbers();
  return {share, kick, kick_back, kick_before, rate, substep, substep_before};
}
simd::LawStep<double> step_of(const std::array<double, simd::tree_fields::law_step>& numbers) {
  const auto [slope, give, weight, length, kept] = numbers;
  return {slope, give, weight, length, kept};
}
simd::LawStart<double> start_of(const std::array<double, simd::tree_fields::law_start>& numbers) {
  const auto [length, before, excess, left] = numbers;
  return {length, before, excess, left};
}

/// Returns how much a rod pays out in half a substep of gradient mid, in m, see simd::start_cable().
double paid_out(const LoopLaws& laws, const LawWorkspace& work, std::uint32_t k) {
  return work.is_mid && work.factors.rate > 0 ? laws.rate[k] / (2 * work.factors.rate) : 0;
}

}  // namespace

void LoopLaws::make(std::span<const double> length2) {
  if (any()) return;
  rods.assign(length2.size(), Numbers{0, 0, 1});
  half_kick = rate = jump = impulse = ahead = bent = Array<double>(length2.size());
  for (const double square : length2) length.push_back(std::sqrt(square));
}

void start_law(const LoopLaws& laws, std::uint32_t k, double length2, double violation, LawWorkspace& work) {
  const auto law = numbers_of(laws, k);
  const auto step = simd::law_step(law, factors_of(work), length2 - 2 * violation);
  auto start =
      simd::start_cable(law, step, simd::start_law(step, length2, violation), paid_out(laws, work, k));
  simd::add_kick(step, work.factors.kick_before * laws.half_kick[k], start);
  work.starts[k] = {{step.slope, step.give, step.weight, step.length, step.kept},
                    {start.length, start.before, start.excess, start.left}};
}

RodRow law_row(const LoopLaws& laws, const LawWorkspace& work, std::uint32_t k, const RodIterate& iterate,
               double theta) {
  if (laws.is_rigid(k) && !laws.is_one_sided(k)) return {1, 0, iterate.violation};
  const auto& [step, start] = work.starts[k];
  const auto row =
      simd::cable_row<false>(numbers_of(laws, k), step_of(step), start_of(start),
                             simd::LawIterate<double>{iterate.growth, iterate.violation, iterate.mu},
                             simd::CableSubstep<double>{theta, paid_out(laws, work, k), work.is_mid});
  return {row.use, row.soft, row.c};
}

VelocityRow velocity_row(const LoopLaws& laws, const LawWorkspace& work, std::uint32_t k, double length2,
                         double c, double last_mu) {
  const auto [mu, row] =
      simd::known_pull(numbers_of(laws, k), factors_of(work),
                       simd::LawMotion<double>{length2, c, laws.rate[k], last_mu, laws.half_kick[k]});
  return {mu, {row.use, row.soft, row.c}};
}

void set_substep_lengths(const LoopLaws& laws, double h, std::span<double> length2) {
  for (std::uint32_t k = 0; k < length2.size(); ++k) {
    if (laws.rate[k] == 0) continue;
    const double length = laws.length[k] + (laws.is_rigid(k) ? h : h / 2) * laws.rate[k];
    length2[k] = length * length;
  }
}

namespace {

/// Returns the length (m) along which a rod has pulled with the multiplier `mu` in a substep. A rigid one
/// does its work along the mean of its lengths, but with gradient old it pulls where the substep starts. What
/// a cable pulls with does not tell how long it is where it comes tight.
double length_along(const LoopLaws& laws, std::uint32_t k, double mu, const SubstepEnd& end,
                    const LawWorkspace& work) {
  if (laws.is_rigid(k)) return laws.length[k] - (end.theta == 0 ? end.h : end.h / 2) * laws.rate[k];
  if (!laws.is_one_sided(k)) return pulled_length(work.starts[k], mu, end.theta);
  const double start = work.starts[k].start[0];
  return start + end.theta * (simd::end_length(start, work.growth[k]) - start);
}

}  // namespace

std::uint32_t end_rods(LoopLaws& laws, const LawWorkspace& work, const SubstepEnd& end,
                       std::span<const double> mu, std::span<double> length2) {
  std::uint32_t broken = 0;
  for (std::uint32_t k = 0; k < length2.size(); ++k) {
    if (!work.starts.empty())  // islands solved by their lines have none
      laws.half_kick[k] = simd::end_law(step_of(work.starts[k].step), work.starts[k].start[0],
                                        work.factors.kick_before, laws.half_kick[k], mu[k]);
    if (laws.rate[k] != 0) {
      laws.length[k] += end.h * laws.rate[k];
      length2[k] = laws.length[k] * laws.length[k];
    }
    const double length = length_along(laws, k, mu[k], end, work);
    const double pull = -mu[k] * length / end.kick + laws.bent[k], strength = laws.rods[k][5];
    laws.impulse[k] += end.pulled * pull * end.mass_unit;
    if (!(strength > 0 && pull > strength)) continue;
    laws.rods[k] = {};
    ++broken;
  }
  return broken;
}

LawPull law_pull(const LoopLaws& laws, const LawWorkspace& work, std::uint32_t k, double growth) {
  const auto step = step_of(work.starts[k].step);
  const auto start = start_of(work.starts[k].start);
  if (step.slope == 0) return {0, 0};  // it is broken
  const double end = simd::end_length(start.length, growth), slope = step.slope / step.give;
  double off = growth / (start.length + end) + start.before / step.slope;
  if (laws.is_one_sided(k)) off = std::max(off, 0.0);
  return {-slope * off / end, 0.5 * slope * off * off};
}

}  // namespace plumb::detail
