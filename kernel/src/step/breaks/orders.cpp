// This file takes orders for edits that make islands anew. The next step carries them out (split.cpp).

#include <algorithm>
#include <cmath>

#include "scene/refuse.hpp"
#include "step/methods.hpp"
#include "step/step.hpp"

namespace plumb::detail {

/// Refuses an edit of a rod or a particle whose island cannot be made anew from the numbers of a scene.
/// `particle` is a movable one of the island, if it has any.
void Step::require_editable(const char* what, std::uint32_t number, std::uint32_t particle) const {
  if (!has_archive())
    refuse(what, " ", number, ": method ", to_string(settings_.method),
           " edits no world; relax, direct and auto do");
  const auto places = compiled_.places.of(particle);
  if (!places.empty() && &solver(places.back()) == compiled_.contact)
    refuse(what, " ", number, ": its island has joints, springs, shapes, air on rods or sleepers, and stays one");
  if (const auto reel = breaks_.reel_at(particle))
    refuse(what, " ", number, ": reel ", *reel, " is of its island, which stays one");
}

void Step::cut(std::uint32_t rod) {
  breaks_.begin();
  if (is_broken(rod)) return;
  require_editable("rod", rod, rods_.end(rod));
  if (const auto twist = breaks_.twist_beside(rod))
    refuse("rod ", rod, ": twist ", *twist, " is of its island, which stays one");
  edits_.cut.push_back(rod);
  breaks_.order(rod, true);
}

/// Lets what is ordered be read as if it was done, or takes that back.
void Step::order(const Edits& edits, bool is_ordered) {
  if (edits.any()) breaks_.begin();
  for (const std::uint32_t rod : edits.cut) breaks_.order(rod, is_ordered);
  for (const auto& [particle, is_fixed] : edits.fixed)
    anchors_.order(particle, is_ordered ? is_fixed : anchors_.is_fixed(particle));
}

}  // namespace plumb::detail
