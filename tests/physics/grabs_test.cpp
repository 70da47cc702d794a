// Grabs: implicit springs and dampers from places of islands to targets that move (World::grab()).

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include "contact/grabs/linkage_grabs.hpp"
#include "direct/grabs/loop_grabs.hpp"
#include "direct/grabs/tree_grabs.hpp"
#include "plumb/plumb.hpp"
#include "relax/grabs/block_grabs.hpp"
#include "scenes/generators/falling.hpp"
#include "scenes/generators/generators.hpp"
#include "scenes/humanoid/humanoid.hpp"
#include "support/bodies.hpp"
#include "support/direct.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::movable;

Vec3 momentum_of(const Scene& scene, const World& world) {
  const std::vector<double> masses = lumped_masses(scene);
  Vec3 sum{};
  for (std::uint32_t i = 0; i < masses.size(); ++i)
    if (!scene.particles[i].fixed) sum += masses[i] * world.velocity(i);
  return sum;
}

Settings settings_of(Method method, Gradient gradient) {
  Settings settings{
      .method = method, .gradient = gradient, .substeps = 1, .sleep = false, .tensions = true, .threads = 1};
  if (method == Method::relax) settings.stop.sweeps = 50;
  return settings;
}

class Methods : public testing::TestWithParam<std::tuple<Method, Gradient>> {
 protected:
  Method method() const { return std::get<0>(GetParam()); }
  Gradient gradient() const { return std::get<1>(GetParam()); }
};

std::string name_of(const testing::TestParamInfo<std::tuple<Method, Gradient>>& test) {
  return std::string(to_string(std::get<0>(test.param))) + "_" +
         std::string(to_string(std::get<1>(test.param)));
}

// Two masses on a rod without gravity, grabbed alike, move as one mass on a damped spring:
// x = T (1 - e^-bt (cos wt + b/w sin wt)), b = c/2m, w² = k/m - b². Substeps resolve the swing from 32 on, so
// that mid and old have order 2.
TEST_P(Methods, MoveAMassAsADampedOscillator) {
  constexpr double k = 40, c = 1.5, mass = 1, way = 0.3;
  Scene scene;
  scene.gravity = {};
  scene.particles = {movable({0, 0, 0}, mass / 2), movable({0, 1, 0}, mass / 2)};
  scene.rods = {{.a = 0, .b = 1}};
  const double b = c / (2 * mass), w = std::sqrt(k / mass - b * b);
  const double truth = way * (1 - std::exp(-b) * (std::cos(w) + b / w * std::sin(w)));
  const auto error = [&](int steps) {
    World world(scene, settings_of(method(), gradient()));
    world.grab(Grab::particle(0, {way, 0, 0}, k / 2, c / 2));
    world.grab(Grab::particle(1, {way, 1, 0}, k / 2, c / 2));
    test::run(world, 1.0 / steps, steps);
    return std::abs(world.position(0).x - truth) / way;
  };
  const double coarse = error(128), fine = error(256);
  const bool is_new = gradient() == Gradient::new_;
  EXPECT_GE(std::log2(coarse / fine), is_new ? 0.9 : 1.95);
  EXPECT_LE(fine, is_new ? 0.04 : 4e-5);
}

// A hand that is pulled round a circle within its reach, by a spring without damping, in weightlessness. Its
// speed stays near that of the target, whatever the stiffness; explicit forces throw it at hundreds of m/s.
TEST_P(Methods, PullAHandByAnyStiffness) {
  Scene scene = scenes::make_humanoid();
  scene.gravity = {};
  constexpr std::uint32_t hand = 6;
  constexpr double radius = 0.05, turn = 4, speed = radius * turn;
  for (const Precision precision : {Precision::single, Precision::double_}) {
    double last_apart = 1;
    for (const double k : {1.0, 1e2, 2e3, 1e5, 1e7, 1e9}) {
      Settings settings = settings_of(method(), gradient());
      settings.precision = precision;
      settings.substeps = 4;
      World world(scene, settings);
      const Vec3 start = world.position(hand);
      const Handle<Grab> grab = world.grab(Grab::particle(hand, start, k));
      double fastest = 0, apart = 0;
      for (int i = 1; i <= 120; ++i) {
        const double angle = turn * i / 60;
        const Vec3 target = start + radius * Vec3{-std::sin(angle), 1 - std::cos(angle), 0};
        world.move_grab(grab, target);
        world.step(1.0 / 60);
        fastest = std::max(fastest, norm(world.velocity(hand)));
        apart = std::max(apart, norm(world.position(hand) - target));
      }
      EXPECT_LE(fastest, 4 * speed) << k;
      EXPECT_LE(apart, k >= 2e3 ? 1.05 * last_apart : 1) << k;
      EXPECT_LE(apart, k == 1e9 ? 1e-5 : 1) << k;
      last_apart = apart;
    }
  }
}

