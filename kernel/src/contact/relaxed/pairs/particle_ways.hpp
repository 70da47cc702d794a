#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "contact/relaxed/crowd.hpp"
#include "contact/shapes/bounds.hpp"

namespace plumb::detail {

/// Says of every particle of a crowd how far it moves in a substep, and past which sides of a box. A line
/// whose ends both pass one side never comes into the box, which is seen without its own bounds.
class ParticleWays {
 public:
  /// Looks at all particles with their displacements of now, beside a box from the crowd's origin.
  template <class T>
  void find(const Crowd<T>& crowd, const Bounds& box) {
    const std::uint32_t end = crowd.padding();
    moves2_.resize(end / record);
    passed_.resize(end / record);
    for (std::uint32_t at = 0; at < end; at += record) {
      const Vec3 from = crowd.position(at), by = crowd.moved(at), to = from + by;
      moves2_[at / record] = dot(by, by);
      passed_[at / record] = static_cast<std::uint8_t>(
          (std::max(from.x, to.x) < box.low.x) << 0 | (std::min(from.x, to.x) > box.high.x) << 1 |
          (std::max(from.y, to.y) < box.low.y) << 2 | (std::min(from.y, to.y) > box.high.y) << 3 |
          (std::max(from.z, to.z) < box.low.z) << 4 | (std::min(from.z, to.z) > box.high.z) << 5);
    }
  }
  /// Returns the square of how far (m²) the record that starts at a number moves.
  double moves2(std::uint32_t at) const { return moves2_[at / record]; }
  /// Returns whether the line between two records stays out of the box.
  bool stays_out(std::uint32_t a, std::uint32_t b) const {
    return (passed_[a / record] & passed_[b / record]) != 0;
  }

 private:
  static constexpr std::uint32_t record = 4;
  std::vector<double> moves2_;        ///< by particle
  std::vector<std::uint8_t> passed_;  ///< by particle: a bit for each side of the box
};

}  // namespace plumb::detail
