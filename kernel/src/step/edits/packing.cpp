// This file lets islands that edits left by themselves lie side by side again.

#include <algorithm>

#include "plumb/layouts/aligned_buffer.hpp"
#include "step/breaks/ids.hpp"
#include "step/step.hpp"

namespace plumb::detail {
namespace {

/// More islands than these that are added at once share lanes among themselves, and lie well.
constexpr std::size_t most_alone = 3;
/// Fewer islands than these that came one by one stay with solvers of their own: making them anew takes as
/// long as some ten steps save.
constexpr std::size_t least_side_by_side = 4;

}  // namespace

/// Lets islands that come one by one lie side by side from the next step on. Those that came together do so
/// already, and sleepers would wake by it.
void Step::list_arrivals(const Addition& of) {
  if (!has_archive_) return;
  Array<std::uint32_t> heads;
  for (std::uint32_t k = 0; k < of.scene.particles.size() && heads.size() <= most_alone; ++k) {
    const std::uint32_t particle = of.first.particles + k;
    if (!breaks_.is_head(particle)) continue;
    const Place* const place = contact_place(particle);
    if (place && !compiled_.contact->may_go_home(place->slot)) continue;
    if (of.scene.particles[k].asleep) return;
    heads.push_back(particle);
  }
  if (heads.size() <= most_alone) append(edits_.side_by_side, heads);
}

/// Lists what this step lays side by side.
void Step::list_side_by_side() {
  if (edits_.side_by_side.size() < least_side_by_side) edits_.side_by_side.clear();
  if (edits_.packs) list_loose();
}

/// Lists islands that pack() makes anew: all of which a solver has few, if an edit has left some so since the
/// last pack. It packs nothing else.
void Step::list_loose() {
  const std::uint32_t lanes =
      settings_.precision == Precision::single ? layouts::lane_width<float> : layouts::lane_width<double>;
  const Array<std::uint32_t> heads = breaks_.heads();
  Array<std::uint32_t> islands(seats_.size(), 0);
  const auto home = [&](std::uint32_t particle) { return compiled_.places.of(particle).front().solver; };
  for (const std::uint32_t each : heads) ++islands[home(each)];
  const auto has_few = [&](std::uint32_t s) {
    return !compiled_.solvers[s]->has_changing_pieces() &&
           8 * islands[s] < 7 * lanes * compiled_.solvers[s]->pieces();
  };
  Array<std::uint32_t> few;
  for (const std::uint32_t each : heads)
    if (has_few(home(each))) few.push_back(each);
  edits_.packs =
      std::any_of(few.begin(), few.end(), [&](std::uint32_t each) { return is_loose_[home(each)] != 0; });
  if (edits_.packs) append(edits_.side_by_side, few);
}

}  // namespace plumb::detail
