#pragma once

#include <cstdint>
#include <span>

#include "contact/pulls/touched_pairs.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/shapes/contact.hpp"

namespace plumb::detail {

/// Lists the pairs that touched in a step, in the order of their shapes, and says which of them began and
/// ended.
class ContactList {
 public:
  /// Begins a step.
  void begin() {
    added_.clear();
    keys_.clear();
  }
  /// Adds a pair, with the names that the scene has for an island's shape and for the other.
  void add(ShapeId shape, ShapeId other, const TouchedPair& pair);
  /// Lets all pairs of a shape end in the next step, though another may get its name by then.
  void end_pairs_of(ShapeId shape) { gone_.push_back(shape); }
  /// Ends the step: sorts what was added and compares it with the step before.
  void end();

  /// Lists the pairs of the last step.
  template <class Archive>
  void archive(Archive& archive) {
    auto& [added, keys, contacts, last, gone, is_steady] = *this;
    archive(contacts, gone, is_steady);
  }

  std::span<const Contact> all() const { return contacts_; }
  /// Returns whether all of them were there in the step before, and their shapes are still.
  bool is_steady() const { return is_steady_ && gone_.empty(); }

 private:
  /// Names a pair, in order, and where it is listed.
  struct Key {
    ShapeId a, b;
    std::uint32_t index;
  };

  Array<TouchedPair> added_;  ///< on the shapes a
  Array<Key> keys_;
  Array<Contact> contacts_, last_;
  Array<ShapeId> gone_;  ///< since the last step
  bool is_steady_ = true;
};

template <class Archive>
void visit_members(Archive& archive, ShapeId& of) {
  auto& [kind, number] = of;
  archive(kind, number);
}
template <class Archive>
void visit_members(Archive& archive, Contact& of) {
  auto& [a, b, phase, point, normal, impulse, approach_speed] = of;
  archive(a, b, phase, point, normal, impulse, approach_speed);
}

}  // namespace plumb::detail