// What a grab reports is what momentum changes by, in flight and with a stiff grab that no substep resolves.
TEST(Grabs, ReportTheChangeOfMomentum) {
  Scene scene;
  scene.gravity = {};
  for (int i = 0; i < 6; ++i) {
    scene.particles.push_back(movable({0.3 * i, 0.1 * (i % 2), 0}, 1 + 0.5 * i, {0, 0.3 * i, 0.2}));
    if (i > 0) scene.rods.push_back({.a = i - 1u, .b = static_cast<std::uint32_t>(i), .mass = 0.4});
  }
  for (const double k : {30.0, 1e6})
    for (const Method method : {Method::direct, Method::relax}) {
      World world(scene, settings_of(method, Gradient::mid));
      const Handle<Grab> grab = world.grab(Grab::particle(2, {0.9, 0.4, -0.2}, k, 0.01 * k));
      Vec3 before = momentum_of(scene, world);
      const Vec3 start = before;
      double scale = norm(before);
      for (int i = 0; i < 60; ++i) {
        if (i > 20) world.move_grab(grab, Vec3{0.9, 0.4, -0.2} + 0.01 * (i - 20) * Vec3{1, 0.3, 0});
        world.step(1.0 / 120);
        const Vec3 after = momentum_of(scene, world);
        scale = std::max(scale, norm(after));
        EXPECT_LE(norm(after - before - 1.0 / 120 * world.grab_force(grab)), 2e-12 * scale)
            << i << ' ' << k << ' ' << to_string(method);
        before = after;
      }
      EXPECT_GT(norm(before - start), 0.1);
      world.release(grab);
      test::run(world, 1.0 / 120, 30);
      EXPECT_LE(norm(momentum_of(scene, world) - before), 1e-12 * scale);
    }
}

// Gradient mid keeps the energy of a chain with that of an undamped grab, which substeps resolve, over 1,000
// swings: the spring is quadratic in positions, as rods are. Its power is what the chain gains.
TEST(Grabs, KeepTheEnergyOfASwing) {
  Scene scene = scenes::make_chain(8, 0.1, 3);
  constexpr double k = 400;
  Settings settings = settings_of(Method::direct, Gradient::mid);
  settings.substeps = 4;
  World world(scene, settings);
  const Vec3 target{0.5, 0.2, 0.3};
  const Handle<Grab> grab = world.grab(Grab::particle(8, target, k));
  const auto held = [&] {
    const Vec3 apart = world.position(8) - target;
    return 0.5 * k * dot(apart, apart);
  };
  const double own_start = test::energy_of(scene, world).total(), all_start = own_start + held();
  double worst = 0, work = 0;
  for (int i = 0; i < 1200; ++i) {
    world.step(1.0 / 240);
    work += world.power(grab) / 240;
    worst = std::max(worst, std::abs(test::energy_of(scene, world).total() + held() - all_start));
  }
  EXPECT_LE(worst, 1e-9 * held() + 1e-9 * all_start + 1e-8);
  EXPECT_NEAR(test::energy_of(scene, world).total() - own_start, work, 1e-8);
  EXPECT_GT(std::abs(work), 1e-3);
}

// A uniform rod of mass m and length L, grabbed at d from its middle, swings there by w² = k (1/m + d²/I),
// I = mL²/12, if it moves little. Its consistent mass is exact, so that only the step errs.
TEST(Grabs, OfAPlaceOnARodSwingAsARigidBody) {
  constexpr double mass = 2, length = 1.2, k = 50, share = 0.2, start = 1e-5;
  Scene scene;
  scene.gravity = {};
  scene.particles = {movable({0, 0, 0}, 0), movable({length, 0, 0}, 0)};
  scene.rods = {{.a = 0, .b = 1, .mass = mass}};
  const double from_middle = (0.5 - share) * length, inertia = mass * length * length / 12;
  const double swing = std::sqrt(k * (1 / mass + from_middle * from_middle / inertia));
  for (const Gradient gradient : {Gradient::old, Gradient::mid}) {
    Settings settings = settings_of(Method::direct, gradient);
    World world(scene, settings);
    world.grab(Grab::rod(scene.rods[0], share, {share * length, 0, start}, k));
    test::run(world, 1.0 / 1000, 700);
    const double place = (1 - share) * world.position(0).z + share * world.position(1).z;
    EXPECT_NEAR(place / start, 1 - std::cos(0.7 * swing), 1e-4) << to_string(gradient);
    EXPECT_GT(std::abs(world.position(1).z - world.position(0).z), 0.1 * start) << "it turns";
  }
}

