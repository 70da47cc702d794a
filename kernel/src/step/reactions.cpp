#include "step/reactions.hpp"

#include <algorithm>
#include <utility>

#include "scene/reels/reels.hpp"

namespace plumb::detail {

Reactions::Reactions(const Scene& scene, const Settings& settings) : gravity_(scene.gravity) {
  if (!settings.tensions) return;
  add_rods(scene, mass_model_of(settings));
  for (std::uint32_t i = 0; i < scene.bodies.size(); ++i)
    add_body(scene, i, [&](std::uint32_t particle) { return scene.particles[particle].fixed; });
  std::stable_sort(held_.begin(), held_.end(), comes_first);
}

void Reactions::add_rods(const Scene& scene, MassModel model) {
  const Array<std::uint8_t> reeled = reeled_rods(scene);
  for (std::uint32_t i = 0; i < scene.rods.size(); ++i) {
    if (!reeled.empty() && reeled[i] != 0) continue;  // what is out pulls as its solver says
    add_rod(scene, model, i, [&](std::uint32_t particle) { return scene.particles[particle].fixed; });
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

void Reactions::remove_bodies_of(std::span<const std::uint32_t> particles) {
  std::erase_if(held_, [&](const Held& held) {
    return held.rod == no_rod && std::binary_search(particles.begin(), particles.end(), held.other);
  });
}

Vec3 Reactions::holding(const Held& held, double pull, Vec3 way, Vec3 velocity, double dt) const {
  const double length = norm(held.way) + norm(way);
  const Vec3 pulled = pull == 0 ? Vec3{} : -pull / length * (held.way + way);
  const Vec3 faster = held.shared == 0 ? Vec3{} : held.shared / dt * (velocity - held.velocity);
  return pulled + faster + held.own / dt * held.anchor_change - (held.shared + held.own) * gravity_;
}

}  // namespace plumb::detail
