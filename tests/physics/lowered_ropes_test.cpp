// Ropes that hang straight down and are lowered or fall onto ground, which pushes along their rods.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "plumb/inertia.hpp"
#include "plumb/joints.hpp"
#include "plumb/report.hpp"
#include "plumb/settings.hpp"
#include "plumb/world.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr double frame = 1.0 / 60, radius = 0.02, rod = 0.1;
constexpr std::uint32_t rods = 10;

/// Joins particles that stand in line, one to the next, by rods with capsules along them.
void add_rods(Scene& scene, bool is_cable) {
  for (std::uint32_t i = 0; i + 1 < scene.particles.size(); ++i) {
    scene.rods.push_back({.a = i, .b = i + 1});
    scene.rods[i].law.one_sided = is_cable;
    scene.capsules.push_back({.a = point_at(i), .b = point_at(i + 1), .radius = radius});
  }
}

/// A rope from an anchor at the height of 2 m, with capsules along its rods, above a plane at 0.
Scene hanging_rope(bool is_cable) {
  Scene scene;
  scene.planes.push_back({});
  for (std::uint32_t i = 0; i <= rods; ++i)
    scene.particles.push_back({.position = {0, 2 - rod * i, 0}, .mass = 0.1, .fixed = i == 0});
  add_rods(scene, is_cable);
  return scene;
}

/// Says what became of a rope whose anchor was lowered.
struct Landing {
  double deepest = 0, strain = 0;
  std::uint64_t missed = 0;
};

Landing lower(const Scene& scene, const Settings& settings, double to) {
  World world(scene, settings);
  Landing out;
  for (int i = 0; i < 420; ++i) {
    const double share = std::clamp((i - 29) / 240.0, 0.0, 1.0);
    world.move_anchor(0, {0, 2 + share * (to - 2), 0});
    out.missed += world.step(frame).missed_contacts;
    for (std::uint32_t k = 1; k <= rods; ++k) {
      out.deepest = std::max(out.deepest, radius - world.position(k).y);
      const double strain = norm(world.position(k) - world.position(k - 1)) / rod - 1;
      out.strain = std::max(out.strain, scene.rods[k - 1].law.one_sided ? strain : std::abs(strain));
    }
  }
  return out;
}

// As deep as ContactSettings::tolerance lets be, and as exact as solved rods that touch are.
TEST(LoweredRopes, LieDownAndDoNotGoThrough) {
  for (const bool is_cable : {false, true})
    for (const Method method : {Method::automatic, Method::direct})
      for (const std::uint32_t substeps : {1u, 4u}) {
        SCOPED_TRACE((is_cable ? "cables, " : "rods, ") + std::string(to_string(method)) + ", " +
                     std::to_string(substeps));
        const Landing landing = lower(hanging_rope(is_cable), {.method = method, .substeps = substeps}, 0.5);
        EXPECT_LE(landing.deepest, 1e-3);
        EXPECT_LE(landing.strain, 1e-6);
        EXPECT_EQ(landing.missed, 0u);
      }
}

// The floor bears a cable's end as soon as it stands there: what is left hangs from the anchor.
TEST(LoweredRopes, LetTheFloorBearWhatLies) {
  Scene scene = hanging_rope(true);
  for (Particle& particle : scene.particles) particle.position.y -= 1 - radius + 0.01;
  World world(scene, {.tensions = true});
  for (int i = 0; i < 240; ++i) world.step(frame);
  EXPECT_LE(radius - world.position(rods).y, 2e-3);
  EXPECT_NEAR(world.contact_force(ShapeId{.kind = ShapeKind::plane}).y, -0.1 * 9.81, 1e-6);
  EXPECT_NEAR(world.reaction(0).y, 0.1 * 9.81 * (rods - 1), 1e-6);
}

// A rigid rod that starts in the floor, straight below its anchor, has nowhere to go, and reports say so.
TEST(LoweredRopes, AreReportedWhereTheyCannotPart) {
  Scene scene;
  scene.planes.push_back({});
  scene.particles = {{.position = {0, 1.05, 0}, .fixed = true}, {.position = {0, 0.05, 0}, .mass = 1}};
  scene.rods = {{.a = 0, .b = 1}};
  scene.capsules = {{.a = point_at(1), .b = point_at(1), .radius = 0.1}};
  World world(scene);
  EXPECT_GT(world.step(frame).missed_contacts, 0u);
}

