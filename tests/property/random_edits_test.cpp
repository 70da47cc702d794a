// Random edits of random worlds whose ropes may touch, and other settings in between. PLUMB_EDITS says how
// many are tried, 2,000 by default, or half as many under a sanitizer.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "plumb/plumb.hpp"
#include "support/refusals.hpp"
#include "support/sanitizers.hpp"
#include "support/snapshots.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using Random = std::mt19937;

std::uint32_t below(Random& random, std::size_t count) {
  return static_cast<std::uint32_t>(random() % count);
}

double between(Random& random, double low, double high) {
  return low + (high - low) * (random() / 4294967296.0);
}

/// Appends a box of 0.2 kg with sides of 0.08 m.
void add_crate(Scene& scene, Vec3 center) {
  const double side = 0.08, moment = 0.2 * side * side / 6;
  const std::uint32_t body =
      add_body(scene, {.mass = 0.2, .center = center, .inertia = {.xx = moment, .yy = moment, .zz = moment}});
  scene.hulls.push_back(
      box_on_body(body, {.center = center, .half_size = {0.5 * side, 0.5 * side, 0.5 * side}}));
}

/// Appends a net of three particles by three, with capsules or none.
void add_net(Scene& scene, Vec3 from, bool has_shapes) {
  const auto first = static_cast<std::uint32_t>(scene.particles.size());
  const auto add_rod = [&](std::uint32_t a, std::uint32_t b) {
    scene.rods.push_back({.a = first + a, .b = first + b, .length = 0.1});
    if (has_shapes)
      scene.capsules.push_back({.a = point_at(first + a), .b = point_at(first + b), .radius = 0.02});
  };
  for (std::uint32_t i = 0; i < 9; ++i) {
    scene.particles.push_back(
        {.position = from + Vec3{0.1 * (i / 3), 0, 0.1 * (i % 3)}, .velocity = {0, -0.3, 0}, .mass = 0.1});
    if (i % 3 > 0) add_rod(i - 1, i);
    if (i > 2) add_rod(i - 3, i);
  }
}

/// Ropes in the air, some with capsules, some of those with a spring, maybe a box and a net. They push
/// nothing but each other.
Scene random_scene(Random& random) {
  Scene scene;
  scene.gravity = {};
  for (std::uint32_t rope = 0, ropes = 2 + below(random, 4); rope < ropes; ++rope) {
    const auto first = static_cast<std::uint32_t>(scene.particles.size());
    const std::uint32_t rods = 2 + below(random, 7);
    const bool has_shapes = below(random, 4) > 0, is_linkage = has_shapes && below(random, 3) == 0;
    const Vec3 velocity{between(random, -1, 1), 0.4 - 0.2 * rope, between(random, -1, 1)};
    for (std::uint32_t i = 0; i <= rods; ++i)
      scene.particles.push_back(
          {.position = {rope % 2 == 0 ? 0.1 * i : 0.2, 0.06 * rope, rope % 2 == 0 ? 0.0 : 0.1 * i - 0.2},
           .velocity = velocity,
           .mass = 0.1});
    for (std::uint32_t i = first; i < first + rods; ++i) {
      scene.rods.push_back({.a = i, .b = i + 1});
      if (has_shapes) scene.capsules.push_back({.a = point_at(i), .b = point_at(i + 1), .radius = 0.02});
    }
    if (is_linkage)
      scene.springs.push_back(
          {.a = point_at(first), .b = point_at(first + 2), .length = 0.19, .stiffness = 3});
  }
  if (below(random, 4) == 0) add_crate(scene, {0.1, -0.15, 0});
  if (below(random, 3) == 0) add_net(scene, {0.3, 0.1, 0}, below(random, 2) == 0);
  return scene;
}

