#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "plumb/plumb.hpp"

/// Things with bodies, joints, springs and rods that give, of which tests make worlds.
namespace plumb::test {

/// Appends a cube of 1 kg with sides of 0.2 m, and returns its body.
inline std::uint32_t add_crate(Scene& scene, Vec3 center) {
  const std::uint32_t body =
      add_body(scene, {.mass = 1, .center = center, .inertia = {.xx = 0.007, .yy = 0.007, .zz = 0.007}});
  scene.hulls.push_back(box_on_body(body, {.center = center, .half_size = {0.1, 0.1, 0.1}}));
  return body;
}

/// Appends two bodies with capsules, which a ball joint, a limited and driven angle, an alignment, a spring
/// and a torsion hold together.
inline void add_figure(Scene& scene, Vec3 at) {
  const MassProperties limb{.mass = 1, .center = at, .inertia = {.xx = 0.02, .yy = 0.004, .zz = 0.02}};
  MassProperties lower = limb;
  lower.center = at - Vec3{0, 0.4, 0};
  const std::uint32_t a = add_body(scene, limb), b = add_body(scene, lower);
  const Vec3 middle = at - Vec3{0, 0.2, 0};
  add_spherical(scene, point_on_body(scene, a, middle), point_on_body(scene, b, middle));
  const auto way = [&](std::uint32_t body, Vec3 from, Vec3 to) {
    return Direction{point_on_body(scene, body, from), point_on_body(scene, body, to)};
  };
  scene.angles.push_back({.u = way(a, at, at + Vec3{0, 0, 1}),
                          .v = way(b, middle, middle - Vec3{0, 1, 0}),
                          .lower = 1.2,
                          .upper = 1.9,
                          .stiffness = 2,
                          .damping = 0.1});
  scene.alignments.push_back({way(a, at, at + Vec3{1, 0, 0}), way(b, middle, middle - Vec3{0, 1, 0})});
  scene.springs.push_back({.a = point_on_body(scene, a, at + Vec3{0.1, 0, 0}),
                           .b = point_on_body(scene, b, lower.center + Vec3{0.1, 0, 0}),
                           .length = 0.35,
                           .stiffness = 5,
                           .damping = 0.1});
  const Direction axis = way(a, middle, middle + Vec3{1, 0, 0});
  scene.torsions.push_back({.axis = axis,
                            .u = way(a, middle, middle + Vec3{0, 1, 0}),
                            .v = way(b, middle, middle + Vec3{0, 1, 0}),
                            .angle = 0.2,
                            .stiffness = 1,
                            .damping = 0.1});
  for (const std::uint32_t body : {a, b}) {
    const Vec3 center = body == a ? at : lower.center;
    scene.capsules.push_back({.a = point_on_body(scene, body, center + Vec3{0, 0.1, 0}),
                              .b = point_on_body(scene, body, center - Vec3{0, 0.1, 0}),
                              .radius = 0.05});
  }
}

/// Appends a hose that gives and bends, with capsules, and hangs from its first particle if that is fixed.
inline void add_hose(Scene& scene, Vec3 from, bool is_fixed) {
  const auto first = static_cast<std::uint32_t>(scene.particles.size());
  for (std::uint32_t i = 0; i <= 3; ++i)
    scene.particles.push_back(
        {.position = from + Vec3{0.1 * i, 0, 0}, .mass = 0.2, .fixed = is_fixed && i == 0});
  for (std::uint32_t i = first; i < first + 3; ++i) {
    scene.rods.push_back({.a = i, .b = i + 1, .length = 0.1, .law = {.stiffness = 4e3, .damping = 1}});
    scene.capsules.push_back({.a = point_at(i), .b = point_at(i + 1), .radius = 0.02});
  }
  for (std::uint32_t i = first; i < first + 2; ++i)
    scene.bends.push_back({.a = i, .b = i + 1, .c = i + 2, .stiffness = 0.05, .damping = 1e-3});
}

/// Appends a rope of four rods of 0.1 m, with capsules along them if these have a radius (m), and returns its
/// first particle.
inline std::uint32_t add_rope(Scene& scene, Vec3 from, Vec3 way, bool is_anchored, double radius) {
  const auto first = static_cast<std::uint32_t>(scene.particles.size());
  for (std::uint32_t i = 0; i <= 4; ++i)
    scene.particles.push_back(
        {.position = from + 0.1 * i * way, .mass = 0.1, .fixed = is_anchored && i == 0});
  for (std::uint32_t i = first; i < first + 4; ++i) {
    scene.rods.push_back({.a = i, .b = i + 1, .length = 0.1});
    if (radius > 0) scene.capsules.push_back({.a = point_at(i), .b = point_at(i + 1), .radius = radius});
  }
  return first;
}

inline Scene crate(Vec3 center) {
  Scene out;
  add_crate(out, center);
  return out;
}
inline Scene figure(Vec3 at) {
  Scene out;
  add_figure(out, at);
  return out;
}
inline Scene hose(Vec3 from, bool is_fixed) {
  Scene out;
  add_hose(out, from, is_fixed);
  return out;
}

inline Scene floor_alone() {
  Scene scene;
  scene.planes.push_back({.normal = {0, 1, 0}, .offset = 0});
  return scene;
}

template <class F>
void for_jointed_settings(F&& f) {
  for (const Method method : {Method::automatic, Method::direct, Method::relax})
    for (const Gradient gradient : {Gradient::mid, Gradient::old, Gradient::new_})
      for (const unsigned threads : {1u, 2u}) {
        SCOPED_TRACE(std::string(to_string(method)) + ' ' + std::string(to_string(gradient)) + ' ' +
                     std::to_string(threads));
        Settings settings{.method = method, .gradient = gradient, .substeps = 4, .threads = threads};
        settings.tensions = settings.contacts = settings.events = true;
        if (method == Method::relax) settings.stop.sweeps = 30;
        f(settings);
      }
}

}  // namespace plumb::test