/// A straight rope above ground, and what becomes of it.
struct StraightRope {
  std::uint32_t rods = 0;
  double end_mass = 1;  ///< kg; the other particles have 1
  double speed = 0;     ///< m/s, of its anchor, or of a free rope as it is thrown down
  bool is_cable = false, is_free = false, is_on_box = false;
  double tilt = 0;    ///< m aside for one m down
  double gap = 0.03;  ///< m, below its end

  double height() const { return rod * rods + radius + gap; }
  Scene scene() const;
  std::string text() const {
    return std::to_string(rods) + " rods, end of " + std::to_string(end_mass) + " kg, " +
           std::to_string(speed) + " m/s" + (is_cable ? ", cable" : "") + (is_free ? ", free" : "") +
           (is_on_box ? ", box" : "") + ", tilt " + std::to_string(tilt) + ", gap " + std::to_string(gap);
  }
};

Scene StraightRope::scene() const {
  Scene out;
  if (is_on_box)
    out.boxes.push_back({.center = {0, -1, 0}, .half_size = {20, 1, 20}});
  else
    out.planes.push_back({});
  for (std::uint32_t i = 0; i <= rods; ++i) {
    const Vec3 velocity{0, is_free ? -speed : 0, 0};
    out.particles.push_back({.position = {tilt * rod * i, height() - rod * i, 0},
                             .velocity = velocity,
                             .mass = i == rods ? end_mass : 1,
                             .fixed = i == 0 && !is_free});
  }
  add_rods(out, is_cable);
  return out;
}

/// What is left of a rope after some seconds.
struct Remains {
  double deepest = -1, strain = 0, fastest = 0;  ///< m, a share, m/s
  double energy = 0;                             ///< most of a free one's, over what it had, minus one
  double highest = 0;                            ///< m, in the end
  std::uint64_t hash = 0;
  StepReport report;
};

/// Lowers a rope, until a share of it is left above ground, or lets it fall.
Remains land(const StraightRope& rope, const Settings& settings, double seconds = 3) {
  const Scene scene = rope.scene();
  World world(scene, settings);
  Remains out;
  const auto energy = [&] {
    double sum = 0;
    for (std::uint32_t i = 0; i <= rope.rods; ++i)
      sum += scene.particles[i].mass *
             (9.81 * world.position(i).y + 0.5 * dot(world.velocity(i), world.velocity(i)));
    return sum;
  };
  const double before = energy(), low = std::max(0.15, 0.15 * rod * rope.rods);
  double anchor = rope.height();
  for (int i = 0; i < seconds / frame; ++i) {
    anchor = std::max(low, anchor - rope.speed * frame);
    if (!rope.is_free) world.move_anchor(0, {0, anchor, 0});
    out.report += world.step(frame);
    out.highest = 0;
    for (std::uint32_t k = 0; k <= rope.rods; ++k) {
      out.deepest = std::max(out.deepest, radius - world.position(k).y);
      out.highest = std::max(out.highest, world.position(k).y);
      out.fastest = std::max(out.fastest, norm(world.velocity(k)));
      if (k == 0) continue;
      const double length = norm(scene.particles[k].position - scene.particles[k - 1].position);
      const double strain = norm(world.position(k) - world.position(k - 1)) / length - 1;
      out.strain = std::max(out.strain, rope.is_cable ? strain : std::abs(strain));
    }
    out.energy = std::max(out.energy, energy() / before - 1);
  }
  out.hash = world.state_hash();
  return out;
}

/// Ropes of all lengths, with light and heavy ends.
std::vector<StraightRope> straight_ropes() {
  std::vector<StraightRope> out;
  for (const std::uint32_t count : {3u, 10u, 20u, 40u})
    for (const double end_mass : {1.0, 10.0})
      for (const double speed : {0.1, 0.5, 2.0})
        out.push_back({.rods = count, .end_mass = end_mass, .speed = speed});
  return out;
}

