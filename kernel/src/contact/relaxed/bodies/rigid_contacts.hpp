#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "contact/relaxed/bodies/rigid_frame.hpp"
#include "contact/relaxed/crowd.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// Visits contacts of bodies that nothing fixes as those of rigid bodies, which move and turn as a whole.
///
/// As points, the four particles of a body give way under a corner more than the body does. A push is then
/// too small, and rods have to carry it on. In ten sweeps they do not: crates on each other rocked for ever.
template <class T>
class RigidContacts {
 public:
  using Term = typename Crowd<T>::Term;
  static constexpr std::uint32_t none = 0xffffffff;

  /// Names a side of a contact: its island, or none of ground, the particles of its body, if any, and its
  /// place.
  struct Side {
    std::uint32_t island = none;
    const std::array<std::uint32_t, 4>* body = nullptr;
    std::span<const Term> terms;
  };
  /// What a visit reads of a contact. The first `own` terms are those of its first side.
  struct Visited {
    std::uint32_t number;
    std::span<const Term> terms;
    std::size_t own;
    Vec3 normal, carried;  ///< carried: m, how far moving ground goes
    double gap, friction;  ///< m, what may be lost along the normal; Coulomb's coefficient
  };

  void clear() {
    bodies_.clear();
    contacts_.clear();
  }
  /// Adds a contact. Returns its number, or none if no side of it is a body that moves freely.
  std::uint32_t add(const Crowd<T>& crowd, const std::array<Side, 2>& sides, Vec3 normal);
  /// Gives displacements of all bodies that have contacts the rigid motion with their momentum and angular
  /// momentum. Rigid pushes do not damp another.
  void begin_rigidly(Crowd<T>& crowd) const;
  /// Sets the pushes of a contact, along its normal and against sliding (kg m), to what its places ask for.
  void visit(Crowd<T>& crowd, const Visited& contact, double& push, Vec3& across) const;

 private:
  struct Body {
    const std::array<std::uint32_t, 4>* particles;
    std::uint32_t island;
    RigidFrame frame;
    std::array<Vec3, 3> inverse_inertia;  ///< 1/(kg m²), by columns

    Vec3 turned_by(Vec3 torque) const {
      return torque.x * inverse_inertia[0] + torque.y * inverse_inertia[1] + torque.z * inverse_inertia[2];
    }
  };
  struct Contact {
    std::array<std::uint32_t, 2> body{none, none};
    std::array<Vec3, 2> arm{};  ///< m, from the body's middle to the place that is pushed
    double over = 0;            ///< kg, what moves its places apart by a metre
    Vec3 answer{};              ///< 1/kg, how a push of one along the normal moves them
    Vec3 along{}, beside{};     ///< unit vectors across the normal
    /// kg, the inverse of how pushes along these move them, and the least that moves them so by a metre
    double first = 0, both = 0, second = 0, over_sliding = 0;
  };

  std::uint32_t body_of(const Crowd<T>& crowd, const Side& side);
  Vec3 answer_of(const Contact& contact, const std::array<Side, 2>& sides, Vec3 push) const;

  Array<Body> bodies_;
  Array<Contact> contacts_;
};

extern template class RigidContacts<float>;
extern template class RigidContacts<double>;

}  // namespace plumb::detail
