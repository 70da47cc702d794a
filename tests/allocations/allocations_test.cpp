// World::step allocates nothing after its first call. This program has a malloc of its own, which counts;
// operator new ends there too. Sanitizers bring their own malloc, so there is nothing to count under them.

#include <gtest/gtest.h>

#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "plumb/plumb.hpp"
#include "scenes/generators/falling.hpp"
#include "scenes/generators/generators.hpp"
#include "scenes/humanoid/humanoid.hpp"
#include "scenes/spec.hpp"
#include "support/executors.hpp"
#include "support/mechanisms.hpp"
#include "support/reeled_chain.hpp"
#include "support/sanitizers.hpp"
#include "support/sprung_rods.hpp"
#include "support/worlds.hpp"

namespace {
std::atomic<bool> counting{false};
std::atomic<std::uint64_t> allocations{0};

[[maybe_unused]] void count() {
  if (counting.load(std::memory_order_relaxed)) allocations.fetch_add(1, std::memory_order_relaxed);
}
}  // namespace

#if defined(__GLIBC__)
#define PLUMB_COUNTS_ALLOCATIONS 1
#endif
#if defined(__SANITIZE_THREAD__) || defined(__SANITIZE_ADDRESS__) || PLUMB_HAS_FEATURE(thread_sanitizer) || \
    PLUMB_HAS_FEATURE(address_sanitizer)
#undef PLUMB_COUNTS_ALLOCATIONS
#endif

#if defined(PLUMB_COUNTS_ALLOCATIONS)
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);

void* malloc(std::size_t size) {
  count();
  return __libc_malloc(size);
}
void* calloc(std::size_t n, std::size_t size) {
  count();
  return __libc_calloc(n, size);
}
void* realloc(void* old, std::size_t size) {
  count();
  return __libc_realloc(old, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  count();
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  count();
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** out, std::size_t alignment, std::size_t size) {
  count();
  *out = __libc_memalign(alignment, size);
  return *out != nullptr ? 0 : ENOMEM;
}
void free(void* memory) {
  __libc_free(memory);
}
}
constexpr bool counts_allocations = true;
#else
constexpr bool counts_allocations = false;
#endif