// However long they are and however fast they are lowered: no deeper than ropes may lie that were relaxed,
// with lengths that are solved. What buckles moves about as fast as what drives it, and as what falls.
TEST(LoweredRopes, NeverGoThroughTheFloor) {
  for (StraightRope rope : straight_ropes())
    for (const bool is_cable : {false, true})
      for (const bool is_on_box : {false, true}) {
        rope.is_cable = is_cable;
        rope.is_on_box = is_on_box;
        SCOPED_TRACE(rope.text());
        const Remains out = land(rope, {});
        EXPECT_LE(out.deepest, 1e-3);
        EXPECT_LE(out.strain, 1e-6);
        EXPECT_EQ(out.report.unsolved, 0u);
        EXPECT_EQ(out.report.missed_contacts, 0u);
        const double falls = std::sqrt(2 * 9.81 * rope.height());
        EXPECT_LE(out.fastest, 3 * (rope.speed + falls));
      }
}

// What leans by less than a degree answers to pushes along it by next to nothing.
TEST(LoweredRopes, MayLeanALittle) {
  for (StraightRope rope : straight_ropes())
    for (const bool is_cable : {false, true})
      for (const double tilt : {1e-6, 1e-4, 1e-3, 1e-2}) {
        rope.is_cable = is_cable;
        rope.tilt = tilt;
        SCOPED_TRACE(rope.text());
        const Remains out = land(rope, {});
        EXPECT_LE(out.deepest, 1e-3);
        EXPECT_LE(out.strain, is_cable ? 3e-2 : 1e-6);
        EXPECT_EQ(out.report.unsolved, 0u);
      }
}

TEST(LoweredRopes, HaveTheSameBitsOnTwoThreads) {
  for (const StraightRope& rope : straight_ropes()) {
    SCOPED_TRACE(rope.text());
    EXPECT_EQ(land(rope, {.threads = 1}).hash, land(rope, {.threads = 2}).hash);
  }
}

// A rope on its end is in balance, which is unstable: it falls over and lies down, and loses energy alone.
TEST(UprightRopes, FallOverAndLieDown) {
  for (StraightRope rope : straight_ropes())
    for (const double gap : {1e-4, 0.5}) {
      rope.is_free = true;
      rope.gap = gap;
      SCOPED_TRACE(rope.text());
      const Remains out = land(rope, {}, 5);
      EXPECT_LE(out.deepest, 1e-3);
      EXPECT_LE(out.strain, 1e-6);
      EXPECT_LE(out.energy, 1e-6);
      EXPECT_LE(out.highest, radius + 2 * rod);
      EXPECT_EQ(out.report.unsolved, 0u);
    }
}

// They do not fold in one plane, where arches on what sticks would swing on for ever: what lies flat is no
// higher than its radius, and sleeps. Friction ends all sliding.
TEST(UprightRopes, LieFlatAndSleep) {
  for (const std::uint32_t links : {10u, 20u, 40u})
    for (const double thick : {0.005, 0.02})
      for (const double gap : {0.0, 0.3}) {
        SCOPED_TRACE(std::to_string(links) + " rods, " + std::to_string(thick) + ", " + std::to_string(gap));
        const Surface surface{.friction = 0.5};
        Scene scene;
        scene.planes.push_back({.surface = surface});
        for (std::uint32_t i = 0; i <= links; ++i) {
          scene.particles.push_back({.position = {0, thick + gap + 0.05 * i, 0}, .mass = 0.02});
          if (i == 0) continue;
          scene.rods.push_back({.a = i - 1, .b = i});
          scene.capsules.push_back(
              {.a = point_at(i - 1), .b = point_at(i), .radius = thick, .surface = surface});
        }
        World world(scene, {.threads = 1});
        int steps = 1;
        while (world.step(frame).awake_islands > 0 && steps < 600) ++steps;
        EXPECT_LT(steps * frame, 3);
        for (std::uint32_t i = 0; i <= links; ++i) EXPECT_LE(world.position(i).y, 1.1 * thick) << i;
      }
}

// The lengths of relaxed rods are those to where anchors have gone in the step, not to where they were: an
// accuracy of 1 % in length would be a millimetre here, and the anchor moves by 33 mm in a step.
TEST(LoweredRopes, KeepTheirLengthsWhereTheyAreRelaxed) {
  const StraightRope rope{.rods = 80, .speed = 2};
  const Remains out = land(rope, {});
  EXPECT_GT(out.report.block_sweeps, 0u);
  EXPECT_LE(out.strain, 1e-6);
}

