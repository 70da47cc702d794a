#include "step/breaks/log.hpp"

#include <algorithm>
#include <utility>

namespace plumb::detail {

Log::Serial Log::put(Split split) {
  entries_.emplace_hint(entries_.end(), ++last_, Entry{.split = std::move(split)});
  return last_;
}

void Log::push(Split split) {
  const Serial serial = put(std::move(split));
  Entry& entry = entries_.at(serial);
  for (const Addition& added : entry.split.added) {
    entry.left = static_cast<std::uint32_t>(added.scene.particles.size());
    const std::size_t first = added.first.particles, end = first + entry.left;
    if (end > additions_.size()) additions_.resize(end, none);
    std::fill(additions_.begin() + static_cast<std::ptrdiff_t>(first),
              additions_.begin() + static_cast<std::ptrdiff_t>(end), serial);
  }
}

void Log::keep(std::span<const std::uint32_t> particles, const Edits& edits) {
  for (const std::uint32_t particle : particles) keep(particle);
  for (const auto& [particle, mass] : edits.masses) keep(particle);
}

void Log::keep(std::uint32_t particle) {
  if (const Serial serial = addition_of(particle); serial != none) entries_.at(serial).is_kept = true;
}

void Log::push_removal(Split split, std::span<const std::uint32_t> particles) {
  const Serial of = addition_of(particles.front());
  const Serial serial = put(std::move(split));
  for (const std::uint32_t particle : particles)
    if (particle < additions_.size()) additions_[particle] = none;
  if (of == none) return;
  Entry& added = entries_.at(of);
  added.removals.push_back(serial);
  added.left -= static_cast<std::uint32_t>(particles.size());
  if (added.left > 0 || added.is_kept) return;
  for (const Serial each : added.removals) entries_.erase(each);
  entries_.erase(of);
}

std::vector<Split> Log::splits() const {
  std::vector<Split> out;
  for (const auto& [serial, entry] : entries_) out.push_back(entry.split);
  return out;
}

bool Log::is_of(std::span<const Split> splits) const {
  return std::equal(entries_.begin(), entries_.end(), splits.begin(), splits.end(),
                    [](const auto& each, const Split& split) { return each.second.split == split; });
}

}  // namespace plumb::detail
