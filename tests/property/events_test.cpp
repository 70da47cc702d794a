// Events are what a world reports otherwise, step by step: what sleeps, what broke, and what went wrong.

#include "step/state/events.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>
#include <tuple>
#include <vector>

#include "plumb/plumb.hpp"
#include "scenes/spec.hpp"
#include "support/edited_worlds.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

constexpr double frame = 1.0 / 60;

std::vector<Event> copy_of(std::span<const Event> events) {
  return {events.begin(), events.end()};
}
std::uint32_t count(const std::vector<Event>& events, Event::Kind kind) {
  return static_cast<std::uint32_t>(
      std::count_if(events.begin(), events.end(), [&](const Event& event) { return event.kind == kind; }));
}

/// Ropes that hang, come to rest by drag, and have weak rods some of which break.
Scene weak_ropes(std::uint32_t ropes) {
  Scene scene;
  scene.drag = 4;
  for (std::uint32_t rope = 0; rope < ropes; ++rope)
    for (std::uint32_t i = 0; i <= 12; ++i) {
      const auto number = static_cast<std::uint32_t>(scene.particles.size());
      scene.particles.push_back(
          {.position = {0.08 * i + 3.0 * rope, -0.06 * i, 0}, .mass = 0.1, .fixed = i == 0});
      if (i == 0) continue;
      scene.rods.push_back({.a = number - 1, .b = number});
      if (i % 5 == 0) scene.rods.back().law.strength = 6 + 1.5 * (rope % 5);
    }
  return scene;
}

/// Checks events of a world against what else it says, after every step.
class Watch {
 public:
  explicit Watch(World& world) : world_(world), was_broken_(world.rod_count(), false) {}

  std::vector<Event> step() {
    const StepReport report = world_.step(frame);
    const std::vector<Event> events = copy_of(world_.events());
    EXPECT_TRUE(std::is_sorted(events.begin(), events.end(), [](const Event& a, const Event& b) {
      return std::tie(a.kind, a.rod, a.particle) < std::tie(b.kind, b.rod, b.particle);
    }));
    const std::uint32_t woke = count(events, Event::Kind::woke),
                        fell = count(events, Event::Kind::fell_asleep);
    EXPECT_EQ(fell, report.fell_asleep);
    // Parts of what broke are islands from the next step on.
    if (awake_ && !has_broken_) {
      EXPECT_EQ(*awake_ + woke - fell, report.awake_islands);
    }
    awake_ = report.awake_islands;
    has_broken_ = report.broken_rods > 0;
    see_broken(events, report);
    see_problems(events);
    return events;
  }

 private:
  void see_broken(const std::vector<Event>& events, const StepReport& report) {
    std::vector<std::uint32_t> expected, got;
    for (std::uint32_t rod = 0; rod < world_.rod_count(); ++rod)
      if (world_.is_broken(rod) && !was_broken_[rod]) {
        expected.push_back(rod);
        was_broken_[rod] = true;
      }
    for (const Event& event : events)
      if (event.kind == Event::Kind::broke) got.push_back(event.rod);
    EXPECT_EQ(got, expected);
    EXPECT_EQ(got.size(), report.broken_rods);
  }
  void see_problems(const std::vector<Event>& events) const {
    std::vector<std::pair<std::string, std::uint32_t>> expected, got;
    for (const Problem& problem : world_.problems(std::numeric_limits<double>::infinity()))
      expected.emplace_back(to_string(problem.kind), problem.particle);
    for (const Event& event : events)
      if (event.kind > Event::Kind::broke) got.emplace_back(to_string(event.kind), event.particle);
    std::sort(expected.begin(), expected.end());
    std::sort(got.begin(), got.end());
    EXPECT_EQ(got, expected);
  }

  World& world_;
  std::vector<bool> was_broken_;
  std::optional<std::uint32_t> awake_{};
  bool has_broken_ = false;
};

struct Case {
  std::string name;
  Scene scene;
  Method method;
  int steps;
};
std::vector<Case> cases() {
  std::vector<Case> out;
  for (const Method method : {Method::direct, Method::relax})
    out.push_back({"weak ropes", weak_ropes(9), method, 700});
  for (const char* const scene : {"crowd:humanoids=6,hit=2", "boxes", "heap:ropes=4,links=6"})
    out.push_back({scene, scenes::load_scene(scene), Method::automatic, 400});
  return out;
}

TEST(Events, AreWhatAWorldReportsOtherwise) {
  std::uint32_t slept = 0, woke = 0, broke = 0;
  for (const Case& of : cases()) {
    SCOPED_TRACE(of.name + ' ' + std::string(to_string(of.method)));
    World world(of.scene, {.method = of.method, .events = true, .threads = 1});
    Watch watch(world);
    for (int step = 0; step < of.steps && !testing::Test::HasFailure(); ++step) {
      if (of.name == "weak ropes" && step == 500)
        for (std::uint32_t rope = 0; rope < 9; rope += 2) world.set_force(13 * rope + 2, {1, 0, 0});
      const std::vector<Event> events = watch.step();
      slept += count(events, Event::Kind::fell_asleep);
      woke += count(events, Event::Kind::woke);
      broke += count(events, Event::Kind::broke);
    }
  }
  EXPECT_GT(slept, 10u);
  EXPECT_GT(woke, 3u);
  EXPECT_GT(broke, 5u);
}