/// Returns how deep (m) the lowest corner of a box is below the plane at 0, if its half sizes are all `half`.
double depth_of_box(const Pose& pose, double half) {
  const auto [w, x, y, z] = pose.orientation;
  const double down =
      std::abs(2 * (x * y + w * z)) + std::abs(1 - 2 * (x * x + z * z)) + std::abs(2 * (y * z - w * x));
  return half * down - pose.position.y;
}

// A box that hangs on a rope touches with four corners, each of which could turn it. It goes no deeper than
// the rope itself may.
TEST(LoweredRopes, CarryBoxes) {
  for (const std::uint32_t count : {2u, 3u, 10u, 40u})
    for (const double speed : {0.1, 0.5, 2.0}) {
      SCOPED_TRACE(std::to_string(count) + " rods, " + std::to_string(speed) + " m/s");
      const StraightRope rope{.rods = count, .speed = speed, .gap = 0.25};
      Scene scene = rope.scene();
      scene.capsules.clear();
      MassProperties properties = solid_box(5, {0.2, 0.2, 0.2});
      properties.center = {0, rope.gap + radius - 0.1, 0};
      const std::uint32_t body = add_body(scene, properties);
      add_spherical(scene, point_at(count), point_on_body(scene, body, {0, rope.gap + radius, 0}));
      scene.hulls.push_back(box_on_body(body, {.center = properties.center, .half_size = {0.1, 0.1, 0.1}}));
      World world(scene);
      double fastest = 0, deepest = 0, anchor = rope.height();
      StepReport report;
      for (int i = 0; i < 180; ++i) {
        anchor = std::max(0.25 + 0.5 * rod * count, anchor - speed * frame);
        world.move_anchor(0, {0, anchor, 0});
        report += world.step(frame);
        deepest = std::max(deepest, depth_of_box(world.pose(body), 0.1));
        for (std::uint32_t k = 1; k <= count; ++k) fastest = std::max(fastest, norm(world.velocity(k)));
      }
      EXPECT_LE(deepest, 1e-3);
      EXPECT_EQ(report.unsolved, 0u);
      EXPECT_LE(fastest, 3 * (speed + std::sqrt(2 * 9.81 * rope.height())));
    }
}

// A rope of 60 rods lies on a box and hangs over its edge, with 100 kg below. It answers as little to the
// edge as rods that stand on it, but does not buckle: before, it went in zigzag and threw its load up by 0.36
// m.
TEST(LoweredRopes, OverAnEdgeDoNotThrowTheirLoads) {
  constexpr std::uint32_t links = 60;
  constexpr double length = 0.03, thin = 0.01, lies = 0.9, load = 100;
  for (const double gap : {0.004, 0.012, 0.02}) {
    SCOPED_TRACE(gap);
    Scene scene;
    scene.boxes.push_back({.center = {-5, -5, 0}, .half_size = {5, 5, 2}, .surface = {.friction = 0.4}});
    const double around = std::hypot(thin + gap, length / 2) + 5e-4, arc = around * std::numbers::pi / 2;
    for (std::uint32_t i = 0; i <= links; ++i) {
      const double at = i * length, angle = std::clamp((at - lies) / around, 0.0, std::numbers::pi / 2);
      Particle particle{.mass = i == links ? load : 0.01, .fixed = i == 0};
      particle.position = {around * std::sin(angle) + std::min(at - lies, 0.0),
                           around * std::cos(angle) - std::max(at - lies - arc, 0.0), 0};
      scene.particles.push_back(particle);
    }
    for (std::uint32_t i = 0; i < links; ++i) {
      scene.rods.push_back({.a = i, .b = i + 1});
      scene.capsules.push_back(
          {.a = point_at(i), .b = point_at(i + 1), .radius = thin, .surface = {.friction = 0.4}});
    }
    World world(scene, {.threads = 1});
    for (int i = 0; i < 240; ++i) {
      const Vec3 before = world.position(links);
      const double speed = norm(world.velocity(links));
      world.step(frame);
      const double moved = norm(world.position(links) - before);
      ASSERT_LT(moved, std::max(speed, norm(world.velocity(links))) * frame + 0.05) << i;
    }
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
