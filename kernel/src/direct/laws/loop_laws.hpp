#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "direct/laws/law_factors.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// Holds how the rods of an island with loops give, change their lengths and pull. Islands of rigid rods have
/// no numbers.
struct LoopLaws {
  using Numbers = std::array<double, simd::tree_fields::law>;
  Array<Numbers> rods;

  Array<double> half_kick;  ///< They have one number per rod, see simd/tree/law_math.hpp.
  Array<double> length;     ///< At the end of the last substep, in m.
  Array<double> rate;       ///< Lengths change by so much, in m/s.
  Array<double> jump;       ///< Rates changed by so much as the step began, in m/s.
  Array<double> impulse;    ///< Pulls times substeps, of this step, in N s.
  Array<double> ahead;      ///< Of it, what the next step takes back, see pulls_ahead.hpp.
  Array<double> bent;       ///< Bends pull along rods so in a substep, over the unit of mass.
  bool moves = false;       ///< Some rod changes its length.
  bool pulls = false;       ///< Pulls are added up.

  /// Makes room for rods of these squared lengths (m^2), which are rigid.
  void make(std::span<const double> length2);
  bool any() const { return !rods.empty(); }
  bool is_rigid(std::uint32_t k) const { return rods[k][2] != 0; }
  bool is_one_sided(std::uint32_t k) const { return rods[k][3] != 0; }
  /// Elastic rods do what is in their energy, a rigid cable that is caught loses some, and winches lift.
  bool does_work(std::uint32_t k) const { return !is_rigid(k) || is_one_sided(k) || rate[k] != 0; }
  bool is_broken(std::uint32_t k) const { return rods[k] == Numbers{}; }
};

/// Holds what a substep makes of a law, see simd/tree/law_math.hpp.
struct LawNow {
  std::array<double, simd::tree_fields::law_step> step;
  std::array<double, simd::tree_fields::law_start> start;
};
/// Holds what a substep makes of the laws, while it is solved.
struct LawWorkspace {
  LawFactors factors;
  bool is_mid = false;
  Array<LawNow> starts;  ///< They are per rod.
  /// The squared lengths of elastic cables have grown by so much (m²) in the substep that ends; per rod.
  Array<double> growth;
};

/// A row of Newton's matrix is  use gradient . (change of e) + soft (change of mu) = -c.
struct RodRow {
  double use = 1, soft = 0, c = 0;
};

/// Makes the start of rod `k` of the squared length `length2`, which is `violation` = C off its own (m²).
void start_law(const LoopLaws& laws, std::uint32_t k, double length2, double violation, LawWorkspace& work);
/// This is where a rod is at an iterate of Newton's method, as simd::LawIterate.
struct RodIterate {
  double growth, violation, mu;
};
/// Returns the row of rod `k` in a substep of gradient theta.
RodRow law_row(const LoopLaws& laws, const LawWorkspace& work, std::uint32_t k, const RodIterate& iterate,
               double theta);
/// Returns the multiplier with which rod `k` is known to pull in a projection of velocities, and the row of
/// what is added to it. Half of its squared length `length2` (m²) grows at c (m²/s), and its last multiplier
/// is `last_mu`.
struct VelocityRow {
  double mu = 0;
  RodRow row{};
};
VelocityRow velocity_row(const LoopLaws& laws, const LawWorkspace& work, std::uint32_t k, double length2,
                         double c, double last_mu);

/// Sets the lengths of rods whose length changes, as set_substep_lengths() of trees does.
void set_substep_lengths(const LoopLaws& laws, double h, std::span<double> length2);
/// Ends a substep of `h` (s), as end_rods() of trees does. Forces acted by `kick` (s^2) on masses in units of
/// `mass_unit` (kg).
struct SubstepEnd {
  double h, theta, kick, mass_unit;
  double pulled;  ///< Rods pull for so long, in s, see pulled_time().
};
std::uint32_t end_rods(LoopLaws& laws, const LawWorkspace& work, const SubstepEnd& end,
                       std::span<const double> mu, std::span<double> length2);

/// Returns the length (m) along which an elastic rod that is no cable pulls with the multiplier `mu` in a
/// substep of gradient theta, for the first two numbers of simd::LawStep and of simd::LawStart. It solves the
/// rod's equation.
inline double pulled_length(double slope, double give, double length, double before, double mu,
                            double theta) {
  const double over = slope + theta * mu * give;
  return length - theta * (over > 0 ? (give * mu * length + before) / over : 0);
}
inline double pulled_length(const LawNow& now, double mu, double theta) {
  return pulled_length(now.step[0], now.step[1], now.start[0], now.start[1], mu, theta);
}

/// Rod `k` of gradient new pulls with the multiplier -psi/l at the end of a substep, and psi is the
/// derivative of an energy by the length. Returns both.
struct LawPull {
  double mu, energy;
};
LawPull law_pull(const LoopLaws& laws, const LawWorkspace& work, std::uint32_t k, double growth);

template <class Archive>
void visit_members(Archive& archive, LoopLaws& of) {
  auto& [rods, half_kick, length, rate, jump, impulse, ahead, bent, moves, pulls] = of;
  archive(rods, half_kick, length, rate, jump, impulse, ahead, moves, pulls);
  if (archive.restores()) bent.assign(rods.size(), 0);  // of a substep
}

}  // namespace plumb::detail
