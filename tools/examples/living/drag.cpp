// Dragging a figure by its hand: a grab pulls the hand round one circle and a half, as a cursor or a
// controller does, and lets it go at the top. The spring is implicit, so that it is as stiff as one likes.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <plumb/plumb.hpp>

int main() {
  plumb::Scene scene;  // a figure of nine limbs, in metres and kilograms, that hangs by one hand
  const plumb::Vec3 joints[] = {{0.75, 1.45, 0},  {0.45, 1.45, 0}, {0.15, 1.45, 0}, {-0.45, 1.45, 0},
                                {-0.75, 1.45, 0}, {0, 0.95, 0},    {0.1, 0.5, 0},   {0.1, 0.05, 0},
                                {-0.1, 0.5, 0},   {-0.1, 0.05, 0}};
  for (const plumb::Vec3 joint : joints) scene.particles.push_back({.position = joint});
  scene.particles[0].fixed = true;
  const std::uint32_t limbs[][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 4}, {2, 5}, {5, 6}, {6, 7}, {5, 8}, {8, 9}};
  for (const auto& [a, b] : limbs) scene.rods.push_back({.a = a, .b = b, .mass = a == 2 ? 20.0 : 4.0});
  scene.drag = 0.5;
  constexpr std::uint32_t hand = 4;

  for (const double stiffness : {2e3, 1e5, 1e9}) {
    plumb::World world(scene, {.substeps = 4, .tensions = true});
    for (int frame = 0; frame < 300; ++frame) world.step(1.0 / 60);  // it hangs
    const plumb::Vec3 start = world.position(hand);
    const auto grab = world.grab(plumb::Grab::particle(hand, start, stiffness, 0.02 * stiffness));
    double behind = 0, fastest = 0, pull = 0;
    for (int frame = 1; frame <= 180; ++frame) {
      const double angle = 3.14159265358979 * frame / 60;
      const plumb::Vec3 target = start + 0.15 * plumb::Vec3{std::sin(angle), 1 - std::cos(angle), 0};
      world.move_grab(grab, target);
      world.step(1.0 / 60);
      behind = std::fmax(behind, norm(world.position(hand) - target));
      fastest = std::fmax(fastest, norm(world.velocity(hand)));
      pull = std::fmax(pull, norm(world.grab_force(grab)));
    }
    world.release(grab);
    const double top = world.position(hand).y;
    for (int frame = 0; frame < 12; ++frame) world.step(1.0 / 60);
    std::printf("%.0e N/m: at most %.1e m behind, %.1f m/s and %.0f N; let go, it falls by %.2f m\n",
                stiffness, behind, fastest, pull, top - world.position(hand).y);
  }
}
