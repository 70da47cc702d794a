#pragma once

#include <cstdint>
#include <vector>

#include "contact/relaxed/crowd.hpp"
#include "contact/shapes/bounds.hpp"

namespace plumb::detail {

/// Says of every particle of a crowd past which side of a box it is. A line whose ends both are beyond the
/// same side is not in the box, which is seen without its own bounds.
class ParticleSides {
 public:
  /// Looks at all particles beside a box from the crowd's origin.
  template <class T>
  void find(const Crowd<T>& crowd, const Bounds& box) {
    passed_.resize(crowd.places().numbers());
    for (std::uint32_t k = 0; k < crowd.places().particles(); ++k) {
      const std::uint32_t at = crowd.places().at(k);
      passed_[at] = side_passed(crowd.position(at), box);
    }
  }
  /// Returns whether the line between two places is off the box.
  bool are_off(std::uint32_t a, std::uint32_t b) const { return passed_[a] != 0 && passed_[a] == passed_[b]; }

 private:
  /// Returns the first side that a place is beyond, or 0. One side is enough: the ends of a line are near
  /// each other.
  static std::uint8_t side_passed(Vec3 at, const Bounds& box) {
    if (at.z < box.low.z) return 1;
    if (at.z > box.high.z) return 2;
    if (at.x < box.low.x) return 3;
    if (at.x > box.high.x) return 4;
    if (at.y < box.low.y) return 5;
    return at.y > box.high.y ? 6 : 0;
  }

  std::vector<std::uint8_t> passed_;  ///< by place, see side_passed()
};

}  // namespace plumb::detail
