#include "contact/relaxed/bodies/rigid_contacts.hpp"

#include <algorithm>
#include <cmath>

#include "contact/levers/lever.hpp"
#include "contact/relaxed/blows/rigid_velocities.hpp"

namespace plumb::detail {

/// Returns the number of a side's body, or none if it has none that moves freely. Contacts of a pair follow
/// each other, so that their bodies are among the last two.
template <class T>
std::uint32_t RigidContacts<T>::body_of(const Crowd<T>& crowd, const Side& side) {
  if (side.body == nullptr) return none;
  for (std::size_t back = 1; back <= std::min<std::size_t>(2, bodies_.size()); ++back)
    if (const Body& last = bodies_[bodies_.size() - back];
        last.island == side.island && last.particles == side.body)
      return static_cast<std::uint32_t>(bodies_.size() - back);
  const std::optional<RigidFrame> frame = rigid_frame(crowd, side.island, *side.body);
  if (!frame) return none;
  const double over = 1 / frame->determinant;
  const auto& [x, y, z] = frame->adjugate;
  bodies_.push_back({side.body, side.island, *frame, {over * x, over * y, over * z}});
  return static_cast<std::uint32_t>(bodies_.size() - 1);
}

/// Returns how a push of a contact moves its places apart.
template <class T>
Vec3 RigidContacts<T>::answer_of(const Contact& contact, const std::array<Side, 2>& sides, Vec3 push) const {
  Vec3 out{};
  for (std::size_t i = 0; i < 2; ++i) {
    if (contact.body[i] != none) {
      const Body& body = bodies_[contact.body[i]];
      out +=
          body.frame.inverse_mass * push + cross(body.turned_by(cross(contact.arm[i], push)), contact.arm[i]);
      continue;
    }
    for (const Term& term : sides[i].terms) out += term.weight * term.move * push;
  }
  return out;
}

template <class T>
std::uint32_t RigidContacts<T>::add(const Crowd<T>& crowd, const std::array<Side, 2>& sides, Vec3 normal) {
  Contact contact;
  for (std::size_t i = 0; i < 2; ++i) {
    contact.body[i] = body_of(crowd, sides[i]);
    if (contact.body[i] == none) continue;
    const double sign = i == 0 ? 1 : -1;
    contact.arm[i] = sign * crowd.position(sides[i].terms) - bodies_[contact.body[i]].frame.middle;
  }
  if (contact.body[0] == none && contact.body[1] == none) return none;
  const auto [along, beside] = across(normal);
  contact.along = along;
  contact.beside = beside;
  contact.answer = answer_of(contact, sides, normal);
  contact.over = 1 / dot(normal, contact.answer);
  const Vec3 one = answer_of(contact, sides, contact.along), two = answer_of(contact, sides, contact.beside);
  const double first = dot(contact.along, one), both = dot(contact.beside, one),
               second = dot(contact.beside, two), over = 1 / (first * second - both * both);
  contact.first = over * second;
  contact.both = -over * both;
  contact.second = over * first;
  contact.over_sliding =
      2 / (first + second + std::sqrt((first - second) * (first - second) + 4 * both * both));
  contacts_.push_back(contact);
  return static_cast<std::uint32_t>(contacts_.size() - 1);
}

template <class T>
void RigidContacts<T>::begin_rigidly(Crowd<T>& crowd) const {
  for (const Body& each : bodies_) move_rigidly(crowd, each.island, *each.particles);
}

template <class T>
void RigidContacts<T>::visit(Crowd<T>& crowd, const Visited& of, double& push, Vec3& across) const {
  const Contact& contact = contacts_[of.number];
  const Vec3 moved = crowd.moved(of.terms) - of.carried;
  const double by = std::max(-push, -contact.over * (of.gap + dot(of.normal, moved)));
  const Vec3 slid = moved + by * contact.answer;
  const double along = dot(contact.along, slid), beside = dot(contact.beside, slid),
               bound = of.friction * (push + by);
  // What the normal push turned by since it was kept would pull along the normal.
  const Vec3 kept = across - dot(across, of.normal) * of.normal;
  Vec3 wanted = kept - (contact.first * along + contact.both * beside) * contact.along -
                (contact.both * along + contact.second * beside) * contact.beside;
  if (dot(wanted, wanted) > bound * bound) {
    // It slides. Friction is then against the motion, which what would hold it need not be.
    wanted = kept - contact.over_sliding * (along * contact.along + beside * contact.beside);
    const double square = dot(wanted, wanted);
    if (square > bound * bound) wanted = bound / std::sqrt(square) * wanted;
  }
  const Vec3 change = by * of.normal + (wanted - across);
  push += by;
  across = wanted;
  if (change == Vec3{}) return;
  for (std::size_t i = 0; i < 2; ++i) {
    if (contact.body[i] == none) {
      crowd.push(i == 0 ? of.terms.first(of.own) : of.terms.subspan(of.own), change);
      continue;
    }
    const Body& body = bodies_[contact.body[i]];
    const Vec3 own = i == 0 ? change : -1.0 * change, turned = body.turned_by(cross(contact.arm[i], own));
    for (std::size_t k = 0; k < 4; ++k)
      crowd.push(body.frame.at[k], body.frame.inverse_mass * own + cross(turned, body.frame.offsets[k]));
  }
}

template class RigidContacts<float>;
template class RigidContacts<double>;

}  // namespace plumb::detail
