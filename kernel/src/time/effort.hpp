#pragma once

#include <algorithm>
#include <cstdint>

namespace plumb::detail {

/// Says how many Newton steps a substep may take before it is taken in a way that damps but is cheap.
///
/// A blow can need any number of cuts, and each of them fails a few times. So that no frame stands out, a
/// substep gets so many times what substeps usually take.
struct Effort {
  /// The usual number changes by this share after every substep, within these bounds.
  static constexpr double adapts = 0.03, least_usual = 4, most_usual = 1e6;
  /// A substep may take this many times the usual Newton steps, and never fewer than `least`. Larger ones
  /// make fallbacks rarer and the worst frames dearer.
  static constexpr double times = 6;
  static constexpr std::uint64_t least = 24;
  static constexpr std::uint64_t endless = std::uint64_t{1} << 62;

  std::uint64_t most() const { return std::max(least, static_cast<std::uint64_t>(times * usual)); }
  /// Takes note of what a substep took. The usual number goes up or down a little, so that it tends to the
  /// median of the last ones. It hardly follows a few that are hard.
  void took(std::uint64_t newton) {
    const double way = static_cast<double>(newton) > usual ? 1 + adapts : 1 - adapts;
    usual = std::clamp(way * usual, least_usual, most_usual);
  }

  double usual = least_usual;  ///< About so many Newton steps were taken in half of the last substeps.
};

template <class Archive>
void visit_members(Archive& archive, Effort& of) {
  auto& [usual] = of;
  archive(usual);
}

}  // namespace plumb::detail
