#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "plumb/settings.hpp"
#include "scale/fit.hpp"

/// What each method costs for the same error, against links.
namespace plumb::tools {

/// Which chains: all of links of 10 cm, or all 1 m long.
enum class ChainFamily : std::uint8_t { equal_links, equal_length };
std::string chain_spec(ChainFamily family, std::uint32_t links);

/// The cheapest setting found that meets a target.
struct Cheapest {
  std::string setting{};
  double ms = 0;     ///< of stepping, per simulated second, least of several runs
  double error = 0;  ///< position error at 1 s, relative to the scene's diagonal
};

struct EqualErrorCell {
  ChainFamily family = ChainFamily::equal_links;
  std::uint32_t links = 0;
  Method method = Method::relax;
  double moved = 0;                    ///< by the truth in the second, RMS, relative to the diagonal
  std::optional<Cheapest> cheapest{};  ///< none: nothing tried within its time meets the target
};

/// Every method in ever finer settings, coarse ones first: gradients, sweeps, over-relaxation, precisions,
/// integrators, stiffness with step. A way to refine ends once it meets the target, is clearly dearer than
/// what did, or has used `path_s` of wall-clock time.
std::vector<EqualErrorCell> measure_at_equal_error(ChainFamily family, std::uint32_t links,
                                                   const std::vector<Method>& methods, double target,
                                                   double path_s);

/// Lengths and seconds (of stepping per simulated second) of a method where it meets the target.
std::vector<Timing> timings_of(const std::vector<EqualErrorCell>& cells, ChainFamily family, Method method);

}  // namespace plumb::tools
