#include "contact/clusters.hpp"

#include <algorithm>
#include <utility>

#include "contact/linkage/linkage_bounds.hpp"
#include "contact/surroundings.hpp"

namespace plumb::detail {
namespace {

Vec3 extent(const Bounds& bounds) {
  return bounds.high - bounds.low;
}

}  // namespace

void Clusters::start(std::span<LinkageState> islands, double margin) {
  margin_ = margin;
  islands_ = islands;
  find_cell();
  marks_.assign(islands_.size(), 0);
  root_.resize(islands_.size());
  bounds_.assign(islands_.size(), nowhere);
  for (const LinkageState& state : islands_) {
    if (!state.asleep) awake_.push_back(state.number);
    if (!state.linkage->has_shapes()) continue;
    any_shapes_ = true;
    if (state.asleep) bounds_[state.number] = reach(state, 0, 0, margin_);
  }
  list_sleepers();
}

/// A box that is much larger than a cell is compared with all others, so a cell is as large as the mean
/// island.
void Clusters::find_cell() {
  double sum = 0;
  std::size_t count = 0;
  for (const LinkageState& state : islands_) {
    if (state.linkage == nullptr) continue;
    const Vec3 spread = state.linkage->has_shapes() ? extent(reach(state, 0, 0, margin_)) : Vec3{};
    sum += std::max({4 * state.linkage->size(), spread.x, spread.y, spread.z});
    ++count;
  }
  cell_ = count == 0 ? 1 : sum / static_cast<double>(count);
  begun_ = 0;
}

void Clusters::grow(std::span<LinkageState> islands) {
  islands_ = islands;
  marks_.resize(islands_.size(), 0);
  root_.resize(islands_.size());
  bounds_.resize(islands_.size(), nowhere);
}

void Clusters::begin(std::uint32_t island) {
  const LinkageState& state = islands_[island];
  any_shapes_ = any_shapes_ || state.linkage->has_shapes();
  if (!state.asleep) {
    awake_.insert(std::lower_bound(awake_.begin(), awake_.end(), island), island);
  } else if (state.linkage->has_shapes()) {
    bounds_[island] = reach(state, 0, 0, margin_);
    sleepers_.insert(island, bounds_[island]);
  }
  // Cells follow what there is, whatever the world began with.
  if (2 * ++begun_ < islands_.size()) return;
  find_cell();
  list_sleepers();
}

void Clusters::end(std::uint32_t island) {
  wake(island);
  awake_.erase(std::lower_bound(awake_.begin(), awake_.end(), island));
  bounds_[island] = nowhere;
}

/// Puts sleepers into cells, by their bounds. Those that are about to begin have none yet.
void Clusters::list_sleepers() {
  sleepers_.start(cell_, 8 * islands_.size());
  for (const LinkageState& state : islands_)
    if (state.asleep && state.linkage != nullptr && state.linkage->has_shapes() &&
        !bounds_[state.number].is_empty())
      sleepers_.insert(state.number, bounds_[state.number]);
}

void Clusters::wake(std::uint32_t i) {
  LinkageState& state = islands_[i];
  if (!state.asleep || state.linkage == nullptr) return;
  state.asleep = false;
  state.slow_time = 0;
  awake_.insert(std::lower_bound(awake_.begin(), awake_.end(), i), i);
  if (!state.linkage->has_shapes()) return;
  sleepers_.remove(i, bounds_[i]);
  Array<std::uint32_t> near;
  sleepers_.find(bounds_[i], [&](std::uint32_t j) {
    if (may_meet(i, j)) near.push_back(j);
  });
  for (const std::uint32_t j : near) wake(j);
}

/// Returns whether two islands are near each other and have shapes that may touch.
bool Clusters::may_meet(std::uint32_t a, std::uint32_t b) const {
  if (!bounds_[a].overlaps(bounds_[b])) return false;
  const std::span<const Filter> filters = islands_[a].linkage->filters();
  return std::any_of(filters.begin(), filters.end(),
                     [&](const Filter& each) { return may_touch(islands_[b].linkage->filters(), each); });
}

std::uint32_t Clusters::root(std::uint32_t i) {
  while (root_[i] != i) i = root_[i] = root_[root_[i]];
  return i;
}

void Clusters::join(std::uint32_t a, std::uint32_t b) {
  a = root(a), b = root(b);
  if (a != b) root_[std::max(a, b)] = std::min(a, b);
}

void Clusters::sort_members() {
  // The high half of a key is the cluster and the low half the island, so that sorting orders by both.
  order_.clear();
  for (const std::uint32_t i : members_) order_.push_back(std::uint64_t{root(i)} << 32 | i);
  if (!std::is_sorted(order_.begin(), order_.end())) std::sort(order_.begin(), order_.end());
  members_of_.clear();
  starts_.clear();
  for (std::size_t k = 0; k < order_.size(); ++k) {
    if (k == 0 || order_[k] >> 32 != order_[k - 1] >> 32) starts_.push_back(static_cast<std::uint32_t>(k));
    members_of_.push_back(&islands_[order_[k] & 0xffffffff]);
  }
  starts_.push_back(static_cast<std::uint32_t>(members_of_.size()));
}

void Clusters::join_near() {
  if (islands_.size() == 1) return;
  walkers_.start(cell_, 8 * awake_.size());
  ++mark_;
  for (const std::uint32_t i : awake_) {
    if (bounds_[i].is_empty()) continue;
    walkers_.find_and_insert(i, bounds_[i], [&](std::uint32_t j) {
      if (may_meet(i, j)) join(i, j);
    });
    if (sleepers_.is_empty()) continue;
    sleepers_.find(bounds_[i], [&](std::uint32_t j) {
      if (!may_meet(i, j)) return;
      if (marks_[j] != mark_) gather_heap(j);
      join(i, j);
    });
  }
}

/// Adds a sleeper, and all that touch it or each other, to the members.
void Clusters::gather_heap(std::uint32_t sleeper) {
  const auto add = [&](std::uint32_t i) {
    marks_[i] = mark_;
    root_[i] = islands_[i].heap = sleeper;
    members_.push_back(i);
  };
  std::size_t next = members_.size();
  for (add(sleeper); next < members_.size(); ++next)
    sleepers_.find(bounds_[members_[next]], [&, i = members_[next]](std::uint32_t j) {
      if (marks_[j] != mark_ && may_meet(i, j)) add(j);
    });
}

/// Puts an island to sleep, which stands from then on: its velocities were slow, but not nothing.
void Clusters::put_to_sleep(LinkageState& state) {
  state.asleep = true;
  state.slow_time = 0;
  std::fill_n(state.v.begin(), state.linkage->movable(), Vec3{});
  state.energy.reset();
  if (!state.linkage->has_shapes()) return;
  bounds_[state.number] = reach(state, top_speed(state), 0, margin_);
  sleepers_.insert(state.number, bounds_[state.number]);
}

void Clusters::tell(std::uint32_t cluster, Troubles troubles) {
  bool is_first = true;
  for (LinkageState* const state : (*this)[cluster])
    if (!state->asleep) state->take_troubles(troubles, std::exchange(is_first, false));
}

void Clusters::fall_asleep(std::uint32_t i) {
  put_to_sleep(islands_[i]);
  awake_.erase(std::lower_bound(awake_.begin(), awake_.end(), i));
}

std::uint32_t Clusters::settle(std::span<const std::uint8_t> rests) {
  // Neighbours may have woken heaps within the step that are still listed as sleepers. In members_ these
  // follow the others. After a long step they may fall asleep again at once.
  const std::size_t before = awake_.size();
  for (std::size_t k = before; k < members_.size(); ++k)
    if (const std::uint32_t i = members_[k]; !islands_[i].asleep) {
      sleepers_.remove(i, bounds_[i]);
      awake_.push_back(i);
    }
  if (awake_.size() > before) std::sort(awake_.begin(), awake_.end());
  std::uint32_t fell_asleep = 0;
  for (std::uint32_t g = 0; g < rests.size(); ++g) {
    if (rests[g] == 0) continue;
    for (LinkageState* const state : (*this)[g]) {
      if (state->asleep) continue;
      put_to_sleep(*state);
      ++fell_asleep;
    }
  }
  if (fell_asleep > 0) std::erase_if(awake_, [&](std::uint32_t i) { return islands_[i].asleep; });
  return fell_asleep;
}

}  // namespace plumb::detail
