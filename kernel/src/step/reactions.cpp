#include "step/reactions.hpp"

#include <algorithm>
#include <utility>

#include "scene/reels/reels.hpp"

namespace plumb::detail {

Reactions::Reactions(const Scene& scene, const Settings& settings) : gravity_(scene.gravity) {
  if (!settings.tensions) return;
  const std::vector<std::uint8_t> reeled = reeled_rods(scene);
  for (std::uint32_t i = 0; i < scene.rods.size(); ++i) {
    if (!reeled.empty() && reeled[i] != 0) continue;  // what is out pulls as its solver says
    const auto [a, b] = std::pair{scene.rods[i].a, scene.rods[i].b};
    const bool from_a = scene.particles[a].fixed;
    if (!from_a && !scene.particles[b].fixed) continue;
    const RodMass mass = rod_mass(scene, i, mass_model_of(settings));
    held_.push_back({from_a ? a : b, i, from_a ? b : a, from_a ? mass.aa : mass.bb, mass.ab});
  }
  std::stable_sort(held_.begin(), held_.end(),
                   [](const Held& first, const Held& second) { return first.anchor < second.anchor; });
}

std::span<const Reactions::Held> Reactions::at(std::uint32_t anchor) const {
  const auto begin = std::lower_bound(held_.begin(), held_.end(), anchor,
                                      [](const Held& held, std::uint32_t of) { return held.anchor < of; });
  auto end = begin;
  while (end != held_.end() && end->anchor == anchor) ++end;
  return {begin, end};
}

Vec3 Reactions::holding(const Held& held, double pull, Vec3 way, Vec3 velocity, double dt) const {
  const double length = norm(held.way) + norm(way);
  const Vec3 pulled = pull == 0 ? Vec3{} : -pull / length * (held.way + way);
  const Vec3 faster = held.shared == 0 ? Vec3{} : held.shared / dt * (velocity - held.velocity);
  return pulled + faster + held.own / dt * held.anchor_change - (held.shared + held.own) * gravity_;
}

}  // namespace plumb::detail
