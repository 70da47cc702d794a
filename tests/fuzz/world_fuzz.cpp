// Small worlds: an InputError, or a state that stays finite within bounded work, the same with every
// instruction set and from a snapshot. With
// PLUMB_FUZZ_PRINT in the environment, each world is printed before it is made.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <vector>

#include "fuzz/random_world.hpp"
#include "plumb/plumb.hpp"
#include "scenes/files/scene_file.hpp"

namespace {

using namespace plumb;

void print(const fuzz::RandomWorld& random) {
  const Settings& s = random.settings;
  const auto text = [](auto value) { return std::string(to_string(value)); };
  const auto or_none = [](const std::optional<double>& value) {
    return value ? std::to_string(*value) : "none";
  };
  std::fprintf(stderr,
               "method=%s precision=%s gradient=%s mass=%s weights=%s order=%s omega=%.17g substeps=%u\n",
               text(s.method).c_str(), text(s.precision).c_str(),
               s.gradient ? text(*s.gradient).c_str() : "none", s.mass ? text(*s.mass).c_str() : "none",
               text(s.weights).c_str(), text(s.order).c_str(), s.omega, s.substeps);
  std::fprintf(
      stderr,
      "time_order=%u accuracy=%s sweeps=%u tolerance=%s springs=%s integrator=%s layout=%s sleep=%d\n",
      s.time_order, or_none(s.accuracy).c_str(), s.stop.sweeps, or_none(s.stop.tolerance).c_str(),
      text(s.springs.model).c_str(), s.integrator ? text(*s.integrator).c_str() : "none",
      text(s.layout).c_str(), s.sleep);
  std::fprintf(stderr, "%d steps of %.17g s; before the second, particle %u is pushed by (%g, %g, %g)\n%s\n",
               random.steps, random.dt, random.pushed, random.push.x, random.push.y, random.push.z,
               scenes::format_scene(random.scene).c_str());
}

[[noreturn]] void fail(const fuzz::RandomWorld& random, const char* what) {
  std::fprintf(stderr, "%s\n", what);
  print(random);
  std::abort();
}

bool keeps_snapshots(Method method) {
  return method == Method::automatic || method == Method::direct || method == Method::relax;
}

/// Steps a world from a step to its end. Returns a snapshot from before its last step.
std::vector<std::byte> run(World& world, const fuzz::RandomWorld& random, int from = 0) {
  const Settings& settings = random.settings;
  const Particle& pushed = random.scene.particles.at(random.pushed);
  std::vector<std::byte> snapshot;
  for (int step = from; step < random.steps; ++step) {
    if (step == random.steps - 1 && keeps_snapshots(settings.method)) {
      snapshot.resize(world.snapshot_size());
      world.save(snapshot);
    }
    if (step == 1) {
      if (pushed.fixed)
        world.move_anchor(random.pushed, pushed.position + 0.1 * random.push);
      else
        world.set_force(random.pushed, random.push);
    }
    const StepReport report = world.step(random.dt);
    // A last attempt of every substep comes after the bound.
    if (report.newton + report.halvings > 2 * settings.most_work * world.info().islands)
      fail(random, "a step worked more than its settings allow");
    for (std::uint32_t i = 0; i < world.particle_count(); ++i)
      if (!is_finite(world.position(i)) || !is_finite(world.velocity(i)))
        fail(random, "a position or velocity is not finite");
  }
  return snapshot;
}

World make_world(const fuzz::RandomWorld& random, Isa isa) {
  Settings settings = random.settings;
  settings.isa = isa;
  return World(random.scene, settings);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const fuzz::RandomWorld random = fuzz::make_random_world(data, size);
    if (random.pushed >= random.scene.particles.size()) return 0;
    if (std::getenv("PLUMB_FUZZ_PRINT") != nullptr) print(random);
    World one = make_world(random, Isa::scalar), other = make_world(random, best_isa());
    const std::vector<std::byte> snapshot = run(one, random);
    run(other, random);
    if (one.state_hash() != other.state_hash()) fail(random, "instruction sets do not agree");
    if (snapshot.empty()) return 0;
    World restored = make_world(random, best_isa());
    restored.restore(snapshot);
    run(restored, random, random.steps - 1);
    if (restored.state_hash() != one.state_hash()) fail(random, "a restored world goes otherwise");
  } catch (const InputError&) {
  }
  return 0;
}
