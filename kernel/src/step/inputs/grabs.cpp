#include "step/inputs/grabs.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "scene/refuse.hpp"

namespace plumb::detail {

/// Fixed particles are in many islands, or in none.
std::uint32_t Grabs::leader_of(const Point& at, const Places& places) {
  std::size_t best = 4;
  for (std::size_t k = 0; k < 4; ++k) {
    if (at.weights[k] == 0) continue;
    const std::size_t here = places.of(at.particles[k]).size();
    if (best == 4 || (here > 0 && here < places.of(at.particles[best]).size())) best = k;
  }
  return at.particles[best];
}

/// Calls f(solver, shares, whether these are all) for every island that has the place, those that repeat it
/// in lanes included.
template <class F>
void Grabs::for_shares(const Entry& entry, const Places& places, Solvers solvers, F&& f) {
  const Point& at = entry.grab.at;
  const std::uint32_t leader = leader_of(at, places);
  for (const Place& home : places.of(leader)) {
    Solver& solver = *solvers[home.solver];
    std::array<GrabShare, 4> shares{};
    std::size_t found = 0, count = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      if (at.weights[k] == 0) continue;
      ++count;
      for (const Place& place : places.of(at.particles[k])) {
        const bool is_here =
            at.particles[k] == leader
                ? place == home
                : place.solver == home.solver && solver.island_of(place.slot) == solver.island_of(home.slot);
        if (!is_here) continue;
        shares[found++] = {place.slot, at.weights[k]};
        break;
      }
    }
    f(solver, std::span<const GrabShare>(shares.data(), found), found == count);
  }
}

const char* Grabs::refusal_of(const Entry& entry, const Places& places, Solvers solvers) {
  const char* out = "is of nothing that moves";
  bool any = false;
  for_shares(entry, places, solvers, [&](const Solver& solver, std::span<const GrabShare> shares, bool all) {
    std::array<Slot, 4> slots{};
    for (std::size_t i = 0; i < shares.size(); ++i) slots[i] = shares[i].slot;
    const char* const why =
        all ? solver.refuses_grab({slots.data(), shares.size()}) : "is of more than one island";
    if (!any || out == nullptr) out = why;
    any = true;
  });
  return out;
}

bool Grabs::fits(std::uint32_t number, const Places& places, Solvers solvers) const {
  return refusal_of(entries_[number], places, solvers) == nullptr;
}

std::uint32_t Grabs::add(const Grab& grab, const Places& places, Solvers solvers) {
  const std::uint32_t number = numbers_.find(1);
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  const Entry entry{grab, grab.target, false, false, {unknown, unknown, unknown}, unknown};
  if (const char* const why = refusal_of(entry, places, solvers))
    refuse("grab ", number, ": its place ", why);
  numbers_.take(number, 1);
  if (entries_.size() <= number) entries_.resize(number + std::size_t{1});
  entries_[number] = entry;
  ++count_;
  put_in(number, places, solvers);
  return number;
}

void Grabs::end(std::uint32_t number, const Places& places, Solvers solvers) {
  take_out(number, places, solvers);
  numbers_.give_back({&number, 1});
  --count_;
}

void Grabs::take_out(std::uint32_t number, const Places& places, Solvers solvers) const {
  for_places(entries_[number], places, [&](const Place& place) { solvers[place.solver]->end_grab(number); });
}

/// One without stiffness and damping does nothing, and solvers need not know of it.
void Grabs::put_in(std::uint32_t number, const Places& places, Solvers solvers) const {
  const Grab& grab = entries_[number].grab;
  if (grab.stiffness == 0 && grab.damping == 0) return;
  HeldGrab held;
  held.number = number;
  held.stiffness = grab.stiffness;
  held.damping = grab.damping;
  held.target = grab.target;
  for_shares(entries_[number], places, solvers,
             [&](Solver& solver, std::span<const GrabShare> shares, bool) { solver.put_grab(held, shares); });
}

void Grabs::begin_step(double dt, const Places& places, Solvers solvers) {
  for (std::uint32_t i = 0; count_ > 0 && i < entries_.size(); ++i) {
    Entry& entry = entries_[i];
    if (!numbers_.has(i) || (!entry.is_sent && !entry.moves)) continue;
    const Vec3 velocity = entry.is_sent ? (1 / dt) * (entry.goal - entry.grab.target) : Vec3{};
    entry.moves = entry.is_sent;
    for_places(entry, places, [&](const Place& place) { solvers[place.solver]->aim_grab(i, velocity); });
  }
}

/// Reads what a grab did from who moved its place: the contact solver, while an island visits it.
void Grabs::measure(std::uint32_t number, double dt, const Places& places, Solvers solvers) {
  Entry& entry = entries_[number];
  const HeldGrab* held = nullptr;
  for_places(entry, places, [&](const Place& place) {
    const HeldGrab* const here = solvers[place.solver]->held_grab(number);
    if (here != nullptr && (held == nullptr || solvers[place.solver]->has_changing_pieces())) held = here;
  });
  entry.force = held ? (1 / dt) * held->impulse : Vec3{};
  entry.power = held ? held->work / dt : 0;
}

void Grabs::arrive(std::uint32_t number, const Places& places, Solvers solvers) {
  Entry& entry = entries_[number];
  if (entry.is_sent) entry.grab.target = entry.goal;
  entry.is_sent = false;
  for_places(entry, places,
             [&](const Place& place) { solvers[place.solver]->place_grab(number, entry.grab.target); });
}

}  // namespace plumb::detail
