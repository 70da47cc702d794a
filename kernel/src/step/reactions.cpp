#include "step/reactions.hpp"

#include <algorithm>
#include <utility>

#include "scene/reels/reels.hpp"

namespace plumb::detail {

Reactions::Reactions(const Scene& scene, const Settings& settings) : gravity_(scene.gravity) {
  if (!settings.tensions) return;
  add_rods(scene, mass_model_of(settings));
  add_bodies(scene);
  sort();
}

void Reactions::sort() {
  std::stable_sort(held_.begin(), held_.end(),
                   [](const Held& first, const Held& second) { return first.anchor < second.anchor; });
}

void Reactions::add_rods(const Scene& scene, MassModel model) {
  const std::vector<std::uint8_t> reeled = reeled_rods(scene);
  for (std::uint32_t i = 0; i < scene.rods.size(); ++i) {
    if (!reeled.empty() && reeled[i] != 0) continue;  // what is out pulls as its solver says
    add_rod(scene, model, i, [&](std::uint32_t particle) { return scene.particles[particle].fixed; });
  }
}

/// What fixed particles of a body share with each other counts as the own mass of both.
void Reactions::add_bodies(const Scene& scene) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const auto& particles = scene.bodies[i].particles;
    const auto mass = body_mass(scene, i);
    const auto is_fixed = [&](std::size_t k) { return scene.particles[particles[k]].fixed; };
    for (std::size_t j = 0; j < 4; ++j) {
      if (!is_fixed(j)) continue;
      double own = 0;
      for (std::size_t k = 0; k < 4; ++k) own += is_fixed(k) ? mass[j][k] : 0;
      for (std::size_t k = 0; k < 4; ++k) {
        if (is_fixed(k)) continue;
        held_.push_back({particles[j], no_rod, particles[k], std::exchange(own, 0), mass[j][k]});
      }
    }
  }
}

std::span<const Reactions::Held> Reactions::at(std::uint32_t anchor) const {
  const Held *const first = held_.data(), *const last = first + held_.size();
  const Held* const begin = std::lower_bound(
      first, last, anchor, [](const Held& held, std::uint32_t of) { return held.anchor < of; });
  const Held* end = begin;
  while (end != last && end->anchor == anchor) ++end;
  return {begin, end};
}

void Reactions::remove(std::uint32_t anchor, std::span<const std::uint32_t> rods) {
  const auto begin = held_.begin() + (at(anchor).data() - held_.data());
  const auto end = begin + static_cast<std::ptrdiff_t>(at(anchor).size());
  held_.erase(std::remove_if(
                  begin, end,
                  [&](const Held& held) { return std::binary_search(rods.begin(), rods.end(), held.rod); }),
              end);
}

Vec3 Reactions::holding(const Held& held, double pull, Vec3 way, Vec3 velocity, double dt) const {
  const double length = norm(held.way) + norm(way);
  const Vec3 pulled = pull == 0 ? Vec3{} : -pull / length * (held.way + way);
  const Vec3 faster = held.shared == 0 ? Vec3{} : held.shared / dt * (velocity - held.velocity);
  return pulled + faster + held.own / dt * held.anchor_change - (held.shared + held.own) * gravity_;
}

}  // namespace plumb::detail
