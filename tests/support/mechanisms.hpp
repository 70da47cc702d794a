#pragma once

#include <cmath>
#include <cstdint>

#include "support/bodies.hpp"

/// Mechanisms of the literature.
namespace plumb::test {

/// Andrews' squeezer mechanism (Schiehlen 1990), with the numbers of the test set of initial value problems
/// (Mazzia, Magherini 2008), which Hairer and Wanner (1996) use, too: lengths in m, masses in kg.
struct Andrews {
  static constexpr double d = 28e-3, da = 115e-4, e = 2e-2, ea = 1421e-5, rr = 7e-3, ra = 92e-5, ss = 35e-3,
                          sa = 1874e-5, sb = 1043e-5, sc = 18e-3, sd = 2e-2, ta = 2308e-5, tb = 916e-5,
                          u = 4e-2, ua = 1228e-5, ub = 449e-5, zf = 2e-2, zt = 4e-2, fa = 1421e-5;
  static constexpr double masses[7] = {.04325, .00365, .02373, .00706, .07050, .00706, .05498};
  static constexpr double inertias[7] = {2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7,
                                         1.169e-5, 5.667e-7, 1.912e-5};
  static constexpr double stiffness = 4530, rest = 7785e-5, torque = 33e-3;
  static constexpr Vec3 a{-.06934, -.00227, 0}, b{-.03635, .03273, 0}, c{.014, .072, 0};
  static constexpr double duration = 0.03;  ///< s

  /// rad: beta, theta, gamma, phi, delta, Omega and epsilon, at first and after that duration.
  static constexpr double start[7] = {-.0617138900142764496, 0,
                                      .455279819163070380,   .222668390165885885,
                                      .487364979543842550,   -.222668390165885885,
                                      1.23054744454982119};
  static constexpr double end[7] = {15.81077119629904,   -15.75637105984298, 0.04082224013073101,
                                    -0.5347301163226948, 0.5244099658805304, 0.5347301163226948,
                                    1.048080741042263};

  /// Where the joints and the end of the spring are at some angles.
  struct Places {
    Vec3 crank, middle, lower, upper, spring;
  };
  static Places places(const double (&q)[7]) {
    const auto [beta, theta, gamma, phi, delta, omega, epsilon] = q;
    (void)phi, (void)omega;
    const Vec3 crank{rr * std::cos(beta), rr * std::sin(beta), 0};
    return {.crank = crank,
            .middle = crank - Vec3{d * std::cos(beta + theta), d * std::sin(beta + theta), 0},
            .lower = a + Vec3{zt * std::cos(delta), zt * std::sin(delta), 0},
            .upper = a + Vec3{u * std::sin(epsilon), -u * std::cos(epsilon), 0},
            .spring = b + Vec3{sd * std::cos(gamma) + sc * std::sin(gamma),
                               sd * std::sin(gamma) - sc * std::cos(gamma), 0}};
  }

  /// Particles of the crank's end, of the joint of three bars, of those below and above, and of the spring.
  enum Particle : std::uint32_t { origin, at_a, at_b, at_c, side, axis, crank, middle, lower, upper, spring };

  /// The mechanism of rods: seven, with mass as the bodies have it, and two that make a triangle.
  static Scene of_rods() {
    const Places at = places(start);
    Scene scene;
    scene.gravity = {};
    for (const Vec3 place : {Vec3{}, a, b, c, Vec3{0.01, 0, 0}, Vec3{0, 0, 0.01}})
      scene.particles.push_back(fixed(place));
    for (const Vec3 place : {at.crank, at.middle, at.lower, at.upper, at.spring})
      scene.particles.push_back(movable(place, 0));
    const auto bar = [&](std::uint32_t from, std::uint32_t to, int body, double length, double center) {
      scene.rods.push_back(
          {.a = from, .b = to, .mass = masses[body], .center = center / length, .inertia = inertias[body]});
    };
    bar(origin, crank, 0, rr, ra);
    bar(crank, middle, 1, d, da);
    bar(lower, middle, 3, e, e - ea);
    bar(at_a, lower, 4, zt, std::hypot(ta, tb));
    bar(upper, middle, 5, zf, zf - fa);
    bar(at_a, upper, 6, u, std::hypot(ua, ub));
    // The triangle turns about a fixed corner, so that its inertia may lie along one side.
    scene.rods.push_back({.a = at_b,
                          .b = middle,
                          .mass = masses[2] / 2,
                          .center = std::hypot(sa, sb) / ss,
                          .inertia = inertias[2] / 2});
    scene.rods.push_back({.a = at_b,
                          .b = spring,
                          .mass = masses[2] / 2,
                          .center = std::hypot(sa, sb) / std::hypot(sc, sd),
                          .inertia = inertias[2] / 2});
    scene.rods.push_back({.a = middle, .b = spring});
    scene.springs.push_back(
        {.a = point_at(at_c), .b = point_at(spring), .length = rest, .stiffness = stiffness});
    scene.torsions.push_back({.axis = {point_at(origin), point_at(axis)},
                              .u = {point_at(origin), point_at(side)},
                              .v = {point_at(origin), point_at(crank)},
                              .torque = torque});
    return scene;
  }