/// A rope of three rods with capsules, which may give, bend or have a spring, or two boxes with a ball joint.
Scene random_addition(Random& random) {
  Scene scene;
  const Vec3 from{between(random, -0.2, 0.4), between(random, -0.3, -0.1), between(random, -0.2, 0.2)};
  const std::uint32_t kind = below(random, 5);
  if (kind == 0) {
    add_crate(scene, from);
    add_crate(scene, from + Vec3{0.1, 0, 0});
    const Vec3 between_them = from + Vec3{0.05, 0, 0};
    add_spherical(scene, point_on_body(scene, 0, between_them), point_on_body(scene, 1, between_them));
    for (Particle& each : scene.particles) each.velocity = {0, 1, 0};
    return scene;
  }
  for (std::uint32_t i = 0; i <= 3; ++i)
    scene.particles.push_back({.position = from + Vec3{0.1 * i, 0, 0}, .velocity = {0, 1, 0}, .mass = 0.1});
  for (std::uint32_t i = 0; i < 3; ++i) {
    scene.rods.push_back({.a = i, .b = i + 1, .length = 0.1});
    if (kind == 1) scene.rods.back().law = {.stiffness = 500, .damping = 0.1};
    scene.capsules.push_back({.a = point_at(i), .b = point_at(i + 1), .radius = 0.02});
  }
  if (kind == 4)
    for (Particle& each : scene.particles) {
      each.velocity = {};
      each.asleep = true;
    }
  if (kind == 2) scene.bends.push_back({.a = 0, .b = 1, .c = 2, .stiffness = 0.01});
  if (kind == 3)
    scene.springs.push_back({.a = point_at(0), .b = point_at(3), .length = 0.25, .stiffness = 3});
  return scene;
}

/// Worlds of one scene that are to stay alike, and what is known of their particles.
struct Twins {
  World one, two;
  std::vector<double> masses, of_bodies;  // kg; the former with the latter
  std::vector<std::uint32_t> ropes;       // at the start, by particle
  std::vector<Handle<Particle>> gone, fixed;
  std::uint32_t rods;  // at the start, of 0.1 m each
  double frame = 1.0 / 240;
  bool is_pushed = false;  // by a force that stays

  /// Returns a particle that was fixed, if any was, or else the one that is given: most are free.
  std::uint32_t some_fixed(std::uint32_t particle) {
    std::erase_if(fixed, [&](Handle<Particle> each) { return !one.has(each); });
    return fixed.empty() ? particle : one.number(fixed[particle % fixed.size()]);
  }
  Vec3 momentum() const {
    Vec3 sum;
    for (std::uint32_t i = 0; i < one.particle_count(); ++i)
      if (one.handle<Particle>(i)) sum += masses[i] * one.velocity(i);
    return sum;
  }
};

Settings random_settings(Random& random) {
  constexpr Method methods[] = {Method::automatic, Method::direct, Method::relax};
  Settings out{.method = methods[below(random, 3)],
               .substeps = 1 + below(random, 4),
               .tensions = below(random, 2) == 0,
               .contacts = below(random, 2) == 0,
               .events = below(random, 2) == 0};
  constexpr Gradient gradients[] = {Gradient::new_, Gradient::old, Gradient::mid};
  if (const std::uint32_t gradient = below(random, 6); gradient < 3) out.gradient = gradients[gradient];
  if (out.method == Method::relax)
    out.stop.sweeps = 20;
  else if (below(random, 4) == 0)
    out.accuracy = 1e-3;
  return out;
}

/// Gives both other settings, each with its own threads. Nothing moves by that, and numbers stay.
void change_settings(Twins& twins, Random& random) {
  Settings settings = random_settings(random);
  for (World* const world : {&twins.one, &twins.two}) {
    const std::vector<Vec3> positions = test::positions_of(*world), velocities = test::velocities_of(*world);
    settings.threads = world->settings().threads;
    world->set_settings(settings);
    EXPECT_EQ(test::positions_of(*world), positions);
    // A velocity of gradient new is a displacement where that gradient stays, with its rounding: an accuracy
    // may make substeps as short as 1e-4 s.
    for (std::uint32_t i = 0; i < velocities.size(); ++i)
      EXPECT_LE(norm(test::velocities_of(*world)[i] - velocities[i]), 1e-15 * norm(velocities[i]) + 1e-13);
  }
}

/// Takes note of particles that a scene has from a number on.
void note(Twins& twins, const Scene& scene, std::uint32_t first) {
  for (std::vector<double>* const masses : {&twins.masses, &twins.of_bodies})
    masses->resize(twins.one.particle_count());
  twins.ropes.resize(twins.one.particle_count());
  for (std::uint32_t i = 0; i < scene.particles.size(); ++i) {
    twins.masses[first + i] = scene.particles[i].mass;
    twins.of_bodies[first + i] = 0;
    twins.ropes[first + i] = first;
  }
  for (const Body& body : scene.bodies)
    for (const std::uint32_t particle : body.particles) {
      twins.of_bodies[first + particle] = 0.25 * body.mass;
      twins.masses[first + particle] += 0.25 * body.mass;
    }
}

