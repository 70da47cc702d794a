#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "contact/relaxed/crowd.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// Holds the bodies of a crowd. Their rods allow their mirror images, too, into which a blow pushes them that
/// moves particles further than they are apart.
template <class T>
class CrowdBodies {
 public:
  /// Takes in the bodies of the islands that move.
  void gather(std::span<LinkageState* const> cluster, const Crowd<T>& crowd);
  /// Gives bodies that displacements turn inside out, or nearly so, their shape. Each is put where it is
  /// nearest to its particles, weighted by mass: the pushes for that have no sum and no torque.
  void right(Crowd<T>& crowd) const;
  /// Gives displacements of bodies the rigid motion with their momentum and angular momentum. Rods would come
  /// to that, but for the second order, and what rests starts from rest. What joints and other rods pull with
  /// is not known as a substep begins: bodies that they hold start as their particles do, unless they are
  /// touched.
  void begin_rigidly(Crowd<T>& crowd) const;

 private:
  struct Body {
    std::uint32_t island;
    bool is_held;  ///< by joints or rods
    std::array<std::uint32_t, 4> particles;
    std::array<std::uint32_t, 4> at;  ///< their places
    std::array<double, 4> mass;       ///< kg; those that are fixed weigh more than all others
    std::array<bool, 4> moves;
    std::array<Vec3, 4> offsets;  ///< m, in the scene, from their middle
    double over_volume;           ///< 1/m³, signed, of their parallelepiped
  };
  static Body made(std::uint32_t island, const BodyShape& shape, const Crowd<T>& crowd);

  std::uint32_t layout_ = 0;  ///< that bodies were gathered for
  Array<Body> bodies_;
};

extern template class CrowdBodies<float>;
extern template class CrowdBodies<double>;

}  // namespace plumb::detail