namespace plumb::PLUMB_TEST_FILE {
namespace {

/// Allocations while f() runs, on all threads.
template <class F>
std::uint64_t allocations_in(F&& f) {
  allocations = 0;
  counting = true;
  f();
  counting = false;
  return allocations;
}

class Allocations : public testing::Test {
 protected:
  void SetUp() override {
    if (!counts_allocations) GTEST_SKIP() << "malloc belongs to a sanitizer or is not glibc's";
  }
};

TEST_F(Allocations, AreCounted) {
  std::unique_ptr<std::vector<int>> kept;
  EXPECT_EQ(allocations_in([&] { kept = std::make_unique<std::vector<int>>(100); }), 2u);
  struct alignas(64) Wide {
    char bytes[64];
  };
  std::unique_ptr<Wide> wide;
  EXPECT_EQ(allocations_in([&] { wide = std::make_unique<Wide>(); }), 1u);
  EXPECT_EQ(allocations_in([] {}), 0u);
}

/// Every shape, large enough to be shared by threads.
Scene everything() {
  Scene scene = scenes::make_net(64, 48);
  for (const Scene& more :
       {scenes::make_chain(5000, 0.1, 10), scenes::make_ensemble({.chains = 50, .links = 8}),
        scenes::make_graph({.particles = 2000, .degree = 5})}) {
    const auto first = static_cast<std::uint32_t>(scene.particles.size());
    scene.particles.insert(scene.particles.end(), more.particles.begin(), more.particles.end());
    for (Rod rod : more.rods) {
      rod.a += first;
      rod.b += first;
      scene.rods.push_back(rod);
    }
  }
  return scene;
}

struct Variant {
  const char* name;
  Settings settings;
};
std::vector<Variant> variants() {
  const StopRule sweeps{.sweeps = 3};
  std::vector<Variant> all{
      {"new", {.stop = sweeps}},
      {"float", {.precision = Precision::single, .stop = sweeps}},
      {"old", {.gradient = Gradient::old, .substeps = 3, .stop = sweeps}},
      {"mid", {.gradient = Gradient::mid, .substeps = 2, .stop = sweeps}},
      {"jacobi", {.order = SweepOrder::jacobi, .stop = sweeps}},
      {"tolerance", {.stop = {.sweeps = 10, .tolerance = 1e-4}}},
      {"budget", {.stop = {.sweeps = 10, .budget_us = 1e9}}},
  };
  for (Variant& variant : all) variant.settings.method = Method::relax;  // automatic solves nets
  return all;
}

TEST_F(Allocations, AreNoneInStep) {
  const Scene scene = everything();
  for (const Variant& variant : variants()) {
    Settings settings = variant.settings;
    settings.threads = 1;
    World world(scene, settings);
    world.step(1.0 / 60);
    EXPECT_EQ(allocations_in([&] { test::run(world, 1.0 / 60, 5); }), 0u) << variant.name;
    EXPECT_EQ(allocations_in([&] { world.step(1.0 / 90); }), 0u) << variant.name << ": another dt";
  }
}

// Rods keep what longer steps left. The net has touched in as many places before.
TEST_F(Allocations, AreNoneInShorterStepsOfWhatTouches) {
  for (const Precision precision : {Precision::single, Precision::double_}) {
    World world(scenes::make_drape({.size = 12}),
                {.method = Method::relax, .precision = precision, .threads = 1});
    test::run(world, 1.0 / 60, 120);
    EXPECT_EQ(allocations_in([&] {
                for (int i = 0; i < 20; ++i) world.step(i % 2 == 0 ? 1e-2 : 1.0 / 60);
              }),
              0u)
        << to_string(precision);
  }
}

TEST_F(Allocations, AreNoneInStepWithTwoThreads) {
  const Scene scene = everything();
  test::PoolExecutor pool(2);
  detail::EagerExecutor eager(pool, test::early);
  for (const Variant& variant : variants()) {
    Settings settings = variant.settings;
    settings.threads = 2;
    settings.executor = &eager;
    World world(scene, settings);
    ASSERT_TRUE(world.info().parallel);
    world.step(1.0 / 60);
    EXPECT_EQ(allocations_in([&] { test::run(world, 1.0 / 60, 5); }), 0u) << variant.name;
  }
}

// oneTBB keeps memory of its own for tasks, which it fills up as its threads come to life.
TEST_F(Allocations, AreNoneInStepWithTheBuiltInExecutorOnceItIsWarm) {
  const std::unique_ptr<Executor> built_in = make_default_executor(2);
  detail::EagerExecutor eager(*built_in, test::early);
  World world(everything(),
              {.method = Method::relax, .stop = {.sweeps = 3}, .threads = 2, .executor = &eager});
  ASSERT_TRUE(world.info().parallel);
  test::run(world, 1.0 / 60, 50);
  EXPECT_EQ(allocations_in([&] { test::run(world, 1.0 / 60, 50); }), 0u);
}

// What changes between steps may allocate when it is asked for, not when it takes effect.
TEST_F(Allocations, AreNoneInStepsAfterChanges) {
  const Scene scene = scenes::make_chain(100);
  World world(scene, {.method = Method::relax, .threads = 1});
  world.step(1.0 / 60);
  world.set_weights(Weights::equal);
  world.set_stop_rule({.sweeps = 5, .tolerance = 1e-3});
  world.set_force(7, {1, 2, 3});
  EXPECT_EQ(allocations_in([&] { world.step(1.0 / 60); }), 0u);
}

// A grab makes its room as it is given, and while its target moves nothing more is needed.
TEST_F(Allocations, AreNoneInStepsThatGrab) {
  // What is dragged over ground touches more than ever before at any time, so that there is none.
  Scene jointed = scenes::make_humanoid({.body = scenes::BodyType::medium, .arms = 1});
  jointed.planes.clear();
  const Scene scenes_of[] = {scenes::make_humanoid(), scenes::make_chain(200), scenes::make_net(20, 20),
                             jointed};
  for (const Scene& scene : scenes_of)
    for (const Settings& settings :
         {Settings{.method = Method::relax, .threads = 1}, Settings{.method = Method::direct, .threads = 1},
          Settings{.method = Method::direct, .gradient = Gradient::old, .accuracy = 1e-3, .threads = 1}}) {
      World world(scene, settings);
      world.step(1.0 / 60);
      std::uint32_t held = 5;
      while (scene.particles[held].fixed) ++held;
      const Handle<Grab> grab = world.grab(Grab::particle(held, world.position(held), 1e4, 10));
      const auto pull = [&](int frames) {
        for (int i = 0; i < frames; ++i) {
          world.move_grab(grab, world.position(held) + Vec3{0.002, 0.001, 0.001});
          world.step(1.0 / 60);
        }
      };
      pull(40);
      EXPECT_EQ(allocations_in([&] { pull(10); }), 0u)
          << scene.particles.size() << to_string(settings.method);
    }
}

// What is added makes its room in its first step, and what is removed leaves its own.
TEST_F(Allocations, AreNoneInStepsOfWhatIsAdded) {
  const Scene rope = scenes::make_chain(12);
  for (const Method method : {Method::direct, Method::relax}) {
    World world(scenes::load_scene("ensemble:chains=20,links=6"),
                {.method = method, .tensions = true, .threads = 1});
    world.step(1.0 / 60);
    const Added first = world.add(rope);
    world.step(1.0 / 60);
    EXPECT_EQ(allocations_in([&] { test::run(world, 1.0 / 60, 5); }), 0u) << to_string(method);
    world.remove(first.particle + 1);
    world.remove(1);
    EXPECT_EQ(allocations_in([&] { test::run(world, 1.0 / 60, 5); }), 0u) << to_string(method);
  }
}

TEST_F(Allocations, AreNoneInStepsOfWires) {
  for (const Gradient gradient : {Gradient::mid, Gradient::new_}) {
    World world(scenes::load_scene("wire"),
                {.method = Method::direct, .gradient = gradient, .substeps = 2, .threads = 1});
    world.step(1.0 / 60);
    world.set_twist(0, 4);
    EXPECT_EQ(allocations_in([&] { test::run(world, 1.0 / 60, 10); }), 0u) << to_string(gradient);
  }
}

// Thin ones are factorised anew in most substeps; the flat net falls back and compromises too. The wide net
// is solved by its lines.
TEST_F(Allocations, AreNoneInStepsOfLoops) {
  for (const Gradient gradient : {Gradient::old, Gradient::mid, Gradient::new_}) {
    const Settings settings{.method = Method::direct, .gradient = gradient, .substeps = 2, .threads = 1};
    for (const Scene& scene :
         {scenes::make_truss({.braces = 2, .fixed = 2}), scenes::make_net({.width = 8, .height = 8}),
          scenes::make_net({.width = 16, .height = 16, .level = 1})}) {
      World world(scene, settings);
      world.step(1.0 / 60);
      EXPECT_EQ(allocations_in([&] { test::run(world, 1.0 / 60, 10); }), 0u) << to_string(gradient);
    }
  }
}

TEST_F(Allocations, AreNoneInStepsWithAccuracy) {
  for (const auto& [gradient, order] :
       {std::pair{Gradient::old, 2u}, {Gradient::old, 4u}, {Gradient::mid, 2u}, {Gradient::new_, 2u}}) {
    const Settings settings{
        .method = Method::direct, .gradient = gradient, .time_order = order, .accuracy = 1e-3, .threads = 1};
    for (const Scene& scene : {scenes::make_chain(20), scenes::make_tree(), scenes::make_truss({.fixed = 2}),
                               scenes::make_net({.width = 16, .height = 16, .level = 1})}) {
      World world(scene, settings);
      test::run(world, 1.0 / 60, 2);
      EXPECT_EQ(allocations_in([&] { test::run(world, 1.0 / 60, 10); }), 0u)
          << to_string(gradient) << ", order " << order;
    }
  }
}

TEST_F(Allocations, AreNoneInStepsThatMoveAnchors) {
  World world(scenes::make_chain(100), {.method = Method::relax, .threads = 1});
  world.step(1.0 / 60);
  world.move_anchor(0, {0, 1, 0});
  EXPECT_EQ(allocations_in([&] { world.step(1.0 / 60); }), 0u);
}

// Freezing an island may allocate, in the step that does it only.
TEST_F(Allocations, AreNoneInStepsWithLoadsTacklesAndReactions) {
  Scene machine;
  machine.particles = {test::movable({0, -2, 0}, 3), test::fixed({}), test::movable({1, -1, 0}),
                       test::movable({2, -1, 0})};
  machine.rods = {{.a = 2, .b = 3}};
  machine.tackles = {{.particles = {0, 1, 2}}};
  Scene rubbing = machine;
  rubbing.tackles[0].friction = 0.2;
  for (const Scene& scene : {scenes::make_chain(20), machine, rubbing}) {
    World world(scene, {.method = Method::direct, .tensions = true});
    world.set_load([](const LoadState& state, std::span<Vec3> forces) {
      for (std::size_t i = 0; i < forces.size(); ++i) forces[i] -= state.time * state.velocities[i];
    });
    std::vector<Vec3> reactions(scene.particles.size());
    const auto step = [&] {
      if (!scene.tackles.empty()) world.set_tackle_length(0, 3 + 0.01 * world.time());
      test::run(world, 1.0 / 60, 2);
      world.copy_reactions(reactions);
    };
    step();
    EXPECT_EQ(allocations_in([&] { step(); }), 0u);
  }
}

TEST_F(Allocations, AreNoneInStepsThatReel) {
  for (const Gradient gradient : {Gradient::mid, Gradient::new_}) {
    World world(test::make_reeled({.direction = {0.6, -0.8, 0}}),
                {.method = Method::direct, .gradient = gradient, .tensions = true});
    const auto reel = [&](double rate) {
      for (int i = 0; i < 40; ++i) {
        world.set_reel(0, world.reel_out(0) + rate / 60);
        world.step(1.0 / 60);
        (void)world.reaction(0);
      }
    };
    reel(-1);
    EXPECT_EQ(allocations_in([&] { reel(0.9); }), 0u);
    EXPECT_EQ(allocations_in([&] { reel(-1); }), 0u);
  }
}

// A first round makes room for the largest lists.
TEST_F(Allocations, AreNoneInSnapshots) {
  const std::pair<const char*, Settings> cases[] = {
      {"ensemble:chains=20,links=6", {.method = Method::relax, .precision = Precision::single}},
      {"ensemble:chains=20,links=6", {.method = Method::direct, .accuracy = 1e-3, .tensions = true}},
      {"net:width=16,height=16", {.method = Method::direct, .gradient = Gradient::old}},
      {"crowd:humanoids=3,hit=1", {.contacts = true}},
      {"heap:ropes=5,links=8", {.substeps = 4}}};
  for (const auto& [spec, settings] : cases) {
    World world(scenes::load_scene(spec), settings);
    test::run(world, 1.0 / 60, 60);
    std::vector<std::byte> bytes(2 * world.snapshot_size());
    const auto round = [&] {
      world.save(bytes);
      test::run(world, 1.0 / 60, 5);
      world.restore(bytes);
    };
    round();
    EXPECT_EQ(allocations_in([&] {
                world.save(bytes);
                world.restore(bytes);
                world.snapshot_size();
              }),
              0u)
        << spec;
    round();
    EXPECT_EQ(allocations_in(round), 0u) << spec;
  }
}

TEST_F(Allocations, AreNoneOnceAnIslandIsFrozen) {
  for (const LayoutChoice layout :
       {LayoutChoice::automatic, LayoutChoice::aos, LayoutChoice::soa, LayoutChoice::aosoa})
    for (const std::uint32_t links : {7u, 100u}) {
      World world(scenes::make_chain(links),
                  {.method = Method::relax, .precision = Precision::single, .layout = layout, .threads = 1});
      test::run(world, 1.0 / 60, 10);
      world.set_force(links, {1e300, 0, 0});
      ASSERT_EQ(world.step(1.0 / 60).frozen_islands, 1u);
      EXPECT_EQ(allocations_in([&] { test::run(world, 1.0 / 60, 5); }), 0u)
          << to_string(layout) << ", " << links;
    }
}

// Trees that are solved directly: in lanes and alone, cut steps, repeated ones and moved anchors included.
TEST_F(Allocations, AreNoneInStepsOfMethodDirect) {
  const Scene lanes = scenes::make_ensemble({.chains = 20, .links = 6, .end_mass = 100, .vary = 0.5});
  const Scene alone = scenes::make_chain(20, 0.1, 100);
  for (const Scene& scene : {lanes, alone})
    for (const Precision precision : {Precision::single, Precision::double_})
      for (const Gradient gradient : {Gradient::new_, Gradient::old, Gradient::mid})
        for (const bool controlled : {false, true}) {
          Settings settings{
              .method = Method::direct, .precision = precision, .gradient = gradient, .threads = 1};
          if (controlled) settings.accuracy = 1e-3;
          World world(scene, settings);
          world.step(1.0 / 60);
          world.move_anchor(0, {0, 0.01, 0});
          EXPECT_EQ(allocations_in([&] {
                      test::run(world, 1.0 / 60, 20);
                      world.set_force(3, {1, 2, 3});
                      world.step(1.0 / 20);
                      test::run(world, 1.0 / 90, 5);
                      world.velocity(1);
                      world.state_hash();
                    }),
                    0u)
              << to_string(precision) << ", " << to_string(gradient) << (controlled ? ", accuracy" : "");
        }
}

// On trees; Eigen's sparse factorisation, which islands with loops go through, takes memory each time.
TEST_F(Allocations, AreNoneInStepsOfMultipliersAndFeatherstone) {
  Scene scene = scenes::make_chain(20);
  scene.rods.push_back({.a = 5, .b = 21});
  scene.particles.push_back(test::movable({0.5, 0.2, 0}));
  scene.drag = 0.1;
  for (const Method method : {Method::multipliers, Method::featherstone})
    for (const Integrator integrator :
         {Integrator::explicit_euler, Integrator::semi_implicit_euler, Integrator::rk2, Integrator::rk4}) {
      World world(scene, {.method = method, .substeps = 4, .integrator = integrator, .threads = 1});
      world.step(1.0 / 60);
      world.move_anchor(0, {0, 0.01, 0});
      EXPECT_EQ(allocations_in([&] {
                  world.step(1.0 / 60);
                  world.set_force(3, {1, 2, 3});
                  world.step(1.0 / 90);
                  world.state_hash();
                }),
                0u)
          << to_string(method) << ", " << to_string(integrator);
    }
}

// Figures that touch: once a scene has been as lively as it gets. Contacts come and go, and clusters of
// islands with them; what they need is kept, but a new most takes memory.
TEST_F(Allocations, AreNoneInStepsOfFiguresOnceWarm) {
  for (const char* spec : {"humanoid:body=medium", "stick_box", "drop", "crowd:humanoids=16,hit=8,body=thin"})
    for (const bool sleep : {false, true}) {
      Scene scene = scenes::load_scene(spec);
      for (Particle& particle : scene.particles) particle.asleep = false;
      World world(scene, {.method = Method::direct, .sleep = sleep, .threads = 1});
      test::run(world, 1.0 / 60, 600);
      EXPECT_EQ(allocations_in([&] { test::run(world, 1.0 / 60, 300); }), 0u) << spec;
      world.set_force(0, {1, 2, 3});
      EXPECT_EQ(allocations_in([&] { test::run(world, 1.0 / 90, 100); }), 0u) << spec << ", a force";
    }
}

// Capsules that fall onto a plane and each other, at a stated capacity: 50 of them, once they have all
// landed.
TEST_F(Allocations, AreNoneInStepsOfFiftyFallenCapsules) {
  Scene scene;
  scene.planes.push_back({});
  for (std::uint32_t i = 0; i < 50; ++i) {
    const double x = 0.6 * (i % 5), y = 0.2 + 0.12 * (i / 5), turn = i % 3 * 0.1;
    scene.particles.push_back(test::movable({x, y, 0}, 0));
    scene.particles.push_back(test::movable({x + 0.4, y + turn, 0.1 * (i % 2)}, 0));
    scene.rods.push_back({.a = 2 * i, .b = 2 * i + 1, .mass = 1});
    scene.capsules.push_back({.a = point_at(2 * i), .b = point_at(2 * i + 1), .radius = 0.05});
  }
  for (const Method method : {Method::automatic, Method::relax}) {
    World world(scene, {.method = method, .sleep = false, .threads = 1});
    test::run(world, 1.0 / 60, 300);
    EXPECT_EQ(allocations_in([&] { test::run(world, 1.0 / 60, 60); }), 0u) << to_string(method);
  }
}

/// Boxes and flat coins of hulls, and balls, that fall onto ground of every kind, and onto each other.
Scene solids_on_ground() {
  Scene scene;
  scene.planes.push_back({.offset = -0.5});
  scene.meshes.push_back(
      {.vertices = {{-2, 0, -2}, {2, 0, -2}, {2, 0, 2}, {-2, 0, 2}}, .triangles = {{0, 2, 1}, {0, 3, 2}}});
  scene.ground_hulls.push_back({.points = {{4, 0, 0}, {6, 0, -1}, {6, 0, 1}, {5, 0.5, 0}}});
  scene.ground_capsules.push_back({.a = {4, 0, -1}, .b = {6, 0, -1}, .radius = 0.3});
  HeightField field{.corner = {8, 0, -2}, .columns = 5};
  for (int i = 0; i < 25; ++i) field.heights.push_back(0.05 * (i % 3));
  scene.height_fields.push_back(field);
  for (const double x : {0.0, 5.0, 10.0})
    for (int i = 0; i < 6; ++i) {
      const Vec3 at{x + 0.05 * i, 0.8 + 0.3 * i, -0.1 * i};
      if (i % 3 == 2) {
        test::add_ball(scene, at, 0.1, 1, {}, {});
        continue;
      }
      MassProperties solid = i % 3 == 0 ? solid_box(2, {0.3, 0.2, 0.2})
                                        : MassProperties{.mass = 1, .inertia = {0.01, 0.02, 0.01}};
      solid.center = at;
      const Box box{.center = at, .half_size = i % 3 == 0 ? Vec3{0.15, 0.1, 0.1} : Vec3{0.15, 0.02, 0.15}};
      scene.hulls.push_back(box_on_body(add_body(scene, solid), box));
    }
  return scene;
}

// Meshes, hulls, ground capsules and height fields, once all lie: until then more places may be touched
// than ever before.
TEST_F(Allocations, AreNoneInStepsOfSolidsOnGroundOfEveryKind) {
  const Scene scene = solids_on_ground();
  for (const Method method : {Method::direct, Method::automatic, Method::relax}) {
    World world(scene, {.method = method, .substeps = 4, .sleep = false, .threads = 1});
    test::run(world, 1.0 / 60, 900);
    EXPECT_EQ(allocations_in([&] { test::run(world, 1.0 / 60, 120); }), 0u) << to_string(method);
  }
}

// Gradients new and mid keep what tells them how directions turn.
TEST_F(Allocations, AreNoneInStepsOfFiguresAlongOtherGradients) {
  for (const Gradient gradient : {Gradient::new_, Gradient::mid}) {
    Scene scene = scenes::load_scene("humanoid:body=medium");
    for (Particle& particle : scene.particles) particle.asleep = false;
    World world(scene, {.method = Method::direct, .gradient = gradient, .sleep = false, .threads = 1});
    test::run(world, 1.0 / 60, 600);
    EXPECT_EQ(allocations_in([&] { test::run(world, 1.0 / 60, 300); }), 0u) << to_string(gradient);
  }
}

TEST_F(Allocations, AreNoneWherePullsCount) {
  Scene swung;  // a rod on a spring, with a drive, that hangs low enough to touch the ground
  swung.particles = {test::fixed({}), test::fixed({0, 1, 0}), test::fixed({0, 0, 1}),
                     test::movable({1, 0, 0}, 1)};
  swung.rods = {{.a = 0, .b = 3, .mass = 2}};
  swung.springs = {{.a = point_at(1), .b = point_at(3), .length = 1, .stiffness = 20}};
  swung.angles = {
      {.u = {point_at(0), point_at(1)}, .v = {point_at(0), point_at(3)}, .upper = 2, .friction = 0.1}};
  swung.capsules = {{.a = point_at(3), .b = point_at(3), .radius = 0.1}};
  swung.planes = {{.offset = -0.3}};
  const Scene swing = swung, rope = scenes::make_chain(20);
  const Settings figures{.tensions = true, .threads = 1};
  Settings relaxed{.method = Method::relax, .tensions = true, .threads = 1}, accurate = relaxed;
  accurate.accuracy = 1e-2;
  for (const auto& [scene, settings] :
       {std::pair{&swing, figures}, std::pair{&rope, relaxed}, std::pair{&rope, accurate}}) {
    World world(*scene, settings);
    std::vector<double> tensions(scene->rods.size());
    std::vector<Vec3> reactions(scene->particles.size()), contacts(scene->capsules.size());
    const auto step = [&] {
      test::run(world, 1.0 / 60, 2);
      world.copy_tensions(tensions);
      world.copy_reactions(reactions);
      world.copy_contact_forces(contacts);
    };
    for (int i = 0; i < 60; ++i) step();
    EXPECT_EQ(allocations_in([&] { step(); }), 0u);
  }
}

// Once as much has touched as ever does: here all at once, again and again.
TEST_F(Allocations, AreNoneWhereContactIsReported) {
  for (const Method method : {Method::direct, Method::relax})
    for (const std::optional<double> accuracy : {std::optional<double>{}, std::optional{1e-2}}) {
      Scene scene;
      for (std::uint32_t i = 0; i < 40; ++i) {
        scene.particles.push_back(test::movable({0.3 * i, 0.3, 0}, 1));
        scene.capsules.push_back(
            {.a = point_at(i), .b = point_at(i), .radius = 0.1, .surface = {.restitution = 0.5}});
      }
      scene.planes = {{.surface = {.restitution = 1}}};
      Settings settings{.method = method, .substeps = 2, .tensions = true, .contacts = true, .threads = 1};
      settings.accuracy = accuracy;
      settings.sleep = false;
      World world(scene, settings);
      test::run(world, 1.0 / 60, 200);
      std::size_t seen = 0;
      EXPECT_EQ(allocations_in([&] {
                  for (int i = 0; i < 100; ++i) {
                    world.step(1.0 / 60);
                    seen += world.contacts().size();
                    world.contact_force({ShapeKind::plane, 0});
                  }
                }),
                0u)
          << to_string(method);
      EXPECT_GT(seen, 100u);
    }
}

// The step in which a rod breaks allocates nothing. The next one makes solvers of the parts of the island,
// and lists of what comes near grow as those with shapes part.
TEST_F(Allocations, AreNoneWhereRodsBreak) {
  Scene scene = scenes::make_chain(10), touching;
  scene.rods[4].law.strength = 200;
  touching = scene;
  touching.capsules = {{.a = point_at(10), .b = point_at(10), .radius = 0.1}};
  for (const Method method : {Method::relax, Method::direct})
    for (const std::optional<double> accuracy : {std::optional<double>{}, std::optional{1e-2}}) {
      Settings settings{.method = method, .threads = 1};
      settings.accuracy = accuracy;
      World world(method == Method::relax ? scene : touching, settings);
      test::run(world, 1.0 / 60, 30);
      world.set_force(10, {0, -1000, 0});
      const auto break_rod = [&] {
        for (int i = 0; i < 10 && !world.is_broken(4); ++i) world.step(1.0 / 60);
      };
      EXPECT_EQ(allocations_in(break_rod), 0u) << to_string(method);
      EXPECT_TRUE(world.is_broken(4));
      test::run(world, 1.0 / 60, method == Method::relax ? 1 : 20);
      EXPECT_EQ(allocations_in([&] { test::run(world, 1.0 / 60, 10); }), 0u) << to_string(method);
    }
}

// A governor has springs, dampers, alignments and a body. Its spring is changed before every step.
TEST_F(Allocations, AreNoneInStepsOfSprings) {
  const Scene scene = test::Governor::scene(false);
  World world(scene, {.method = Method::direct, .substeps = 4, .threads = 1});
  world.step(1.0 / 60);
  EXPECT_EQ(allocations_in([&] {
              for (int i = 0; i < 20; ++i) {
                Spring spring = scene.springs[0];
                spring.force = i;
                world.set_spring(0, spring);
                world.step(1.0 / 60);
              }
            }),
            0u);
}

TEST_F(Allocations, AreNoneWhereEnergyOfElasticsIsHeldBack) {
  std::uint64_t held_back = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    World world(test::bent_and_sprung(seed), {.method = Method::direct, .threads = 1});
    world.step(1.0 / 120);
    EXPECT_EQ(allocations_in([&] {
                for (int i = 0; i < 300; ++i) held_back += world.step(1.0 / 120).guarded_energy;
              }),
              0u)
        << seed;
  }
  EXPECT_GT(held_back, 0u);
}

TEST_F(Allocations, AreNoneInReading) {
  const Scene scene = scenes::make_chain(100);
  World world(scene, {.method = Method::relax, .threads = 1});
  world.step(1.0 / 60);
  std::vector<Vec3> out(world.particle_count());
  EXPECT_EQ(allocations_in([&] {
              world.copy_positions(out);
              world.copy_velocities(out);
              world.state_hash();
              world.position(3);
              world.info();
            }),
            0u);
}

TEST_F(Allocations, AreNoneInReadingAfterEdits) {
  const Scene rope = scenes::make_chain(40);
  for (const Method method : {Method::direct, Method::relax}) {
    World world(scenes::make_ensemble({.chains = 50, .links = 8}), {.method = method, .threads = 1});
    std::vector<Vec3> out;
    const auto expect_none = [&] {
      out.resize(world.particle_count());
      EXPECT_EQ(allocations_in([&] {
                  world.copy_positions(out);
                  world.copy_velocities(out);
                }),
                0u)
          << to_string(method);
    };
    world.step(1.0 / 60);
    const Added first = world.add(rope);
    expect_none();
    world.remove(first.particle + 1);
    expect_none();
    world.cut(3);
    world.step(1.0 / 60);
    expect_none();
  }
}

// Figures fall, touch, come to rest and are hit, and ropes rest all at once. Where clusters of what touches
// grow, that takes memory, and listing it takes no more.
TEST_F(Allocations, AreNoMoreWhereEventsAreListed) {
  std::size_t listed = 0;
  for (const char* const name : {"crowd:humanoids=6,hit=2", "boxes", "ensemble:chains=30,links=4"}) {
    Scene scene = scenes::load_scene(name);
    const bool touches = !scene.capsules.empty() || !scene.hulls.empty();
    if (!touches) scene.drag = 6;
    const auto allocated = [&](bool events) {
      World world(scene, {.events = events, .threads = 1});
      for (int i = 0; i < 30; ++i) world.step(1.0 / 60);
      return allocations_in([&] {
        for (int i = 0; i < 900; ++i) {
          world.step(1.0 / 60);
          if (events) listed += world.events().size();
        }
      });
    };
    const std::uint64_t without = allocated(false);
    EXPECT_LE(allocated(true), without + 1)
        << name << ": small arrays may fill a block of them a step sooner";
    if (!touches) {
      EXPECT_EQ(without, 0u) << name;
    }
  }
  EXPECT_GT(listed, 30u);
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
