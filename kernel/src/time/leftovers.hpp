#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace plumb::detail {

/// Says how much a substep takes back of the violations that sweeps left before.
///
/// What sweeps leave of a pull goes as the square of the substep. A shorter one that took all of it back
/// would pull as much harder, and throw what it pulls. So it takes back what one of its own length would have
/// left. One that is shorter than a sixteenth takes back no less, for its time, than that one would.
struct Leftovers {
  double square = 0;  ///< s², of the substep that left them

  /// Returns the share that a substep of `h` (s) takes back.
  double share(double h) const {
    if (!(h * h < square)) return 1;
    return h / square * std::max(h, std::sqrt(square) / 16);
  }
  /// Lets substeps of `h` pass. Sweeps are slow with what is long, so what was left fades at a quarter of the
  /// speed at which it is taken back.
  void pass(double h, std::uint32_t substeps = 1) {
    for (std::uint32_t i = 0; i < substeps && square != h * h; ++i)
      square = std::max(h * h, square - share(h) / 4 * square);
  }
};

}  // namespace plumb::detail