// A body that is grabbed beside its centre takes the impulse that is reported, and follows a stiff grab.
TEST(Grabs, OfAPlaceOnABodyPullIt) {
  Scene scene;
  scene.gravity = {};
  const std::uint32_t first = 0;
  for (const Vec3 at : {Vec3{0, 0, 0}, Vec3{0.4, 0, 0}, Vec3{0, 0.4, 0}, Vec3{0, 0, 0.4}})
    scene.particles.push_back(movable(at, 0));
  add_body(scene, {first, first + 1, first + 2, first + 3}, solid_box(3, {0.4, 0.3, 0.2}));
  const Point corner{{0, 1, 2, 3}, {-0.2, 0.5, 0.4, 0.3}};
  const auto place = [&](const World& world) {
    const std::vector<Vec3> x = test::positions_of(world);
    return position_of(corner, x);
  };
  for (const double k : {100.0, 1e9}) {
    World world(scene, settings_of(Method::direct, Gradient::old));
    const Vec3 start = place(world);
    const Handle<Grab> grab = world.grab({corner, start, k, 1});
    Vec3 before{};
    for (int i = 1; i <= 60; ++i) {
      world.move_grab(grab, start + Vec3{0.002 * i, 0, 0.001 * i});
      world.step(1.0 / 120);
      const Vec3 after = 3 * world.motion(0).velocity;
      EXPECT_LE(norm(after - before - 1.0 / 120 * world.grab_force(grab)), 1e-9) << i << ' ' << k;
      before = after;
    }
    EXPECT_GT(norm(before), 0.1);
    EXPECT_LE(norm(place(world) - start - Vec3{0.12, 0, 0.06}), k > 1e3 ? 1e-6 : 0.2);
  }
}

// Rings are factorised and wide nets are solved by their lines; both take grabs, of any stiffness, and
// momentum changes as they report.
TEST(Grabs, OfLoopsPullThem) {
  Scene ring = scenes::make_ring({});
  Scene net = scenes::make_net(24, 24);
  for (Scene* const scene : {&ring, &net}) {
    scene->gravity = {};
    for (Particle& particle : scene->particles) {
      if (particle.fixed) particle.mass = 1;
      particle.fixed = false;
    }
    for (const Gradient gradient : {Gradient::old, Gradient::mid, Gradient::new_})
      for (const double k : {20.0, 1e7}) {
        World world(*scene, settings_of(Method::direct, gradient));
        const std::uint32_t held = 7;
        const Vec3 start = world.position(held);
        const Handle<Grab> grab = world.grab(Grab::particle(held, start, k));
        Vec3 impulse{};
        double fastest = 0;
        for (int i = 1; i <= 40; ++i) {
          world.move_grab(grab, start + 0.002 * i * Vec3{0.3, 0.2, 1});
          world.step(1.0 / 120);
          impulse += 1.0 / 120 * world.grab_force(grab);
          fastest = std::max(fastest, norm(world.velocity(held)));
        }
        world.release(grab);
        test::run(world, 1.0 / 120, 2);
        // The last half kick of old is in its velocities, and in no step.
        const double most = gradient == Gradient::old ? 1 : 1e-6;
        EXPECT_LE(norm(momentum_of(*scene, world) - impulse), most * norm(impulse)) << k;
        EXPECT_GT(norm(impulse), 1e-3);
        EXPECT_LE(fastest, 1.5) << to_string(gradient) << ' ' << k;
      }
  }
}

