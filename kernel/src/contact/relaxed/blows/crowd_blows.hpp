#pragma once

#include <cstdint>
#include <span>

#include "contact/relaxed/crowd.hpp"
#include "contact/relaxed/crowd_joints.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// Gives islands in flight the blow of an anchor or a length that changes its speed, before a substep.
///
/// Sweeps then take from velocities what rods and ball joints forbid at the new speeds. Without that gradient
/// mid would swing about these for ever. What the blow pulls with is counted apart from the substep, since a
/// winch does its work at the mean of both speeds.
template <class T>
class CrowdBlows {
 public:
  /// Returns whether any island has got one.
  bool give(std::span<LinkageState* const> cluster, Crowd<T>& crowd, CrowdJoints<T>& joints,
            const CrowdRules& rules);

 private:
  struct Rod {
    std::uint32_t lane;
    Vec3 along;               ///< from its second end to the first, of length 1
    double rate;              ///< m/s, of its length
    double share_a, share_b;  ///< by which its ends share a change of their relative speed
    double mass;              ///< kg, makes an impulse of such a change
    double impulse = 0;       ///< N s, by which it pulls
  };
  static bool jumps(const LinkageState& state);
  void find_rods(std::span<LinkageState* const> cluster, const Crowd<T>& crowd, const CrowdRules& rules);
  double sweep(Crowd<T>& crowd);
  void count_pulls(std::span<LinkageState* const> cluster, const Crowd<T>& crowd) const;

  Array<std::uint8_t> is_struck_;  ///< by island
  Array<Rod> rods_;                ///< of those that are
};

extern template class CrowdBlows<float>;
extern template class CrowdBlows<double>;

}  // namespace plumb::detail
