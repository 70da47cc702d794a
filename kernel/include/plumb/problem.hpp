#pragma once

#include <cstdint>
#include <string_view>

#include "plumb/export.hpp"

namespace plumb {

/// Says what went wrong in the last step of a World (World::problems()).
struct Problem {
  /// `frozen`: numbers of an island went non-finite, and it stands still. `unsolved`: a substep was not
  /// solved. `inaccurate`: a step was taken though not accurate enough. `capped`: an island spent
  /// Settings::most_work. `stretched`: a rod that is not elastic is off its length.
  enum class Kind : std::uint8_t { frozen, unsolved, inaccurate, capped, stretched };

  Kind kind = Kind::unsolved;
  /// It is the first movable particle of the island, or of the first of equal islands that are solved side by
  /// side. For a rod it is the rod's first movable end.
  std::uint32_t particle = 0;
  std::uint32_t rod = 0;  ///< The rod, if it is stretched.
  double strain = 0;      ///< Its strain, without a unit; negative if it is too short.
};
/// Returns the name of a kind of problem, as reports spell it.
PLUMB_API std::string_view to_string(Problem::Kind);

}  // namespace plumb
