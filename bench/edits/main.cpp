// bench_edits measures what it costs to add a rope to a world of many, to remove one, to cut one or a tenth
// of them at once, and to join two; to add and remove crates and figures; and to pack ropes that came one by
// one. Frames go on between the edits, as they do in a game, and edits without frames show what cold caches
// cost.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include "plumb/joints.hpp"
#include "plumb/world.hpp"

namespace plumb::bench {
namespace {

constexpr double frame = 1.0 / 60;
constexpr std::uint32_t rods = 32;

/// Appends a rope of rods of 0.1 m that hangs aside from an anchor at x (m).
void append_rope(Scene& scene, double x) {
  const auto first = static_cast<std::uint32_t>(scene.particles.size());
  scene.particles.push_back({.position = {x, 0, 0}, .fixed = true});
  for (std::uint32_t i = 1; i <= rods; ++i) {
    scene.particles.push_back({.position = {x + 0.06 * i, -0.08 * i, 0}, .mass = 1});
    scene.rods.push_back({.a = first + i - 1, .b = first + i});
  }
}

using Clock = std::chrono::steady_clock;

/// Returns how long ago that was, in us.
double us_since(Clock::time_point begin) {
  return std::chrono::duration<double, std::micro>(Clock::now() - begin).count();
}

/// Collects times of one kind of edit, in us.
class Times {
 public:
  template <class F>
  void time(F&& f) {
    const auto begin = Clock::now();
    f();
    add(us_since(begin));
  }
  void add(double us) { times_.push_back(us); }
  /// Writes a row: the first time, and the least and the median of the others.
  void say(const std::string& what) {
    std::vector<double> later(times_.begin() + 1, times_.end());
    std::sort(later.begin(), later.end());
    std::printf("| %s | %.0f | %.1f | %.1f |\n", what.c_str(), times_.front(), later.front(),
                later[later.size() / 2]);
  }

