#include "view/exhibit/pull.hpp"

namespace plumb::view {

void pull(World& world, const Scene& scene, const Hand& hand) {
  const Vec3 way = hand.target - world.position(hand.particle);
  if (scene.particles[hand.particle].fixed) {
    world.move_anchor(hand.particle, hand.target - 0.8 * way);
    return;
  }
  const double stiffness = 0.25 * hand.mass / (hand.dt * hand.dt);
  const double damping = 0.5 * hand.mass / hand.dt;
  world.set_force(hand.particle, stiffness * way - damping * world.velocity(hand.particle));
}

void let_go(World& world, const Scene& scene, const Hand& hand) {
  if (!scene.particles[hand.particle].fixed) world.set_force(hand.particle, {});
}

}  // namespace plumb::view