/// Adds something to both, near the others.
void add(Twins& twins, Random& random) {
  const Scene scene = random_addition(random);
  Added first;
  const std::string why = test::refusal([&] { first = twins.one.add(scene); });
  EXPECT_EQ(why, test::refusal([&] { EXPECT_EQ(twins.two.add(scene), first); }));
  if (why.empty()) note(twins, scene, first.particle);  // else neither began with shapes
}

/// Does one edit to both. A refused one changes neither. Returns whether momentum may change by it.
bool edit(Twins& twins, Random& random) {
  const std::uint32_t kind = below(random, 18 + (below(random, 4) == 0 ? 1 : 0)),
                      rod = below(random, twins.one.rod_count()),
                      particle = below(random, twins.one.particle_count());
  const double mass = between(random, 0.05, 0.3);
  const auto both = [&](auto&& change) {
    const std::string why = test::refusal([&] { change(twins.one); });
    EXPECT_EQ(why, test::refusal([&] { change(twins.two); }));
    return why.empty();
  };
  if (kind < 4) {
    both([&](World& world) { world.cut(rod); });
    return false;
  }
  if (kind < 6) {
    if (both([&](World& world) { world.set_mass(particle, mass); }))
      twins.masses[particle] = mass + twins.of_bodies[particle];
    return true;
  }
  if (kind == 8) {
    change_settings(twins, random);
    return false;
  }
  if (kind == 6) {
    if (both([&](World& world) { world.fix(particle); }))
      twins.fixed.push_back(twins.one.handle<Particle>(particle));
    return true;
  }
  if (kind == 9) {
    both([&](World& world) { world.free(twins.some_fixed(particle)); });
    return true;
  }
  if (kind == 15) {
    both([&](World& world) { world.pack(); });
    return false;
  }
  if (kind == 18) {
    if (both([&](World& world) { world.set_force(particle, {mass, -mass, 0.1}); })) twins.is_pushed = true;
    return true;
  }
  if (kind == 17) {
    const std::uint32_t anchor = twins.some_fixed(particle);
    both([&](World& world) {
      world.move_anchor(anchor, world.position(anchor) + Vec3{0.1 * mass, 0, 0.001});
    });
    return true;
  }
  if (kind == 16) {
    const Scene like = random_addition(random);
    both([&](World& world) { world.reserve(like, particle % 3); });
    for (std::vector<double>* const masses : {&twins.masses, &twins.of_bodies})
      masses->resize(twins.one.particle_count());
    twins.ropes.resize(twins.one.particle_count());
    return false;
  }
  if (kind == 14) {
    for (std::uint32_t left = below(random, 3) == 0 ? 6 : 1; left > 0; --left) add(twins, random);
    return false;
  }
  if (kind > 11) {
    if (rod >= twins.rods) return false;  // how long a joined one is, nobody knows here
    const double length = between(random, 0.09, 0.11);
    both([&](World& world) { world.set_length(rod, length); });
    return false;
  }
  if (kind > 9) {
    // Within a rope a rod would close triangles that are straight, which nothing solves exactly.
    const std::uint32_t other = below(random, twins.one.particle_count());
    if (twins.ropes[particle] == twins.ropes[other]) return false;
    both([&](World& world) { world.join({.a = particle, .b = other}); });
    return false;
  }
  const Handle<Particle> handle = twins.one.handle<Particle>(particle);
  if (both([&](World& world) { world.remove(particle); })) {
    twins.gone.push_back(handle);
    EXPECT_FALSE(twins.one.has(handle));
  }
  return true;
}

/// Returns how many numbers of a kind a world has.
template <class Item>
std::uint32_t numbers_of(const World& world) {
  std::uint32_t count = 0;
  while (test::refusal([&] { (void)world.handle<Item>(count); }).empty()) ++count;
  return count;
}

