// An arm of two rods waves as key frames say, with a weight in its hand. Then its muscles let go.
#include <cmath>
#include <cstdio>
#include <plumb/plumb.hpp>
#include <vector>

int main() {
  plumb::Scene scene;  // shoulder, what is up and beside it, elbow, hand
  scene.particles = {{.position = {0, 0, 0}, .fixed = true},
                     {.position = {0, 1, 0}, .fixed = true},
                     {.position = {0, 0, 1}, .fixed = true},
                     {.position = {0.3, 0, 0}},
                     {.position = {0.6, 0, 0}, .mass = 1}};
  scene.rods = {{.a = 0, .b = 3, .mass = 2}, {.a = 3, .b = 4, .mass = 1.5}};
  const auto way = [](unsigned from, unsigned to) {
    return plumb::Direction{plumb::point_at(from), plumb::point_at(to)};
  };
  for (const unsigned joint : {0u, 3u})  // both turn about z: from up, and from the upper arm
    scene.torsions.push_back({.axis = way(0, 2),
                              .u = joint == 0 ? way(0, 1) : way(0, 3),
                              .v = joint == 0 ? way(0, 3) : way(3, 4)});
  const plumb::KeyFrames wave({{0, {-1.57, 0}}, {1, {-0.5, 1}}, {1.5, {-0.8, -0.5}}, {2, {-0.5, 1}}});

  plumb::World world(scene, {.substeps = 4});
  std::vector<double> pose(2);
  double farthest = 0;
  for (int frame = 0; frame < 240; ++frame) {
    wave.pose_at(world.time() + 0.5 / 60, pose);
    const double strength = world.time() < 2 ? 1 : 0;
    for (unsigned i = 0; i < 2; ++i) {
      world.set_torsion(i, {.angle = pose[i], .stiffness = 400 * strength, .damping = 1 + 30 * strength});
    }
    world.step(1.0 / 60);
    if (strength > 0) farthest = std::fmax(farthest, std::fabs(world.torsion_angle(0) - pose[0]));
    if (frame == 119) std::printf("the hand is %.2f m up, ", world.position(4).y);
  }
  std::printf("never more than %.2f rad from its pose; let go, it is at %.2f m\n", farthest,
              world.position(4).y);
}
