// A grappling hook: a cable joins who falls to a place above, is reeled in while he swings, and lets go.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <plumb/plumb.hpp>

int main() {
  plumb::Scene scene;
  scene.particles = {{.position = {0, 5, 0}, .velocity = {6, 0, 0}, .mass = 80},  // who jumps
                     {.position = {6, 12, 0}, .fixed = true}};                    // where the hook holds
  plumb::World world(scene, {.tensions = true});
  const auto hero = world.handle<plumb::Particle>(0), hook = world.handle<plumb::Particle>(1);
  for (int frame = 0; frame < 20; ++frame) world.step(1.0 / 60);

  // The cable is as long as they are apart. It pulls from the next step on.
  const auto cable = world.join(hero, hook, {.law = {.one_sided = true}});
  const double length = norm(world.position(1) - world.position(0));
  world.step(1.0 / 60);
  double pull = 0, left = length;
  for (int frame = 1; frame <= 60; ++frame) {
    left -= std::fmin(3, 0.1 * frame) / 60;  // the reel starts softly: a jump of its rate would be a blow
    world.set_length(world.number(cable), left);
    world.step(1.0 / 60);
    pull = std::fmax(pull, world.tension(world.number(cable)));
  }
  std::printf("reeled in from %.2f m to %.2f m, pulled by at most %.0f N; ", length,
              norm(world.position(1) - world.position(0)), pull);

  world.cut(world.number(cable));
  const plumb::Vec3 before = world.velocity(0);
  world.step(1.0 / 60);
  const plumb::Vec3 change = world.velocity(0) - before;
  std::printf("let go, he flies at %.1f m/s, and his speed changes by %.2f m/s^2\n", norm(before),
              60 * norm(change));
}
