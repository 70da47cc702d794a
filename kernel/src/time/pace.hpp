#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace plumb::detail {

/// Says how long the pieces are into which a substep is cut before it is tried.
///
/// A piece that had to be halved was tried in vain. So that the next need not be, it is as short as the
/// shortest half. Once a few pieces in a row were taken whole, the next is twice as long. Where that was too
/// early, twice as many must be taken before the next time.
struct Pace {
  static constexpr int most_cuts = 6;  ///< The shortest piece is 1/2^most_cuts of a substep.
  static constexpr std::uint32_t least_patience = 2, most_patience = 64;

  /// Returns how often a length of h (s) is halved before it is tried.
  int cuts(double h) const {
    int out = 0;
    for (double piece = std::abs(h); out < most_cuts && piece > longest; piece /= 2) ++out;
    return out;
  }
  /// Takes note that a piece of h (s) was taken, and how often its parts had to be halved.
  void took(double h, int halvings) {
    const double length = std::abs(h);
    if (halvings > 0) {
      longest = std::ldexp(length, -halvings);
      if (grew) patience = std::min(2 * patience, most_patience);
      grew = false;
      calm = 0;
    } else if (2 * length > longest && ++calm >= patience) {
      if (grew) patience = std::max(patience / 2, least_patience);
      longest *= 2;
      grew = true;
      calm = 0;
    }
  }

  double longest = std::numeric_limits<double>::infinity();  ///< It is in s.
  std::uint32_t patience = least_patience;  ///< So many pieces are taken before the next is longer.
  std::uint32_t calm = 0;                   ///< So many in a row were not halved.
  bool grew = false;                        ///< The last ones are longer than those before.
};

template <class Archive>
void visit_members(Archive& archive, Pace& of) {
  auto& [longest, patience, calm, grew] = of;
  archive(longest, patience, calm, grew);
}

}  // namespace plumb::detail