/// Cuts an item of a kind out of both, if they have one by a number that is chosen.
template <class Item>
void sever(Twins& twins, Random& random) {
  const std::uint32_t count = numbers_of<Item>(twins.one);
  if (count == 0) return;
  const Handle<Item> item = twins.one.handle<Item>(below(random, count));
  if (!item) return;
  const std::string why = test::refusal([&] { twins.one.cut(item); });
  EXPECT_EQ(why, test::refusal([&] { twins.two.cut(item); }));
  EXPECT_TRUE(twins.one.has(item));
}

/// Joins particles of both by a spring, an alignment or the drive of an angle, or one to a ball that is added
/// where it is.
void join_by_joint(Twins& twins, Random& random) {
  const auto some = [&] { return below(random, twins.one.particle_count()); };
  const std::uint32_t particle = some(), other = some(), kind = below(random, 4);
  if (!twins.one.handle<Particle>(particle)) return;
  const auto join_both = [&](const auto& item) {
    const std::string why = test::refusal([&] { twins.one.join(item); });
    EXPECT_EQ(why, test::refusal([&] { twins.two.join(item); }));
  };
  if (kind == 0)
    return join_both(Spring{
        .a = point_at(particle), .b = point_at(other), .length = 0.15, .stiffness = 3, .damping = 0.01});
  const Direction u{point_at(particle), point_at(other)}, v{point_at(some()), point_at(some())};
  if (kind == 1) return join_both(Alignment{.u = u, .v = v});
  if (kind == 2) return join_both(AngleControl{.u = u, .v = v, .stiffness = 0.01, .damping = 1e-4});
  Scene ball;
  ball.particles = {{.position = twins.one.position(particle), .velocity = {0, 0.5, 0}, .mass = 0.1}};
  const std::uint32_t added = twins.one.add(ball).particle;
  EXPECT_EQ(twins.two.add(ball).particle, added);
  note(twins, ball, added);
  join_both(Pin{.a = point_at(particle), .b = point_at(added)});
}

/// Saves one of the twins, and lets a third world go on from there.
void expect_restored(const Scene& scene, Twins& twins) {
  std::vector<std::byte> bytes(twins.one.snapshot_size());
  twins.one.save(bytes);
  World third(scene, twins.one.settings());
  third.restore(bytes);
  EXPECT_EQ(third.state_hash(), twins.one.state_hash());
  for (std::uint32_t i = 0; twins.one.settings().tensions && i < numbers_of<Capsule>(twins.one); ++i)
    EXPECT_EQ(third.has_shape({ShapeKind::capsule, i}), twins.one.has_shape({ShapeKind::capsule, i}));
  twins.one.step(twins.frame);
  twins.two.step(twins.frame);
  third.step(twins.frame);
  EXPECT_EQ(third.state_hash(), twins.one.state_hash());
}

/// Lets a world go back to its own past, of which nothing that it did since is left.
void go_on_and_back(World& world, double dt) {
  const test::Snapshot before = test::snapshot_of(world);
  world.step(dt);
  world.restore(before);
  EXPECT_EQ(test::snapshot_of(world), before);
}

/// Begins a world anew with what there is of one. It is where that is, and a step later too, if steps are
/// solved and remember nothing.
void expect_begun_anew(World& world, double dt) {
  World anew(world.scene(), world.settings());
  std::vector<std::uint32_t> there;
  for (std::uint32_t i = 0; i < world.particle_count(); ++i)
    if (world.handle<Particle>(i)) there.push_back(i);
  ASSERT_EQ(anew.particle_count(), there.size());
  const auto farthest = [&] {
    double most = 0;
    for (std::uint32_t k = 0; k < there.size(); ++k)
      most = std::max(most, norm(anew.position(k) - world.position(there[k])));
    return most;
  };
  EXPECT_LE(farthest(), anew.info().projected_position);
  const StepReport one = world.step(dt), other = anew.step(dt);
  const Settings& settings = world.settings();
  const auto remembers = [](const StepReport& of) {
    return of.guarded_energy + of.trimmed_energy + of.unsolved + of.fallbacks > 0;
  };
  const Gradient by_default = world.info().linkages > 0 ? Gradient::old : Gradient::mid;
  const bool is_solved = settings.method != Method::relax && !settings.accuracy &&
                         settings.gradient.value_or(by_default) == Gradient::mid && !remembers(one) &&
                         !remembers(other);
  // Rods that turn by a radian a substep, and those that have just been wound, have velocities along them.
  if (is_solved && anew.info().projected_velocity <= 1e-8) {
    EXPECT_LE(farthest(), 1e-6) << "which is what sweeps over contacts leave";
  }
}