TEST(Events, NameWhatWentWrong) {
  Scene scene = weak_ropes(3);
  scene.particles[15].velocity = {1e200, 0, 0};
  for (const Method method : {Method::direct, Method::relax}) {
    World world(scene, {.method = method, .events = true, .threads = 1});
    Watch watch(world);
    std::uint32_t wrong = 0;
    for (int step = 0; step < 5; ++step)
      for (const Event& event : watch.step()) wrong += event.kind > Event::Kind::broke;
    EXPECT_GT(wrong, 0u) << to_string(method);
  }
}

TEST(Events, AreTheSameOnEveryMachine) {
  for (const Case& of : cases()) {
    std::vector<std::vector<Event>> first;
    for (const unsigned threads : {1u, 3u})
      for (const Isa isa : {Isa::scalar, best_isa()}) {
        World world(of.scene, {.method = of.method, .events = true, .isa = isa, .threads = threads});
        std::vector<std::vector<Event>> all;
        for (int step = 0; step < 150; ++step) {
          world.step(frame);
          all.push_back(copy_of(world.events()));
        }
        if (first.empty()) first = all;
        EXPECT_EQ(all, first) << of.name;
      }
  }
}

TEST(Events, ArePartOfSnapshots) {
  for (const Case& of : cases()) {
    const Settings settings{.method = of.method, .events = true, .threads = 1};
    World world(of.scene, settings), other(of.scene, settings);
    for (int step = 0; step < of.steps; ++step) {
      world.step(frame);
      if (world.events().empty()) continue;
      std::vector<std::byte> bytes(world.snapshot_size());
      world.save(bytes);
      other.restore(bytes);
      ASSERT_EQ(copy_of(other.events()), copy_of(world.events())) << of.name << ' ' << step;
      // What sleeps, and what broke, is known after that.
      World ahead(of.scene, settings);
      ahead.restore(bytes);
      world.step(frame);
      ahead.step(frame);
      ASSERT_EQ(copy_of(ahead.events()), copy_of(world.events())) << of.name << ' ' << step;
    }
  }
}

TEST(Events, AreThoseOfIslandsAsTheyAreNow) {
  World world(weak_ropes(4), {.method = Method::direct, .events = true, .threads = 1});
  const auto step = [&](int times) {
    for (int i = 0; i < times; ++i) world.step(frame);
    return copy_of(world.events());
  };
  std::uint32_t fell = 0;
  for (int i = 0; i < 1500; ++i) fell += count(step(1), Event::Kind::fell_asleep);
  ASSERT_GE(fell, 4u);
  // Both parts of a sleeping rope wake, and the cut itself is ordered.
  std::uint32_t intact = 0;
  while (world.is_broken(12 * intact + 4) || world.is_broken(12 * intact + 9)) ++intact;
  ASSERT_LT(intact, 4u);
  const std::uint32_t head = 13 * intact + 1;
  world.cut(12 * intact + 2);
  EXPECT_EQ(step(1), (std::vector<Event>{{Event::Kind::woke, head}, {Event::Kind::woke, head + 2}}));
  // What comes and goes is told by those who let it.
  Scene rope;
  rope.drag = 4;
  rope.particles = {{.fixed = true}, {.position = {0, -1, 0}, .mass = 1}};
  rope.rods = {{.a = 0, .b = 1}};
  const Added first = world.add(rope);
  EXPECT_TRUE(step(1).empty());
  std::vector<Event> events;
  for (int i = 0; i < 600 && events.empty(); ++i) {
    events = step(1);
    std::erase_if(events, [&](const Event& event) { return event.particle != first.particle + 1; });
  }
  EXPECT_EQ(events, (std::vector<Event>{{Event::Kind::fell_asleep, first.particle + 1}}));
  world.remove(first.particle + 1);
  world.add(rope);
  EXPECT_EQ(count(step(1), Event::Kind::woke), 0u);
}

TEST(Events, AreKnownIfAskedFor) {
  const Scene scene = weak_ropes(2);
  World world(scene, {.threads = 1}), listing(scene, {.events = true, .threads = 1});
  test::expect_refusal("Settings::events", [&] { world.events(); });
  EXPECT_TRUE(listing.events().empty());
  for (int step = 0; step < 100; ++step) {
    world.step(frame);
    listing.step(frame);
  }
  EXPECT_EQ(world.state_hash(), listing.state_hash());
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
