// This file makes the list of contacts that a world shows.

#include "contact/pulls/contact_list.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace plumb::detail {
namespace {

template <class Pair>
auto names(const Pair& pair) {
  return std::tuple(pair.a, pair.b);
}

}  // namespace

void ContactList::add(ShapeId shape, ShapeId other, const TouchedPair& pair) {
  keys_.push_back({shape, other, static_cast<std::uint32_t>(added_.size())});
  TouchedPair& added = added_.emplace_back(pair);
  if (shape < other) return;
  std::swap(keys_.back().a, keys_.back().b);
  added.impulse = -1.0 * pair.impulse;
  added.normal = -1.0 * pair.normal;
}

void ContactList::end() {
  const auto is_before = [](const Key& one, const Key& two) {
    return std::tuple(names(one), one.index) < std::tuple(names(two), two.index);
  };
  // Islands mostly come in the order of their shapes.
  if (!std::is_sorted(keys_.begin(), keys_.end(), is_before))
    std::sort(keys_.begin(), keys_.end(), is_before);
  std::swap(contacts_, last_);
  contacts_.clear();
  std::erase_if(last_, [](const Contact& each) { return each.phase == ContactPhase::ended; });
  auto old = last_.begin();
  std::sort(gone_.begin(), gone_.end());
  const auto is_gone = [&](ShapeId shape) { return std::binary_search(gone_.begin(), gone_.end(), shape); };
  const auto ends = [&](const Contact& each, const Key* next) {
    if (next == nullptr || names(each) < names(*next)) return true;
    return names(each) == names(*next) && (is_gone(each.a) || is_gone(each.b));
  };
  const auto end_before = [&](const Key* next) {
    for (; old != last_.end() && ends(*old, next); ++old)
      contacts_.push_back({old->a, old->b, ContactPhase::ended, old->point, old->normal, Vec3{}, 0});
  };
  for (auto it = keys_.begin(); it != keys_.end();) {
    const Key key = *it;
    TouchedPair& sum = added_[key.index];
    for (++it; it != keys_.end() && names(*it) == names(key); ++it) sum.add(added_[it->index]);
    end_before(&key);
    const bool lasts = old != last_.end() && names(*old) == names(key);
    old += lasts;
    const double size = norm(sum.normal);
    contacts_.push_back({key.a, key.b, lasts ? ContactPhase::persisted : ContactPhase::began,
                         (1 / sum.weight) * sum.place, size > 0 ? (1 / size) * sum.normal : Vec3{},
                         sum.impulse, sum.approach});
  }
  end_before(nullptr);
  gone_.clear();
  is_steady_ = std::all_of(contacts_.begin(), contacts_.end(),
                           [](const Contact& each) { return each.phase == ContactPhase::persisted; });
}

}  // namespace plumb::detail

namespace plumb {

std::string_view to_string(ShapeKind kind) {
  switch (kind) {
    case ShapeKind::capsule:
      return "capsule";
    case ShapeKind::hull:
      return "hull";
    case ShapeKind::plane:
      return "plane";
    case ShapeKind::box:
      return "box";
    case ShapeKind::ground_capsule:
      return "ground_capsule";
    case ShapeKind::ground_hull:
      return "ground_hull";
    case ShapeKind::mesh:
      return "mesh";
    case ShapeKind::height_field:
      return "height_field";
  }
  return "unknown";
}

std::string_view to_string(ContactPhase phase) {
  switch (phase) {
    case ContactPhase::began:
      return "began";
    case ContactPhase::persisted:
      return "persisted";
    case ContactPhase::ended:
      return "ended";
  }
  return "unknown";
}

}  // namespace plumb
