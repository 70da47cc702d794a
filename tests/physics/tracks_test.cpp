// A vehicle on tracks: a closed chain of rods runs round two driven wheels and lies on a floor.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>

#include "plumb/plumb.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr double wheel_radius = 0.15, apart = 0.6, thick = 0.015, clear = 0.003;
constexpr double wheel_mass = 3, frame_mass = 10, track_mass = 0.8, torque = 1;  // N m, on each wheel
constexpr double height = wheel_radius + 2 * thick + clear + 0.001;

struct Vehicle {
  Scene scene;
  std::uint32_t frame = 0, wheels[2] = {};
};

/// Returns where on the way round both wheels the track is, at so many m from the top of the first.
Vec3 place_on_track(double way) {
  constexpr double round = wheel_radius + thick + clear, turn = std::numbers::pi * round;
  if (way < apart) return {way, height + round, 0};
  way -= apart;
  if (way < turn) return {apart + round * std::sin(way / round), height + round * std::cos(way / round), 0};
  way -= turn;
  if (way < apart) return {apart - way, height - round, 0};
  way -= apart;
  return {-round * std::sin(way / round), height - round * std::cos(way / round), 0};
}

/// Adds the track, a ring of so many rods.
void add_track(Scene& scene, std::uint32_t rods, const Surface& surface) {
  constexpr double way = 2 * (apart + std::numbers::pi * (wheel_radius + thick + clear));
  const auto first = static_cast<std::uint32_t>(scene.particles.size());
  for (std::uint32_t i = 0; i < rods; ++i) {
    scene.particles.push_back(test::movable(place_on_track(way * i / rods), track_mass / rods));
    const std::uint32_t a = first + i, b = first + (i + 1) % rods;
    scene.rods.push_back({.a = a, .b = b});
    scene.capsules.push_back({.a = point_at(a), .b = point_at(b), .radius = thick, .surface = surface});
  }
}

/// The frame stays upright and in its plane, which alignments with two fixed particles say.
void keep_in_plane(Scene& scene, std::uint32_t frame, Vec3 center) {
  const auto fixed = static_cast<std::uint32_t>(scene.particles.size());
  scene.particles.push_back(test::fixed({}));
  scene.particles.push_back(test::fixed({0, 0, 1}));
  const Direction across{point_at(fixed), point_at(fixed + 1)};
  const auto at = [&](Vec3 place) { return point_on_body(scene, frame, place); };
  scene.alignments.push_back({across, {point_at(fixed), at(center)}, 0.0});
  for (const Vec3 along : {Vec3{1, 0, 0}, Vec3{0, 1, 0}})
    scene.alignments.push_back({across, {at(center), at(center + along)}, 0.0});
}

Vehicle vehicle(std::uint32_t rods) {
  Vehicle out;
  Scene& scene = out.scene;
  const Surface surface{.friction = 1};
  scene.planes.push_back({.surface = surface});
  const Vec3 center{apart / 2, height, 0};
  MassProperties frame = solid_box(frame_mass, {0.6, 0.1, 0.2});
  frame.center = center;
  out.frame = add_body(scene, frame);
  for (int k = 0; k < 2; ++k) {
    const Vec3 axle{k * apart, height, 0}, half{0, 0, 0.05};
    const std::uint32_t wheel = out.wheels[k] =
        add_body(scene, solid_cylinder(wheel_mass, wheel_radius, axle - half, axle + half));
    scene.capsules.push_back({.a = point_on_body(scene, wheel, axle - 2.0 * half),
                              .b = point_on_body(scene, wheel, axle + 2.0 * half),
                              .radius = wheel_radius,
                              .surface = surface});
    add_revolute(scene, out.frame, wheel, axle, {0, 0, 1});
  }
  add_track(scene, rods, surface);
  keep_in_plane(scene, out.frame, center);
  return out;
}

// Wheels of moment I that do not slip roll on the track, which lies still below and runs at twice the speed
// above: 2 T / r = (m_frame + 2 m_wheel + 2 I / R² + 2 m_track) a, with r = R + 2 · thick where the floor
// pushes. Links turn round wheels in steps, and here and there one grips loosely, so that tracks are slower.
// They went half as far where islands' answers to pushes were those of the ground that held them at first.
TEST(Tracks, DriveAVehicle) {
  const double truth = 0.5 * (2 * torque / (wheel_radius + 2 * thick)) /
                       (frame_mass + 3 * wheel_mass + 2 * track_mass);  // m, after a second
  double went = 0;
  for (const std::uint32_t rods : {60u, 70u, 80u}) {
    SCOPED_TRACE(rods);
    const Vehicle of = vehicle(rods);
    World world(of.scene, {.threads = 1});
    world.set_load([&](const LoadState& state, std::span<Vec3> forces) {
      for (const std::uint32_t wheel : of.wheels)
        add_torque(of.scene.bodies[wheel], {0, 0, -torque}, state.positions, forces);
      add_torque(of.scene.bodies[of.frame], {0, 0, 2 * torque}, state.positions, forces);
    });
    const double start = world.pose(of.frame).position.x;
    const StepReport report = test::run(world, test::frame, 60);
    went += (world.pose(of.frame).position.x - start) / 3;
    EXPECT_EQ(report.unsolved + report.elastic_substeps, 0u);
  }
  EXPECT_GT(went, 0.7 * truth);
  EXPECT_LT(went, 1.1 * truth);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