  /// The mechanism of seven bodies and ten hinges, whose constraints forbid more than once what leaves the
  /// plane.
  static Scene of_bodies() {
    const auto [beta, theta, gamma, phi, delta, omega, epsilon] = start;
    const Places at = places(start);
    const auto along = [](double angle, double by) {
      return Vec3{by * std::cos(angle), by * std::sin(angle), 0};
    };
    const Vec3 centers[7] = {
        along(beta, ra),
        at.crank - along(beta + theta, da),
        b + Vec3{sa * std::sin(gamma) + sb * std::cos(gamma), sb * std::sin(gamma) - sa * std::cos(gamma), 0},
        at.lower + Vec3{(e - ea) * std::sin(phi + delta), (ea - e) * std::cos(phi + delta), 0},
        a + along(delta, ta) + Vec3{-tb * std::sin(delta), tb * std::cos(delta), 0},
        at.upper + along(omega + epsilon, zf - fa),
        a + Vec3{ua * std::sin(epsilon) - ub * std::cos(epsilon),
                 -ua * std::cos(epsilon) - ub * std::sin(epsilon), 0}};
    Scene scene;
    scene.gravity = {};
    const std::uint32_t ground = add_fixed_body(scene);
    scene.particles.push_back(fixed(c));
    const auto anchor = static_cast<std::uint32_t>(scene.particles.size() - 1);
    std::uint32_t k[7];
    for (int i = 0; i < 7; ++i) {
      const double about = inertias[i];
      k[i] = add_body(scene, {.mass = masses[i], .center = centers[i], .inertia = {about, about, about}});
    }
    const auto hinge = [&](std::uint32_t one, std::uint32_t other, Vec3 place) {
      add_revolute(scene, one, other, place, {0, 0, 1});
    };
    hinge(ground, k[0], {});
    hinge(k[0], k[1], at.crank);
    for (const int other : {2, 3, 5}) hinge(k[1], k[other], at.middle);
    hinge(ground, k[2], b);
    hinge(k[3], k[4], at.lower);
    hinge(ground, k[4], a);
    hinge(k[5], k[6], at.upper);
    hinge(ground, k[6], a);
    scene.springs.push_back({.a = point_at(anchor),
                             .b = point_on_body(scene, k[2], at.spring),
                             .length = rest,
                             .stiffness = stiffness});
    const Point origin_there = point_on_body(scene, ground, {});
    scene.torsions.push_back({.axis = {origin_there, point_on_body(scene, ground, {0, 0, 1})},
                              .u = {origin_there, point_on_body(scene, ground, {1, 0, 0})},
                              .v = {point_on_body(scene, k[0], {}), point_on_body(scene, k[0], at.crank)},
                              .torque = torque});
    return scene;
  }
};

/// The stiff flyball governor: problem A05 of the library of multibody benchmarks (González, Dopico, Lugrís,
/// Cuadrado 2006). Arms that hang from a turning shaft lift a collar, which spring-dampers hold at their
/// middles. Shaft and arms are bars of 1 m x 1 cm x 1 cm, the collar a cube of 10 cm, all of 3000 kg/m³. Arms
/// start 30 degrees below the horizon, springs at rest. That arms spin about themselves, with 1e-6 of their
/// inertia, is left out.
struct Governor {
  static constexpr double arm = 1, bar = 0.01, arm_mass = 0.3, ball = 5, collar_mass = 3, collar_size = 0.1,
                          stiffness = 8e5, damping = 4e4, tilt = 60 * degree, spin = 6.283185307179586;
  enum Particle : std::uint32_t { top, bottom, front, right_hand, collar, ball_a, ball_b };

