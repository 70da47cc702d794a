#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "plumb/settings.hpp"
#include "scale/fit.hpp"

/// These functions measure what each method costs for the same error, against links.
namespace plumb::tools {

/// A family of chains has links of 10 cm, or chains of 1 m.
enum class ChainFamily : std::uint8_t { equal_links, equal_length };
std::string chain_spec(ChainFamily family, std::uint32_t links);

/// This is the cheapest setting found that meets a target.
struct Cheapest {
  std::string setting{};
  double ms = 0;     ///< Time of stepping per simulated second, in ms: the least of several runs.
  double error = 0;  ///< Position error at 1 s, relative to the scene's diagonal.
};

struct EqualErrorCell {
  ChainFamily family = ChainFamily::equal_links;
  std::uint32_t links = 0;
  Method method = Method::relax;
  double moved = 0;  ///< RMS distance by which the truth moves in the second, relative to the diagonal.
  std::optional<Cheapest> cheapest{};  ///< None if nothing that was tried within its time meets the target.
};

/// Tries every method in ever finer settings, coarse ones first. Settings differ in gradient, sweeps and
/// their order, over-relaxation, precision, integrator, and stiffness with step. A path of settings ends once
/// it meets the target or is clearly slower than what did. It also ends after `path_s` of wall-clock time.
std::vector<EqualErrorCell> measure_at_equal_error(ChainFamily family, std::uint32_t links,
                                                   const std::vector<Method>& methods, double target,
                                                   double path_s);

/// Returns links and seconds of stepping per simulated second, wherever a method meets the target.
std::vector<Timing> timings_of(const std::vector<EqualErrorCell>& cells, ChainFamily family, Method method);

}  // namespace plumb::tools
