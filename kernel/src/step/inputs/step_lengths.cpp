// This file lets cords of a world change their lengths.

#include <algorithm>

#include "scene/refuse.hpp"
#include "step/step.hpp"

namespace plumb::detail {

void Step::set_length(std::uint32_t cord, double target) {
  if (!is_line(cord) && is_broken(cord)) return;  // it has no length any more
  if (waits<Rod>(cord)) refuse("rod ", cord, ": is joined in the next step, and keeps its length until then");
  if (is_in_contact(cord)) {
    if (const char* const reason = compiled_.contact->keeps_length(cord))
      refuse("rod ", cord, ": its length cannot change, since ", reason);
  } else if (compiled_.cords.of(cord).empty()) {
    const bool stands = anchors_.is_fixed(rods_.end(cord));
    refuse("rod ", cord, ": its length cannot change, since ",
           stands ? "both its ends are fixed" : "its method does not know of that");
  }
  if (!edits_.fixed.empty() && !is_line(cord)) {
    const Rod& rod = breaks_.scene_now().rods[cord];
    if (will_be_fixed(rod.a) && will_be_fixed(rod.b))
      refuse("rod ", cord, ": its length cannot change, since both its ends are fixed in the next step");
  }
  if (edits_.any() && compiled_.contact) {
    const Array<std::uint32_t> ends = meeting(edits_);
    if (meets_in_contact(edits_, ends) && meets_as_no_winch(cord, ends))
      refuse("rod ", cord, ": its length cannot change, since its island has joints or shapes in the next ",
             "step, and it gives, bends or drags");
  }
  if (cord < reeled_.size() && reeled_[cord] != 0)
    refuse("rod ", cord, ": its length cannot change by itself, since it is on a reel");
  if (cord < twisted_.size() && twisted_[cord] != 0)
    refuse("rod ", cord, ": its length cannot change, since its chain is twisted");
  lengths_.set_target(cord, target);
}

/// Wakes what hangs from cords that change their length in this step, and tells solvers.
void Step::begin_lengths() {
  for (const std::uint32_t cord : lengths_.moving())
    for (const Place place : compiled_.cords.of(cord)) sleep_.wake(compiled_.solvers, place);
  lengths_.begin_step(dt_, [this](auto... of) { tell_length(of...); });
}

/// Tells all solvers of a cord how long it is (m) and how fast it changes (m/s).
void Step::tell_length(std::uint32_t cord, double length, double rate) {
  for (const Place place : compiled_.cords.of(cord)) solver(place).set_length(place.slot, length, rate);
  if (is_in_contact(cord)) compiled_.contact->set_length(cord, length, rate);
}

/// Returns whether a rod belongs to an island that the contact solver may move.
bool Step::is_in_contact(std::uint32_t cord) const {
  return is_known_to_contact(cord) && compiled_.contact->has_rod(cord);
}

}  // namespace plumb::detail
