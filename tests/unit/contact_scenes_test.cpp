// The scenes in which things touch: standing humanoids, balls, a stick in a box.
#include <gtest/gtest.h>

#include <cmath>
#include <span>

#include "contact/shapes/touch.hpp"
#include "plumb/error.hpp"
#include "plumb/measures.hpp"
#include "scenes/generators/contacts.hpp"
#include "scenes/generators/generators.hpp"
#include "scenes/humanoid/humanoid.hpp"
#include "scenes/humanoid/limbs.hpp"
#include "scenes/spec.hpp"

namespace plumb::scenes::PLUMB_TEST_FILE {
namespace {

std::vector<Vec3> positions_of(const Scene& scene) {
  std::vector<Vec3> out;
  for (const Particle& p : scene.particles) out.push_back(p.position);
  return out;
}

std::string message_of(std::string_view spec) {
  try {
    load_scene(spec);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

double mass_of(const Scene& scene) {
  double sum = 0;
  for (const double m : lumped_masses(scene)) sum += m;
  return sum;
}

/// How far the lowest capsule is above the first plane, in m.
double clearance(const Scene& scene, std::size_t first, std::size_t last) {
  const std::vector<Vec3> positions = positions_of(scene);
  const Plane& plane = scene.planes.at(0);
  double least = 1e9;
  for (std::size_t i = first; i < last; ++i)
    for (const Point* point : {&scene.capsules[i].a, &scene.capsules[i].b})
      least = std::min(
          least, dot(plane.normal, place_of(*point, positions)) - plane.offset - scene.capsules[i].radius);
  return least;
}

TEST(StandingHumanoid, HasTheThesisMassesAndStandsOnTheGround) {
  // Sums of figure 4.9, in pounds.
  const std::pair<const char*, double> builds[] = {{"thin", 255}, {"medium", 390}, {"wide", 867.5}};
  for (const auto& [body, pounds] : builds) {
    const Scene scene = load_scene(std::string("humanoid:body=") + body);
    EXPECT_EQ(scene.particles.size(), 10u);
    EXPECT_EQ(scene.rods.size(), 9u);
    EXPECT_EQ(scene.capsules.size(), 9u);
    EXPECT_EQ(scene.planes.size(), 1u);
    EXPECT_NEAR(mass_of(scene), pounds * pound, 1e-10) << body;
    EXPECT_NEAR(clearance(scene, 0, 9), 0, 1e-15) << body;
    for (const Particle& p : scene.particles) {
      EXPECT_TRUE(p.asleep);
      EXPECT_FALSE(p.fixed);
    }
    // Rounded positions against lengths that are given: within a few units in the last place of 3 m.
    EXPECT_LT(measure_stretch(scene, positions_of(scene)).max, 2e-14) << body;
  }
}

TEST(StandingHumanoid, LimbsAreSolidCylinders) {
  const Scene scene = make_humanoid({.body = BodyType::medium});
  for (std::size_t i = 0; i < scene.rods.size(); ++i) {
    const Rod& rod = scene.rods[i];
    const Inertia inertia = solid_cylinder(rod.mass, scene.capsules[i].radius, rod.length).inertia;
    EXPECT_NEAR(*rod.inertia, inertia.yy, 1e-14 * inertia.yy) << i;
    EXPECT_GT(rod.length, 0);
  }
}

TEST(StandingHumanoid, WithoutABodyIsTheTreeOfTheFrontier) {
  const Scene scene = load_scene("humanoid");
  EXPECT_TRUE(scene.particles[0].fixed);
  EXPECT_TRUE(scene.capsules.empty());
  EXPECT_FALSE(has_more_than_rods(scene));
  // 0.2286 m is 9 inches; legs go off by half their length.
  EXPECT_NEAR(scene.particles[6].position.z, 15 * inch, 1e-15);
  EXPECT_NEAR(scene.particles[7].position.z, -15 * inch, 1e-15);
  EXPECT_NE(message_of("humanoid:friction=0.1").find("body"), std::string::npos);
  EXPECT_NE(message_of("humanoid:joint_drag=1").find("body"), std::string::npos);
  EXPECT_EQ(scene.joint_drag, 0);
  EXPECT_NE(message_of("humanoid:body=fat").find("thin, medium, wide"), std::string::npos);
  EXPECT_NE(message_of("humanoid:body=thin,friction=-1").find("friction"), std::string::npos);
  EXPECT_NE(message_of("humanoid:body=thin,joint_drag=-1").find("joint_drag"), std::string::npos);
}

TEST(StandingHumanoid, JointsAreBraked) {
  for (const char* spec : {"humanoid:body=thin", "humanoid:body=wide,arms=1", "crowd:humanoids=2,hit=1"}) {
    EXPECT_EQ(load_scene(spec).joint_drag, usual_joint_drag) << spec;
    EXPECT_EQ(load_scene(std::string(spec) + ",joint_drag=0.5").joint_drag, 0.5) << spec;
  }
}

/// The angle in degrees that angle control `i` of the scene is at.
double angle_at(const Scene& scene, std::size_t i, std::span<const Vec3> positions) {
  const auto way = [&](const Direction& d) {
    const Vec3 v = place_of(d.to, positions) - place_of(d.from, positions);
    return (1 / norm(v)) * v;
  };
  return std::acos(dot(way(scene.angles[i].u), way(scene.angles[i].v))) * 180 / 3.141592653589793;
}

TEST(HumanoidWithArms, StandsWithTheThesisMassesAndArms) {
  const std::pair<const char*, double> builds[] = {{"thin", 255}, {"medium", 390}, {"wide", 867.5}};
  for (const auto& [body, pounds] : builds) {
    const Scene scene = load_scene(std::string("humanoid:arms=1,body=") + body);
    EXPECT_EQ(scene.bodies.size(), 11u);
    EXPECT_EQ(scene.capsules.size(), 13u);
    EXPECT_EQ(scene.angles.size(), 4u);
    const double thigh = pounds == 255 ? 30 : pounds == 390 ? 45 : 90;
    EXPECT_NEAR(mass_of(scene), (pounds + thigh) * pound, 1e-10) << body;  // arms: 2 (0.28 + 0.22) of a thigh
    EXPECT_NEAR(clearance(scene, 0, 13), 0, 1e-14) << body;
    // All of it is drawn as capsules; no rod of a body is.
    EXPECT_EQ(list_limbs(scene).size(), 13u);
    for (const Particle& p : scene.particles) EXPECT_TRUE(p.asleep);
    const std::vector<Vec3> positions = positions_of(scene);
    for (const Pin& pin : scene.pins)
      EXPECT_LT(norm(place_of(pin.a, positions) - place_of(pin.b, positions)), 1e-13);
  }
  EXPECT_NE(message_of("humanoid:arms=1").find("body"), std::string::npos);
  EXPECT_NE(message_of("humanoid:body=thin,arms=2").find("arms"), std::string::npos);
}

TEST(HumanoidWithArms, KneesBendBackwardsAndElbowsForwards) {
  const Scene scene = make_humanoid({.body = BodyType::medium, .arms = 1});
  const std::vector<Vec3> start = positions_of(scene);
  // Angles are of knee, elbow, knee, elbow; each lower limb is turned about its hinge here, by half a radian.
  for (std::size_t i = 0; i < 4; ++i) {
    const AngleControl& angle = scene.angles[i];
    EXPECT_NEAR(angle_at(scene, i, start), angle.lower * 180 / 3.141592653589793, 1e-6);
    const Vec3 hinge = place_of(angle.v.from, start);
    const Vec3 lower = place_of(angle.v.to, start) - hinge;
    for (const double front : {-1.0, 1.0}) {
      const Vec3 axis = (1 / norm(lower)) * cross(lower, {front, 0, 0});
      std::vector<Vec3> bent = start;
      for (const std::uint32_t p : angle.v.from.particles) {
        const Vec3 arm = start[p] - hinge;
        bent[p] = hinge + std::cos(0.5) * arm + std::sin(0.5) * cross(axis, arm) +
                  ((1 - std::cos(0.5)) * dot(axis, arm)) * axis;
      }
      const double turned = angle_at(scene, i, bent) - angle_at(scene, i, start);
      const bool allowed = (i % 2 == 0) == (front < 0);
      if (allowed)
        EXPECT_NEAR(turned, 0.5 * 180 / 3.141592653589793, 1e-6) << i;
      else
        EXPECT_LT(turned, 0) << i;
    }
  }
}

TEST(ThrownBall, FliesThroughItsTargetAsAsked) {
  // Free flight: undone by its own formula, so equal to rounding.
  for (const double speed : {3.0, 10.0, 30.0}) {
    Scene scene;
    const Vec3 target{0.1, 2, -0.3};
    const std::uint32_t i = throw_ball(scene, {.speed = speed, .direction = {-2, 0, 1}}, target);
    const Particle& ball = scene.particles.at(i);
    const Vec3 gravity = scene.gravity;
    // The vertical speed at the target is 0, so the time of flight is that of rising.
    const double t = ball.velocity.y / -gravity.y;
    EXPECT_LT(norm(ball.position + t * ball.velocity + (t * t / 2) * gravity - target), 1e-12);
    EXPECT_NEAR(norm(ball.velocity + t * gravity), speed, 1e-12);
    EXPECT_GE(ball.position.y, Ball{}.radius - 1e-12);
    EXPECT_LE(t * speed, 80 * inch + 1e-12);
  }
}

TEST(ThrownBall, DoesNotStartBelowTheGround) {
  Scene scene;
  throw_ball(scene, {.speed = 1}, {0, 2, 0});  // two seconds would be 20 m of height
  EXPECT_NEAR(scene.particles[0].position.y, Ball{}.radius, 1e-12);
  throw_ball(scene, {.speed = 10, .direction = {0, 1, 0}}, {0, 1, 0});  // from below, along a line
  EXPECT_NEAR(scene.particles[1].position.y, Ball{}.radius, 1e-12);
  EXPECT_THROW(throw_ball(scene, {.elasticity = 1.5}, {}), InputError);
  EXPECT_THROW(throw_ball(scene, {.direction = {0, 0, 0}}, {}), InputError);
  EXPECT_THROW(throw_ball(scene, {.mass = 0}, {}), InputError);
}

TEST(Crowd, IsManyEqualFigures) {
  const Scene one = make_humanoid({.body = BodyType::thin});
  const Scene crowd = load_scene("crowd:humanoids=10,hit=3,body=thin");
  ASSERT_EQ(crowd.particles.size(), 103u);
  ASSERT_EQ(crowd.rods.size(), 90u);
  ASSERT_EQ(crowd.capsules.size(), 93u);
  ASSERT_EQ(crowd.planes.size(), 1u);
  EXPECT_NEAR(clearance(crowd, 0, 90), 0, 1e-15);
  for (std::size_t i = 0; i < 90; ++i) {
    // The same bits: a rod's mass acts by these alone.
    EXPECT_EQ(crowd.rods[i].length, one.rods[i % 9].length);
    EXPECT_EQ(crowd.rods[i].mass, one.rods[i % 9].mass);
    EXPECT_EQ(crowd.rods[i].inertia, one.rods[i % 9].inertia);
    EXPECT_EQ(crowd.rods[i].a % 10, one.rods[i % 9].a);
    EXPECT_EQ(crowd.rods[i].a / 10, i / 9);
  }
  const Vec3 step = crowd.particles[10].position - crowd.particles[0].position;
  EXPECT_NEAR(step.x, 2.5, 1e-14);
  for (std::size_t i = 100; i < 103; ++i) {
    EXPECT_FALSE(crowd.particles[i].asleep);
    EXPECT_LT(crowd.particles[i].velocity.x, 0);
  }
  EXPECT_NE(message_of("crowd:humanoids=3,hit=4").find("hit"), std::string::npos);
  EXPECT_NE(message_of("crowd:body=none").find("body"), std::string::npos);
}

TEST(StickBox, WallsKeepTheParticlesWithinTheThesisBox) {
  const Scene scene = load_scene("stick_box");
  ASSERT_EQ(scene.planes.size(), 6u);
  EXPECT_EQ(scene.rods.at(0).length, 100);
  const double radius = scene.capsules.at(0).radius;
  for (const Plane& plane : scene.planes) {
    // A particle as near as its radius allows is on a face of the box from 0 to 500 (eq. 3.8).
    const double at = plane.offset + radius;
    EXPECT_TRUE(at == 0 || at == -500) << at;
    EXPECT_EQ(norm(plane.normal), 1);
    for (const Particle& p : scene.particles) EXPECT_GT(dot(plane.normal, p.position), at);
  }
  const Vec3 between = scene.particles[1].position - scene.particles[0].position;
  const Vec3 pulling = scene.particles[1].velocity - scene.particles[0].velocity;
  EXPECT_EQ(dot(between, pulling), 0);
  EXPECT_NE(message_of("stick_box:length=600").find("length"), std::string::npos);
}

TEST(Drop, BeginsAtItsHeight) {
  const Scene scene = load_scene("drop:height=2,radius=0.25,restitution=0.8");
  EXPECT_NEAR(clearance(scene, 0, 1), 2, 1e-15);
  EXPECT_EQ(scene.capsules[0].surface.restitution, 0.8);
  EXPECT_NE(message_of("drop:restitution=2").find("restitution"), std::string::npos);
  EXPECT_NE(message_of("drop:height=-1").find("height"), std::string::npos);
}

TEST(FallingThings, StartAboveTheirGround) {
  const Scene net = load_scene("drape:size=5,sphere=1,height=0.25");
  ASSERT_EQ(net.ground_capsules.size(), 1u);
  EXPECT_TRUE(net.boxes.empty());
  const GroundCapsule& sphere = net.ground_capsules[0];
  EXPECT_EQ(sphere.a, sphere.b);
  EXPECT_NEAR(sphere.a.y, sphere.radius, 1e-15) << "it stands on the plane";
  // The net is level, but for ripples of 1 mm.
  for (const Particle& each : net.particles)
    EXPECT_NEAR(each.position.y - net.capsules[0].radius - 2 * sphere.radius, 0.25, 1e-3);
  const Scene rope = load_scene("rope:links=19,coil=0.3,pitch=0.3,height=0.1");
  EXPECT_NEAR(clearance(rope, 0, 19), 0.1, 1e-15);
  // 19 rods of 10 cm go once around 2 pi 0.3 m, and so climb by a pitch.
  EXPECT_NEAR(rope.particles.back().position.y - rope.particles[0].position.y, 0.3, 0.02);
  EXPECT_NE(message_of("rope:pitch=0.3").find("coil"), std::string::npos);
  EXPECT_NE(message_of("rope:coil=0.05,pitch=3,length=0.09").find("climbs"), std::string::npos);
}

TEST(FallingThings, BoxesWeighAsTheyAreTurned) {
  const Scene scene = load_scene("boxes:boxes=4,mass=2,height=0.05");
  ASSERT_EQ(scene.hulls.size(), 4u);
  double top = 0;
  for (const Hull& hull : scene.hulls) {
    const Body& body = scene.bodies[hull.body];
    double low = 1e9, high = 0;
    for (const Vec3 corner : hull.points) {
      low = std::min(low, corner.y);
      high = std::max(high, corner.y);
    }
    EXPECT_GE(low, top + 0.05 - 1e-12);
    top = high;
    // Along each edge of a box there is a principal axis. Its moment is m/3 of the squares of the other two
    // half sides.
    const Inertia& i = body.inertia;
    for (const int other : {1, 2, 4}) {
      const Vec3 edge = hull.points[other] - hull.points[0];
      double squares = 0;
      for (const int each : {1, 2, 4}) {
        const Vec3 side = 0.5 * (hull.points[each] - hull.points[0]);
        if (each != other) squares += dot(side, side);
      }
      const Vec3 turned{i.xx * edge.x + i.xy * edge.y + i.xz * edge.z,
                        i.xy * edge.x + i.yy * edge.y + i.yz * edge.z,
                        i.xz * edge.x + i.yz * edge.y + i.zz * edge.z};
      EXPECT_LT(norm(turned - (body.mass / 3 * squares) * edge), 1e-14);
    }
  }
  EXPECT_NE(message_of("boxes:boxes=0").find("boxes"), std::string::npos);
}

// A layer's limbs lie in a plane, and layers are apart by more than limbs are thick. So the least distances
// are those of lines, which are found exactly.
TEST(Pile, FiguresStartApartFromEachOtherAndTheGround) {
  constexpr std::size_t limbs = 9;
  for (const char* body : {"thin", "medium", "wide"}) {
    const Scene scene = load_scene(std::string("pile:figures=30,gap=0.05,seed=3,body=") + body);
    ASSERT_EQ(scene.capsules.size(), 30 * limbs);
    const std::vector<Vec3> positions = positions_of(scene);
    const auto line_of = [&](const Capsule& capsule) {
      return detail::Segment{place_of(capsule.a, positions), place_of(capsule.b, positions), capsule.radius};
    };
    double least = clearance(scene, 0, scene.capsules.size());
    EXPECT_NEAR(least, 0.05, 1e-12);
    for (std::size_t i = 0; i < scene.capsules.size(); ++i)
      for (std::size_t j = (i / limbs + 1) * limbs; j < scene.capsules.size(); ++j)
        least = std::min(least, detail::touch(line_of(scene.capsules[i]), line_of(scene.capsules[j])).gap);
    EXPECT_GT(least, 0.05 - 1e-12) << body;
    EXPECT_LT(measure_stretch(scene, positions).max, 2e-14) << body;
    for (const Particle& p : scene.particles) EXPECT_FALSE(p.asleep);
  }
  EXPECT_NE(message_of("pile:figures=0").find("figures"), std::string::npos);
  EXPECT_NE(message_of("pile:gap=0").find("gap"), std::string::npos);
  EXPECT_NE(message_of("pile:body=none").find("body"), std::string::npos);
}

TEST(Pile, LiesInOneHeapOfSeveralLayersAndAnotherSeedInAnother) {
  const Scene scene = load_scene("pile:figures=64");
  double top = 0;
  for (const Particle& p : scene.particles) top = std::max(top, p.position.y);
  // Four layers, each thicker than a torso of ten inches' radius.
  EXPECT_GT(top, 3 * 20 * inch);
  EXPECT_NE(positions_of(scene)[5], positions_of(load_scene("pile:figures=64,seed=2"))[5]);
  EXPECT_EQ(positions_of(scene)[5], positions_of(load_scene("pile:figures=64"))[5]);
}

TEST(SlackNet, StartsAtItsLengthsBetweenNearerCorners) {
  for (const char* spec :
       {"net:width=7,height=4,slack=0.25,end_mass=7", "net:width=7,height=4,slack=0.25,end_mass=7,level=1"}) {
    const Scene scene = load_scene(spec);
    EXPECT_LT(measure_stretch(scene, positions_of(scene)).max, 1e-14) << spec;
    EXPECT_NEAR(scene.particles[6].position.x, 0.6 / 1.25, 1e-15) << spec;
    EXPECT_EQ(scene.particles.back().mass, 7) << spec;
  }
  EXPECT_NE(message_of("net:slack=-1").find("slack"), std::string::npos);
}

}  // namespace
}  // namespace plumb::scenes::PLUMB_TEST_FILE
