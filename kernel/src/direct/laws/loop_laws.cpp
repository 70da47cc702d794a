#include "direct/laws/loop_laws.hpp"

#include <algorithm>

// The equation of a rod needs what this file defines for one number.
#include "simd/tree/one_lane.hpp"

#include "simd/tree/law_math.hpp"

namespace plumb::detail {
namespace {

simd::LawNumbers<double> numbers_of(const LoopLaws& laws, std::uint32_t k) {
  const auto [stiffness, damping, rigid, one_sided, frequency2] = laws.rods[k];
  return {stiffness, damping, rigid, one_sided, frequency2};
}
simd::LawFactors<double> factors_of(const LawWorkspace& work) {
  const auto [damping, share, kick, kick_before, substep] = work.factors.numbers();
  return {damping, share, kick, kick_before, substep};
}
simd::LawStart<double> start_of(const LawWorkspace& work, std::uint32_t k) {
  const auto [length, excess, slope, before] = work.starts[k];
  return {length, excess, slope, before};
}

}  // namespace

void start_law(const LoopLaws& laws, std::uint32_t k, double half_kick, double length2, double violation,
               LawWorkspace& work) {
  const auto start =
      simd::start_law(numbers_of(laws, k), factors_of(work), half_kick, length2, violation);
  work.starts[k] = {start.length, start.excess, start.slope, start.before};
}

RodRow law_row(const LoopLaws& laws, const LawWorkspace& work, std::uint32_t k, double growth,
               double violation, double mu, double theta) {
  const auto row = simd::law_row(numbers_of(laws, k), start_of(work, k), growth, violation, mu, theta, true,
                                 work.is_mid);
  return {row.use, row.soft, row.c};
}

double known_multiplier(const LoopLaws& laws, const LawWorkspace& work, std::uint32_t k) {
  return simd::known_pull(numbers_of(laws, k), start_of(work, k), 0.0, 0.0).mu;
}

bool holds_velocity(const LoopLaws& laws, std::uint32_t k, double last_mu) {
  const auto law = numbers_of(laws, k);
  return law.rigid != 0 && (law.one_sided == 0 || last_mu < 0);
}

double end_law(const LawWorkspace& work, std::uint32_t k, double half_kick, double mu) {
  return simd::end_law(factors_of(work), start_of(work, k), half_kick, mu);
}

LawPull law_pull(const LoopLaws& laws, const LawWorkspace& work, std::uint32_t k, double growth) {
  const auto start = start_of(work, k);
  if (start.slope == 0) return {0, 0};  // it is broken
  const double end = simd::end_length(start, growth);
  double off = start.excess + growth / (start.length + end) + start.before / start.slope;
  if (laws.rods[k][3] != 0) off = std::max(off, 0.0);
  return {-start.slope * off / end, 0.5 * start.slope * off * off};
}

}  // namespace plumb::detail
