#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "direct/laws/law_factors.hpp"

namespace plumb::detail {

/// Holds how the rods of an island with loops give, in double. Islands of rigid rods have no numbers.
struct LoopLaws {
  using Numbers = std::array<double, simd::tree_fields::law>;
  std::vector<Numbers> rods;

  bool any() const { return !rods.empty(); }
  bool is_rigid(std::uint32_t k) const { return rods[k][2] != 0; }
  bool is_one_sided(std::uint32_t k) const { return rods[k][3] != 0; }
};

/// Holds what a substep makes of the laws, while it is solved.
struct LawWorkspace {
  LawFactors factors;
  bool is_mid = false;
  std::vector<std::array<double, simd::tree_fields::law_start>> starts;  ///< They are per rod.
};

/// A row of Newton's matrix is  use gradient . (change of e) + soft (change of mu) = -c.
struct RodRow {
  double use = 1, soft = 0, c = 0;
};

/// Makes the start of rod `k` of the squared length `length2`, which is `violation` = C off its own (m²).
void start_law(const LoopLaws& laws, std::uint32_t k, double half_kick, double length2, double violation,
               LawWorkspace& work);
/// Returns the row of rod `k` in a substep. The square of its length has grown by `growth`, and it violates its
/// length by `violation` (m²).
RodRow law_row(const LoopLaws& laws, const LawWorkspace& work, std::uint32_t k, double growth,
               double violation, double mu, double theta);
/// Returns the multiplier with which a rod that gives pulls in a projection of velocities.
double known_multiplier(const LoopLaws& laws, const LawWorkspace& work, std::uint32_t k);
/// Says whether rod `k` keeps its length in a projection of velocities. `last_mu` is its last multiplier.
bool holds_velocity(const LoopLaws& laws, std::uint32_t k, double last_mu);
/// Returns the half kick that a rod with multiplier mu leaves for the next substep.
double end_law(const LawWorkspace& work, std::uint32_t k, double half_kick, double mu);

/// Rod `k` of gradient new pulls with the multiplier -psi/l at the end of a substep, and psi is the derivative
/// of an energy by the length. Returns both.
struct LawPull {
  double mu, energy;
};
LawPull law_pull(const LoopLaws& laws, const LawWorkspace& work, std::uint32_t k, double growth);

}  // namespace plumb::detail