 private:
  std::vector<double> times_;
};

/// Appends a box on a hull.
void append_crate(Scene& scene, Vec3 center) {
  MassProperties box = solid_box(1, {0.2, 0.2, 0.2});
  box.center = center;
  const std::uint32_t body = add_body(scene, box);
  scene.hulls.push_back(box_on_body(body, {.center = center, .half_size = {0.1, 0.1, 0.1}}));
}

/// Appends ten limbs on hinges, one below the other, with capsules.
void append_figure(Scene& scene, Vec3 top) {
  for (std::uint32_t i = 0; i < 10; ++i) {
    MassProperties limb = solid_box(1, {0.1, 0.3, 0.1});
    limb.center = top - Vec3{0, 0.4 * i, 0};
    const std::uint32_t body = add_body(scene, limb);
    if (i > 0) add_revolute(scene, body - 1, body, limb.center + Vec3{0, 0.2, 0}, {1, 0, 0});
    scene.capsules.push_back({.a = point_on_body(scene, body, limb.center + Vec3{0, 0.1, 0}),
                              .b = point_on_body(scene, body, limb.center - Vec3{0, 0.1, 0}),
                              .radius = 0.05});
  }
}

/// Adds and removes something again and again, with or without a frame between.
void add_and_remove(World& world, const Scene& what, bool has_frames, const std::string& name) {
  Times adds, removals;
  for (int i = 0; i < 400; ++i) {
    Added first;
    adds.time([&] { first = world.add(what); });
    if (has_frames) world.step(frame);
    removals.time([&] { world.remove(first.particle + 1); });
    if (has_frames) world.step(frame);
  }
  const std::string how = has_frames ? ", frames between" : "";
  adds.say(name + "add" + how);
  removals.say(name + "remove" + how);
}

/// Cuts ropes in their middles, so many before every frame, as often as said. No rope is cut twice.
void cut_ropes(World& world, std::uint32_t ropes, std::uint32_t at_once, std::uint32_t often,
               const std::string& name) {
  Times orders, frames, splits;
  Clock::time_point begin;
  world.set_zones([&](std::string_view stage, bool begins) {
    if (stage != "split") return;
    if (begins)
      begin = Clock::now();
    else
      splits.add(us_since(begin));
  });
  for (std::uint32_t i = 0; i < often; ++i) {
    orders.time([&] {
      for (std::uint32_t k = 0; k < at_once; ++k)
        world.cut(rods * ((k * often + i) * (ropes / (at_once * often))) + rods / 2);
    });
    frames.time([&] { world.step(frame); });
  }
  world.set_zones({});
  const std::string cuts = at_once > 1 ? std::to_string(at_once) + " cuts" : "a cut";
  orders.say(name + "order " + cuts);
  frames.say(name + "frame with " + cuts);
  splits.say(name + "of which " + cuts + " took");
}

void measure(Method method, std::uint32_t ropes) {
  Scene scene;
  for (std::uint32_t i = 0; i < ropes; ++i) append_rope(scene, i);
  const Settings settings{.method = method, .threads = 1};
  const std::string name = std::to_string(ropes) + " ropes, " + std::string(to_string(method)) + ": ";
  World world(scene, settings), other(scene, settings), third(scene, settings);
  Times frames, joins, join_frames;
  for (World* const each : {&world, &other, &third}) each->step(frame);
  for (int i = 0; i < 200; ++i) frames.time([&] { world.step(frame); });
  frames.say(name + "frame");
  Scene rope;
  append_rope(rope, -5);
  add_and_remove(world, rope, true, name);
  add_and_remove(world, rope, false, name);
  World roomy(scene, settings);
  Times reserve;
  for (int i = 0; i < 3; ++i) reserve.time([&] { roomy.reserve(rope, 8); });
  reserve.say(name + "reserve");
  add_and_remove(roomy, rope, true, name + "after that, ");
  cut_ropes(other, ropes, 1, 20, name);
  cut_ropes(third, ropes, ropes / 10, 5, name);
  for (std::uint32_t i = 0; i < 20; ++i) {
    const std::uint32_t tip = (rods + 1) * (i * ropes / 20 + 1) - 1;
    joins.time([&] { world.join({.a = tip, .b = tip + rods + 1}); });
    join_frames.time([&] { world.step(frame); });
  }
  joins.say(name + "order a join");
  join_frames.say(name + "frame with a join");
}

/// Adds and removes one more crate or figure over a floor.
template <class Append>
void measure_bodies(Method method, const std::string& kind, Append&& append) {
  constexpr std::uint32_t count = 1000;
  Scene scene, one;
  scene.planes.push_back({});
  for (std::uint32_t i = 0; i < count; ++i) append(scene, {2.0 * (i % 32), 10, 2.0 * (i / 32)});
  append(one, {-3, 10, 0});
  World world(scene, {.method = method, .threads = 1});
  const std::string name = std::to_string(count) + " " + kind + ", " + std::string(to_string(method)) + ": ";
  add_and_remove(world, one, false, name);
}

/// Packs ropes that came one by one, with a frame after each, or all before the first frame.
void measure_pack(Method method, std::uint32_t ropes, bool frames_between) {
  Scene scene;
  append_rope(scene, 0);
  World world(scene, {.method = method, .threads = 1});
  for (std::uint32_t i = 1; i < ropes; ++i) {
    Scene rope;
    append_rope(rope, i);
    world.add(rope);
    if (frames_between) world.step(frame);
  }
  Times before, pack, after;
  for (int i = 0; i < 100; ++i) before.time([&] { world.step(frame); });
  for (int i = 0; i < 3; ++i)
    pack.time([&] {
      world.pack();
      world.step(frame);
    });
  for (int i = 0; i < 100; ++i) after.time([&] { world.step(frame); });
  const std::string name = std::to_string(ropes) + " ropes " +
                           (frames_between ? "one a frame" : "one by one") + ", " +
                           std::string(to_string(method)) + ": ";
  before.say(name + "frame");
  pack.say(name + "frame with a pack");
  after.say(name + "frame after it");
}

}  // namespace
}  // namespace plumb::bench

int main() {
  std::puts("| edit | first, us | least of later ones, us | median, us |\n|---|---|---|---|");
  for (const std::uint32_t ropes : {100u, 1000u})
    for (const plumb::Method method : {plumb::Method::direct, plumb::Method::relax})
      plumb::bench::measure(method, ropes);
  for (const plumb::Method method : {plumb::Method::direct, plumb::Method::relax}) {
    plumb::bench::measure_bodies(method, "crates", plumb::bench::append_crate);
    plumb::bench::measure_bodies(method, "figures", plumb::bench::append_figure);
    for (const bool frames_between : {false, true}) plumb::bench::measure_pack(method, 1000, frames_between);
  }
}