void try_world(std::uint32_t seed, std::uint64_t& edits, bool severs) {
  SCOPED_TRACE(seed);
  Random random(seed), of_joints(seed);
  const Scene scene = random_scene(random);
  Settings settings{.method = seed % 3 == 0 ? Method::relax : Method::automatic,
                    .substeps = 2,
                    .tensions = seed % 2 == 0,
                    .contacts = seed % 5 == 0,
                    .threads = 1};
  if (settings.method == Method::relax) settings.stop.sweeps = 20;
  Settings with_two = settings;
  with_two.threads = 2;
  Twins twins{World(scene, settings),
              World(scene, with_two),
              {},
              {},
              {},
              {},
              {},
              static_cast<std::uint32_t>(scene.rods.size())};
  note(twins, scene, 0);
  twins.ropes.clear();
  for (std::uint32_t i = 0; i < scene.particles.size(); ++i) {
    const bool begins =
        std::none_of(scene.rods.begin(), scene.rods.end(), [&](const Rod& rod) { return rod.b == i; });
    twins.ropes.push_back(begins ? i : twins.ropes.back());
  }
  for (int turn = 0; turn < 6; ++turn) {
    bool may_jump = false;
    for (std::uint32_t k = 0, count = 1 + below(random, 3); k < count; ++k, ++edits)
      may_jump = edit(twins, random) || may_jump;
    if (severs && below(of_joints, 2) == 0) {
      ++edits;
      const std::uint32_t kind = below(of_joints, 4);
      if (kind == 0) sever<Pin>(twins, of_joints);
      if (kind == 1) sever<Spring>(twins, of_joints);
      if (kind == 2) sever<Alignment>(twins, of_joints);
      if (kind == 3) sever<AngleControl>(twins, of_joints);
    }
    if (severs && below(of_joints, 3) == 0) {
      ++edits;
      join_by_joint(twins, of_joints);
    }
    const Vec3 before = twins.momentum();
    bool has_fixed = false;
    for (std::uint32_t i = 0; i < twins.one.particle_count(); ++i)
      has_fixed = has_fixed || (twins.one.handle<Particle>(i) && twins.one.velocity(i) == Vec3{});
    twins.one.step(twins.frame);
    twins.two.step(twins.frame);
    EXPECT_EQ(test::snapshot_of(twins.one), test::snapshot_of(twins.two));
    if (turn % 2 == 1) go_on_and_back(twins.two, twins.frame);
    if (!may_jump && !has_fixed && !twins.is_pushed) {
      EXPECT_LE(norm(twins.momentum() - before), 1e-9);
    }
    for (std::uint32_t i = 0; i < twins.one.particle_count(); ++i)
      if (twins.one.handle<Particle>(i)) {
        EXPECT_TRUE(is_finite(twins.one.position(i))) << i;
      }
    for (const Handle<Particle> handle : twins.gone)
      EXPECT_NE(test::refusal([&] { (void)twins.one.number(handle); }), "");
  }
  expect_restored(scene, twins);
  if (!twins.is_pushed) expect_begun_anew(twins.one, twins.frame);
}

// Twins on one and on two threads stay alike, snapshots go on alike, cuts keep momentum, and what is gone is
// refused.
TEST(RandomEdits, KeepWhatTheyPromise) {
  const char* const asked = std::getenv("PLUMB_EDITS");
  const std::uint64_t count = asked ? std::strtoull(asked, nullptr, 10) : test::sanitized ? 1000 : 2000;
  std::uint64_t edits = 0;
  for (std::uint32_t seed = 0; edits < count && !testing::Test::HasFailure(); ++seed)
    try_world(seed, edits, true);
  EXPECT_GE(edits, testing::Test::HasFailure() ? 0 : count);
}

// Boxes are added within a rope that flies as they do. What pushes them apart is relaxed in the end, and held
// back to the motion that all have in common.
TEST(RandomEdits, KeepMomentumOfWhatFliesAsOne) {
  std::uint64_t edits = 0;
  try_world(1650, edits, false);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
