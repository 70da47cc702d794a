// Numbers, snapshots, scenes and settings of worlds of which joints and springs were cut.

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>

#include "plumb/plumb.hpp"
#include "support/edited_worlds.hpp"
#include "support/figures.hpp"
#include "support/severed.hpp"
#include "support/snapshots.hpp"
#include "support/worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using test::cut;
using test::expect_refusal;
using test::for_jointed_settings;
using test::frame;
using test::sever;
using test::step;
using test::thrown;

TEST(Severing, GivesNumbersBack) {
  Scene scene = thrown();
  World world(scene, {.substeps = 4});
  const Handle<Pin> pin = world.handle<Pin>(0);
  const Handle<Rod> rod = world.handle<Rod>(0);
  world.step(frame);
  expect_refusal("the handle names none", [&] { world.cut(Handle<Torsion>{}); });
  expect_refusal("rod 0: is of a body", [&] { world.cut(rod); });
  world.cut(pin);
  world.cut(pin);
  EXPECT_TRUE(world.has(pin));
  EXPECT_EQ(world.add(test::figure({0, 9, 0})).pin, 1u) << "it is not free yet";
  world.step(frame);
  EXPECT_FALSE(world.has(pin));
  EXPECT_FALSE(world.handle<Pin>(0));
  expect_refusal("pin 0: was removed", [&] { world.cut(pin); });
  const Added next = world.add(test::figure({5, 9, 0}));
  EXPECT_EQ(next.pin, 0u);
  EXPECT_TRUE(world.has(world.handle<Pin>(0)));
  EXPECT_FALSE(world.has(pin));
  world.step(frame);
  expect_refusal("pin 0: was removed; its handle is of generation 1, now 3", [&] { world.cut(pin); });
  EXPECT_EQ(world.scene().pins.size(), 2u);
  const std::size_t islands = world.info().islands;
  sever(world, next);
  world.step(frame);
  EXPECT_EQ(world.info().islands, islands + 1);
}

// What is removed has no orders, and its numbers may be given at once to what has none, either.
TEST(Severing, IsForgottenWithWhatIsRemoved) {
  World world(thrown(), {.substeps = 4}), other(thrown(), {.substeps = 4});
  for (World* const each : {&world, &other}) each->step(frame);
  sever(world);
  for (World* const each : {&world, &other}) {
    each->remove(0);
    EXPECT_EQ(each->add(test::figure({0, 3, 0})).pin, 0u);
    step(*each, 3);
    EXPECT_TRUE(each->handle<Pin>(0));
  }
  EXPECT_EQ(world.state_hash(), other.state_hash());
  EXPECT_EQ(test::snapshot_of(world), test::snapshot_of(other));
}

TEST(Severing, IsRefusedWhereNothingIsEdited) {
  Scene scene;
  scene.particles = {{.position = {0, 0, 0}, .fixed = true}, {.position = {1, 0, 0}, .mass = 1}};
  scene.rods = {{.a = 0, .b = 1}};
  World world(scene, {.method = Method::multipliers});
  expect_refusal("edits no world", [&] { cut<Rod>(world); });
}

// Snapshots have cuts that wait and those that were done, whose numbers something else may have.
TEST(Severing, IsKnownToSnapshots) {
  for_jointed_settings([](const Settings& settings) {
    const Scene scene = thrown();
    World world(scene, settings);
    step(world, 3);
    const test::Snapshot early = test::snapshot_of(world);
    sever(world);
    const auto expect_alike = [&](const char* when) {
      SCOPED_TRACE(when);
      World other(scene, settings);
      const test::Snapshot bytes = test::snapshot_of(world);
      other.restore(bytes);
      EXPECT_EQ(test::snapshot_of(other), bytes);
      step(world, 3);
      step(other, 3);
      EXPECT_EQ(world.state_hash(), other.state_hash());
      EXPECT_EQ(world.has(Handle<Pin>{0, 1}), other.has(Handle<Pin>{0, 1}));
    };
    expect_alike("while it waits");
    expect_alike("after it");
    const Added added = world.add(test::figure({3, 2, 0}));
    EXPECT_EQ(added.pin, 0u);
    expect_alike("when numbers are given anew");
    sever(world, added);
    expect_alike("when those are cut");
    world.remove(added.particle);
    world.remove(0);
    expect_alike("when a part was removed");
    world.restore(early);
    EXPECT_TRUE(world.has(Handle<Pin>{0, 1}));
    step(world, 1);
    EXPECT_TRUE(is_finite(world.pin_force(0)));
  });
}

// A world begins with what is left, and goes on alike. One under other settings does so, too.
TEST(Severing, IsInScenesAndOtherSettings) {
  for_jointed_settings([](const Settings& settings) {
    World world(thrown(), settings);
    step(world, 3);
    sever(world);
    Settings finer = settings;
    finer.substeps = 8;
    finer.gradient = Gradient::mid;
    finer.method = Method::direct;
    finer.stop = {};
    world.set_settings(finer);
    step(world, 1);
    EXPECT_EQ(world.info().islands, 3u);
    EXPECT_FALSE(world.handle<Pin>(0));
    World fresh(world.scene(), finer);
    EXPECT_TRUE(world.scene().pins.empty() && world.scene().angles.empty());
    for (World* const each : {&world, &fresh}) step(*each, 10);
    for (std::uint32_t i = 0; i < world.particle_count(); ++i)
      EXPECT_LE(norm(world.position(i) - fresh.position(i)), 1e-9) << i;
  });
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