  /// `stiff` takes rigid rods instead of the spring-dampers.
  static Scene scene(bool rigid) {
    Scene out;
    const double side = arm * std::sin(tilt), down = arm * std::cos(tilt);
    out.particles = {fixed({0, 0, 0}), fixed({0, -1, 0})};
    const auto turning = [&](Vec3 at, double mass) {
      out.particles.push_back(movable(at, mass, cross({0, spin, 0}, at)));
    };
    turning({0.1, 0, 0}, 0);  // front
    turning({0, 0, 0.1}, 0);  // right hand
    turning({0, -down, 0}, collar_mass);
    turning({side, -down, 0}, ball);
    turning({-side, -down, 0}, ball);
    // The collar turns with the shaft, whatever its height.
    MassProperties turning_parts = solid_box(arm_mass, {bar, arm, bar});
    turning_parts.inertia.yy += collar_mass * collar_size * collar_size / 6;
    add_body(out, {top, bottom, front, right_hand}, turning_parts);
    for (const std::uint32_t end : {ball_a, ball_b}) {
      out.rods.push_back(
          {.a = top, .b = end, .mass = arm_mass, .inertia = arm_mass * (arm * arm + bar * bar) / 12});
      out.alignments.push_back({{point_at(top), point_at(end)}, {point_at(top), point_at(right_hand)}});
      const Point middle{{top, end}, {0.5, 0.5}};
      if (!rigid)
        out.springs.push_back({.a = point_at(collar),
                               .b = middle,
                               .length = arm / 2,
                               .stiffness = stiffness,
                               .damping = damping});
    }
    for (const Vec3 across : {Vec3{1, 0, 0}, Vec3{0, 0, 1}}) {
      out.particles.push_back(fixed(across));
      const auto at = static_cast<std::uint32_t>(out.particles.size() - 1);
      out.alignments.push_back({{point_at(top), point_at(collar)}, {point_at(top), point_at(at)}});
    }
    if (rigid) {
      // The middles of arms become particles, which take no mass from them.
      for (const std::uint32_t end : {ball_a, ball_b}) {
        const auto middle = static_cast<std::uint32_t>(out.particles.size());
        const Vec3 at = 0.5 * out.particles[end].position;
        out.particles.push_back(movable(at, 1e-3, cross({0, spin, 0}, at)));
        out.pins.push_back({point_at(middle), {{top, end}, {0.5, 0.5}}});
        out.rods.push_back({.a = collar, .b = middle, .length = arm / 2});
      }
    }
    return out;
  }
};

/// A row of N four-bar linkages: problem A02 of the same library. 2N + 1 bars of 1 m and 1 kg; posts stand on
/// the ground 1 m apart, and bars join their ends. The first end starts at 1 m/s, and all turn over and over.
/// Each time they lie level, the linkage could fold in N + 1 ways, since constraints are redundant there.
struct FourBars {
  static constexpr double length = 1, mass = 1, speed = 1;

  /// Ends of posts are the particles n + 1 to 2n + 1.
  static Scene scene(std::uint32_t n) {
    Scene out;
    for (std::uint32_t i = 0; i <= n; ++i) out.particles.push_back(fixed({i * length, 0, 0}));
    for (std::uint32_t i = 0; i <= n; ++i)
      out.particles.push_back(movable({i * length, length, 0}, 0, {speed, 0, 0}));
    for (std::uint32_t i = 0; i <= n; ++i) out.rods.push_back({.a = i, .b = n + 1 + i, .mass = mass});
    for (std::uint32_t i = 0; i < n; ++i) out.rods.push_back({.a = n + 1 + i, .b = n + 2 + i, .mass = mass});
    return out;
  }

  /// Returns where the end of the first post is at time t (s), to 1e-10 m over 20 s: a pendulum, whose angle
  /// from the vertical is followed by Runge-Kutta steps of 0.25 ms.
  static Vec3 first_end(std::uint32_t n, double t) {
    const double posts = n + 1, bars = n;
    const double pull = earth / length * (posts / 2 + bars) / (posts / 3 + bars);
    const int steps = static_cast<int>(std::ceil(t / 2.5e-4));
    const long double h = t / steps;
    long double angle = 0, turn = speed / length;
    const auto bent = [&](long double at) { return pull * std::sin(at); };
    for (int i = 0; i < steps; ++i) {
      const long double v1 = turn, a1 = bent(angle), v2 = turn + h / 2 * a1, a2 = bent(angle + h / 2 * v1),
                        v3 = turn + h / 2 * a2, a3 = bent(angle + h / 2 * v2), v4 = turn + h * a3,
                        a4 = bent(angle + h * v3);
      angle += h / 6 * (v1 + 2 * v2 + 2 * v3 + v4);
      turn += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    }
    return {length * static_cast<double>(std::sin(angle)), length * static_cast<double>(std::cos(angle)), 0};
  }
};

}  // namespace plumb::test
