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
  Added& added = added_.emplace_back(Added{shape, other, pair});
  added.sum.order = static_cast<std::uint32_t>(added_.size());
  if (shape < other) return;
  std::swap(added.a, added.b);
  added.sum.impulse = -1.0 * pair.impulse;
  added.sum.normal = -1.0 * pair.normal;
}

void ContactList::end() {
  std::sort(added_.begin(), added_.end(), [](const Added& one, const Added& two) {
    return std::tuple(names(one), one.sum.order) < std::tuple(names(two), two.sum.order);
  });
  std::swap(contacts_, last_);
  contacts_.clear();
  std::erase_if(last_, [](const Contact& each) { return each.phase == ContactPhase::ended; });
  auto old = last_.begin();
  const auto end_before = [&](const Added* next) {
    for (; old != last_.end() && (next == nullptr || names(*old) < names(*next)); ++old)
      contacts_.push_back({old->a, old->b, ContactPhase::ended, old->point, old->normal, Vec3{}, 0});
  };
  for (auto it = added_.begin(); it != added_.end();) {
    Added pair = *it;
    for (++it; it != added_.end() && names(*it) == names(pair); ++it) pair.sum.add(it->sum);
    end_before(&pair);
    const bool lasts = old != last_.end() && names(*old) == names(pair);
    old += lasts;
    const double size = norm(pair.sum.normal);
    contacts_.push_back({pair.a, pair.b, lasts ? ContactPhase::persisted : ContactPhase::began,
                         (1 / pair.sum.weight) * pair.sum.place,
                         size > 0 ? (1 / size) * pair.sum.normal : Vec3{}, pair.sum.impulse,
                         pair.sum.approach});
  }
  end_before(nullptr);
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
