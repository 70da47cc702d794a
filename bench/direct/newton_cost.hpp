#pragma once

#include <cstdint>
#include <vector>

#include "plumb/scene.hpp"
#include "plumb/settings.hpp"

namespace plumb::bench {

/// Holds nanoseconds per rod of stepping trees, the least of all rounds.
struct NewtonCost {
  Precision precision = Precision::single;
  Gradient gradient = Gradient::old;
  std::uint32_t links = 0;
  bool alone = false;  ///< one tree alone, one number after the other: the baseline
  Isa isa = Isa::scalar;
  double substep_ns = 0;          ///< ns of everything in a substep
  double newton_ns = 0;           ///< ns of everything in a substep, per Newton step
  double kernel_ns = 0;           ///< ns of a call of the Newton kernel, on prepared state
  double newton_per_substep = 0;  ///< Newton steps per substep
  std::uint64_t halvings =
      0;  ///< substeps that did not converge and were cut in two; 0 except where float ends
};

/// Times an ensemble of 256 chains of 32 links with end mass 10. Contestants are chains side by side in lanes
/// with every instruction set, and one chain after the other. They run in float and double with gradients old
/// and mid, all by turns. Throws CheckFailed if instruction sets end in different bits.
std::vector<NewtonCost> measure_lanes(std::uint32_t rounds);

/// Times one chain of that many links with gradient old: in segments with every instruction set, and as a
/// whole.
std::vector<NewtonCost> measure_long_chain(std::uint32_t links, std::uint32_t rounds);

/// How chains are stepped whose rods give.
enum class Form : std::uint8_t { alone, lanes, segments };

/// Times chains whose rods all have one of `laws`, by turns, so that what a law costs can be compared: 16
/// chains of 32 links alone and in lanes, and with gradient old one of 1000 in segments, all with the best
/// instruction set. Throws CheckFailed if a substep was not solved, or if chains alone and in lanes do not
/// move alike.
struct LawCosts {
  Form form;
  std::vector<NewtonCost> costs;  ///< Of every law.
};
std::vector<LawCosts> measure_laws(Precision precision, Gradient gradient, const std::vector<RodLaw>& laws,
                                   std::uint32_t rounds);

/// Returns the entry of `costs` that matches, or null.
const NewtonCost* find_cost(const std::vector<NewtonCost>& costs, Precision precision, Gradient gradient,
                            bool alone, Isa isa);

}  // namespace plumb::bench
