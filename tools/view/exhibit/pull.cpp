#include "view/exhibit/pull.hpp"

#include <cmath>

#include "plumb/measures.hpp"
#include "view/exhibit/carry.hpp"

namespace plumb::view {
namespace {

constexpr double gives = 0.01;    // of the diagonal
constexpr double gravity = 9.81;  // m/s², whatever the scene's is

double mass_of_island(const Scene& scene, const std::vector<std::uint32_t>& islands, std::uint32_t particle) {
  const std::vector<double> masses = lumped_masses(scene);
  double out = 0;
  for (std::size_t i = 0; i < islands.size(); ++i)
    if (islands[i] == islands[particle] && std::isfinite(masses[i])) out += masses[i];
  return out;
}

}  // namespace

Grip::Grip(Hand hand, World& world, const Scene& scene, const std::vector<std::uint32_t>& islands)
    : hand_(hand) {
  if (scene.particles[hand.particle].fixed) return;
  const double diagonal = bounding_diagonal(scene);
  const double mass = mass_of_island(scene, islands, hand.particle);
  const double stiffness = mass * gravity / (gives * (diagonal > 0 ? diagonal : 1));
  grab_ = world.grab(Grab::particle(hand.particle, world.position(hand.particle), stiffness,
                                    2 * std::sqrt(stiffness * mass)));
}

void Grip::move(World& world, const Scene& scene, Vec3 target) {
  Grip moved = *this;
  moved.hand_.target = target;
  moved.pull(world, scene);
  *this = moved;
}

bool Grip::pull(World& world, const Scene& scene) {
  if (grab_) {
    if (!world.has(*grab_)) return false;
    world.move_grab(*grab_, hand_.target);
  } else {
    if (!scene.particles[hand_.particle].fixed) return false;
    const Vec3 at = world.position(hand_.particle);
    world.move_anchor(hand_.particle, at + 0.2 * (hand_.target - at));
  }
  return true;
}

void Grip::let_go(World& world) {
  if (grab_ && world.has(*grab_)) world.release(*grab_);
  grab_.reset();
}

}  // namespace plumb::view
