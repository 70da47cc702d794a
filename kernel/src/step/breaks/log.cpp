#include "step/breaks/log.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace plumb::detail {

void Log::push_addition(Split split) {
  const Addition& added = split.added.front();
  const std::size_t count = added.scene.particles.size(), first = added.first.particles;
  groups_.resize(std::max(groups_.size(), first + count), of_scene);
  Members& members = members_[++last_group_];
  members.left = static_cast<std::uint32_t>(count);
  members.particles.resize(count);
  std::iota(members.particles.begin(), members.particles.end(), added.first.particles);
  for (const std::uint32_t particle : members.particles) groups_[particle] = last_group_;
  push(std::move(split), last_group_);
}

auto Log::join(std::span<const std::uint32_t> particles) -> Group {
  Array<Group> of;
  for (const std::uint32_t particle : particles) of.push_back(group_of(particle));
  std::sort(of.begin(), of.end());
  of.erase(std::unique(of.begin(), of.end()), of.end());
  if (of.empty()) return of_scene;
  return std::accumulate(of.begin() + 1, of.end(), of.front(),
                         [this](Group one, Group other) { return merge(one, other); });
}

/// Lets one group be part of the other, the smaller one of the larger.
auto Log::merge(Group one, Group other) -> Group {
  if (one != of_scene && members_.at(one).particles.size() < members_.at(other).particles.size())
    std::swap(one, other);
  const Members gone = std::move(members_.at(other));
  members_.erase(other);
  for (const std::uint32_t particle : gone.particles)
    if (groups_[particle] == other) groups_[particle] = one;
  if (one == of_scene) return one;
  Members& members = members_.at(one);
  members.entries.insert(members.entries.end(), gone.entries.begin(), gone.entries.end());
  members.particles.insert(members.particles.end(), gone.particles.begin(), gone.particles.end());
  members.left += gone.left;
  return one;
}

void Log::push(Split split, Group group) {
  entries_.emplace_hint(entries_.end(), ++last_, std::move(split));
  if (group != of_scene) members_.at(group).entries.push_back(last_);
}

void Log::push_removal(Split split, std::span<const std::uint32_t> particles) {
  const Group group = join(particles);
  push(std::move(split), group);
  for (const std::uint32_t particle : particles)
    if (particle < groups_.size()) groups_[particle] = of_scene;
  if (group == of_scene) return;
  Members& members = members_.at(group);
  members.left -= static_cast<std::uint32_t>(particles.size());
  if (members.left > 0) return;
  for (const Serial each : members.entries) entries_.erase(each);
  members_.erase(group);
}

Array<Split> Log::splits() const {
  Array<Split> out;
  for (const auto& [serial, split] : entries_) out.push_back(split);
  return out;
}

bool Log::is_of(std::span<const Split> splits) const {
  return std::equal(entries_.begin(), entries_.end(), splits.begin(), splits.end(),
                    [](const auto& each, const Split& split) { return each.second == split; });
}

}  // namespace plumb::detail
