#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "support/bodies.hpp"
#include "support/meshes.hpp"

/// What tests of boxes and other hulls that stand and fall share.
namespace plumb::test {

/// Adds a box of half sizes `half` as a body with a hull. Its body.
inline std::uint32_t add_box(Scene& scene, Vec3 center, Vec3 half, double mass, Surface surface) {
  MassProperties box = solid_box(mass, 2.0 * half);
  box.center = center;
  const std::uint32_t body = add_body(scene, box);
  scene.hulls.push_back(box_on_body(body, {.center = center, .half_size = half, .surface = surface}));
  return body;
}

/// Adds a regular tetrahedron of 1 kg, turned at random, whose corners are `size` sqrt(3) m from its middle.
inline std::uint32_t add_tetrahedron(Scene& scene, Vec3 middle, double size, std::mt19937& random) {
  std::normal_distribution<double> normal;
  const auto any = [&] { return Vec3{normal(random), normal(random), normal(random)}; };
  const auto unit = [](Vec3 v) { return (1 / norm(v)) * v; };
  const Vec3 u = unit(any()), v = unit(cross(u, any())), w = cross(u, v);
  const double inertia = 0.4 * size * size;
  const std::uint32_t body = add_body(
      scene, {.mass = 1, .center = middle, .inertia = {.xx = inertia, .yy = inertia, .zz = inertia}});
  Hull hull{.body = body};
  for (const Vec3 at : {Vec3{1, 1, 1}, Vec3{1, -1, -1}, Vec3{-1, 1, -1}, Vec3{-1, -1, 1}})
    hull.points.push_back(middle + size * (at.x * u + at.y * v + at.z * w));
  scene.hulls.push_back(hull);
  return body;
}

/// Level ground at height 0 of every kind that a floor is made of, with its name.
inline std::vector<std::pair<std::string, Scene>> level_grounds(Surface surface) {
  std::vector<std::pair<std::string, Scene>> out(3);
  out[0].first = "plane";
  out[0].second.planes.push_back({.surface = surface});
  out[1].first = "box";
  out[1].second.boxes.push_back({.center = {0, -1, 0}, .half_size = {5, 1, 5}, .surface = surface});
  out[2].first = "mesh";
  Random random(83);
  const Mesh floor = shuffled_floor(60, 0.13, random);
  out[2].second.meshes.push_back({floor.vertices, floor.triangles, false, surface});
  return out;
}

/// Where a body's centre of mass is.
inline Vec3 middle_of(const Scene& scene, const World& world, std::uint32_t body) {
  return place_of(world, point_on_body(scene, body, scene.bodies[body].center));
}

}  // namespace plumb::test
