#include "step/state/events.hpp"

#include <algorithm>
#include <tuple>

namespace plumb::detail {
namespace {

Event::Kind event_of(Problem::Kind trouble) {
  switch (trouble) {
    case Problem::Kind::frozen:
      return Event::Kind::frozen;
    case Problem::Kind::unsolved:
      return Event::Kind::unsolved;
    case Problem::Kind::elastic:
      return Event::Kind::elastic;
    case Problem::Kind::inaccurate:
      return Event::Kind::inaccurate;
    case Problem::Kind::capped:
    case Problem::Kind::stretched:  // which is no trouble of a step
      break;
  }
  return Event::Kind::capped;
}

}  // namespace

void Events::grow(std::size_t particles, std::size_t rods) {
  if (particles > is_head_.size()) {
    is_head_.resize(particles, 0);
    was_asleep_.resize(particles, 0);
  }
  if (rods > was_broken_.size()) was_broken_.resize(rods, 0);
}

void Events::set_head(std::uint32_t particle, bool is_asleep) {
  was_asleep_[particle] = is_asleep ? 1 : 0;
  seen_.reset();
  if (is_head(particle)) return;
  is_head_[particle] = 1;
  heads_.insert(std::lower_bound(heads_.begin(), heads_.end(), particle), particle);
}

void Events::remove_head(std::uint32_t particle) {
  was_asleep_[particle] = 0;
  if (!is_head(particle)) return;
  is_head_[particle] = 0;
  heads_.erase(std::lower_bound(heads_.begin(), heads_.end(), particle));
}

void Events::go_on_from(const Events& from) {
  list_ = from.list_;
  was_broken_ = from.was_broken_;
  for (const std::uint32_t head : heads_) was_asleep_[head] = from.was_asleep_[head];
  seen_.reset();
}

void Events::reserve(std::size_t weak_rods, std::size_t tasks) {
  const std::size_t most = heads_.size() + weak_rods + trouble_kinds.size() * tasks;
  if (most > list_.capacity()) list_.reserve(std::max(most, 2 * list_.capacity()));
  if (tasks > troubles_.capacity()) troubles_.reserve(std::max(tasks, 2 * troubles_.capacity()));
}

void Events::add_troubles(Troubles troubles, std::uint32_t head) {
  for_troubles(troubles, [&](Problem::Kind kind) { list_.push_back({event_of(kind), head}); });
}

void Events::sort() {
  std::sort(list_.begin(), list_.end(), [](const Event& a, const Event& b) {
    return std::tie(a.kind, a.rod, a.particle) < std::tie(b.kind, b.rod, b.particle);
  });
}

void visit_members(Archive& archive, Event& of) {
  auto& [kind, particle, rod, strength] = of;
  archive(kind, particle, rod, strength);
}

}  // namespace plumb::detail

namespace plumb {

std::string_view to_string(Event::Kind kind) {
  switch (kind) {
    case Event::Kind::woke:
      return "woke";
    case Event::Kind::fell_asleep:
      return "fell_asleep";
    case Event::Kind::broke:
      return "broke";
    case Event::Kind::frozen:
      return "frozen";
    case Event::Kind::unsolved:
      return "unsolved";
    case Event::Kind::elastic:
      return "elastic";
    case Event::Kind::inaccurate:
      return "inaccurate";
    case Event::Kind::capped:
      break;
  }
  return "capped";
}

}  // namespace plumb