// A figure that stands on the ground is pulled by a hand through a circle, without damping. The target starts
// at full speed, which springs of up to 10^5 N/m make limbs swing with; relaxation leaves tenths of a
// millimetre. A spring of 10^7 N/m rings as feet come down, and pulls with up to 9 kN, whatever the substeps
// up to 64. Others pull with less than 5 kN.
TEST(Grabs, OfWhatTouchesPullItByAnyStiffness) {
  const Scene scene = scenes::make_humanoid({.body = scenes::BodyType::medium, .arms = 1});
  std::uint32_t hand = 0;
  for (std::uint32_t i = 0; i < scene.particles.size(); ++i)
    if (std::abs(scene.particles[i].position.z) > std::abs(scene.particles[hand].position.z)) hand = i;
  constexpr double radius = 0.1, turn = 3, speed = radius * turn;
  for (const Method method : {Method::relax, Method::direct, Method::automatic})
    for (const double k : {2e3, 1e5, 1e7, 1e9}) {
      World world(scene, {.method = method, .substeps = 4, .threads = 1});
      const Vec3 start = world.position(hand);
      const Handle<Grab> grab = world.grab(Grab::particle(hand, start, k));
      double fastest = 0, apart = 0;
      for (int i = 1; i <= 180; ++i) {
        const double angle = turn * i / 60;
        const Vec3 target = start + radius * Vec3{std::sin(angle), 1 - std::cos(angle), 0};
        world.move_grab(grab, target);
        world.step(1.0 / 60);
        fastest = std::max(fastest, norm(world.velocity(hand)));
        apart = std::max(apart, norm(world.position(hand) - target));
      }
      EXPECT_LE(fastest, (k > 1e5 ? 3 : 8) * speed) << k << ' ' << to_string(method);
      EXPECT_LE(apart, (k == 1e7 ? 9e3 : 5e3) / k + 2e-4) << k << ' ' << to_string(method);
    }
}

// A figure of rods visits the contact solver while it is near the ground, and goes home as it is lifted. Both
// hold its weight. Let go, it falls, and comes to rest.
TEST(Grabs, LiftAFigureAndDropIt) {
  const Scene scene = scenes::make_humanoid({.body = scenes::BodyType::medium});
  double weight = 0;
  for (const double mass : lumped_masses(scene)) weight += 9.81 * mass;
  for (const Method method : {Method::relax, Method::direct}) {
    World world(scene, {.method = method, .substeps = 4, .tensions = true, .threads = 1});
    const Vec3 start = world.position(0);
    const Handle<Grab> grab = world.grab(Grab::particle(0, start, 2e4, 500));
    for (int i = 1; i <= 240; ++i) {
      world.move_grab(grab, start + Vec3{0, i / 120.0, 0});
      world.step(1.0 / 60);
    }
    Vec3 force{};
    for (int i = 0; i < 600; ++i) {
      world.step(1.0 / 60);
      if (i >= 300) force += 1.0 / 300 * world.grab_force(grab);
    }
    EXPECT_NEAR(force.y, weight, 0.01 * weight) << to_string(method);
    EXPECT_NEAR(world.position(0).y, start.y + 2 - weight / 2e4, 0.05);
    world.release(grab);
    test::run(world, 1.0 / 60, 30);
    EXPECT_NEAR(start.y + 2 - world.position(0).y, 9.81 / 8, 0.1) << to_string(method);
    test::run(world, 1.0 / 60, 900);
    EXPECT_EQ(world.step(1.0 / 60).awake_islands, 0u) << to_string(method);
  }
}

INSTANTIATE_TEST_SUITE_P(Grabs, Methods,
                         testing::Combine(testing::Values(Method::relax, Method::direct),
                                          testing::Values(Gradient::new_, Gradient::old, Gradient::mid)),
                         name_of);

// Ground holds a long rope in its matrix, whether it is grabbed or not. As rows, with a solution each, its
// contacts took seconds a frame with 1,000 rods, and 400 sweeps here. The ground and the grab carry what the
// rope weighs, once it hangs still: what it still swings is a hundredth of that.
TEST(Grabs, LiftALongRopeFromTheFloor) {
  const Scene scene = scenes::make_rope({.links = 200});
  World world(scene, {.tensions = true, .threads = 1});
  test::run(world, 1.0 / 60, 90);
  constexpr std::uint32_t lifted = 100;
  const Vec3 target = world.position(lifted) + Vec3{0, 0.3, 0};
  const Handle<Grab> grab =
      world.grab({.at = point_at(lifted), .target = target, .stiffness = 500, .damping = 10});
  StepReport total = test::run(world, 1.0 / 60, 60);
  EXPECT_EQ(total.unsolved, 0u);
  EXPECT_LE(total.block_sweeps, 240u) << "a step that is relaxed takes 120";
  test::run(world, 1.0 / 60, 300);
  std::vector<Vec3> pushes(scene.capsules.size());
  world.copy_contact_forces(pushes);
  double carried = world.grab_force(grab).y, weight = 0;
  for (const Vec3 push : pushes) carried += push.y;
  for (const double mass : lumped_masses(scene)) weight += 9.81 * mass;
  EXPECT_NEAR(carried, weight, 1e-2 * weight);
  EXPECT_GT(world.position(lifted).y, target.y - 0.1);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
