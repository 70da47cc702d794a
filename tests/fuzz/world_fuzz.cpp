// Small worlds: an InputError, or a state that stays finite within bounded work, the same with every
// instruction set. With
// PLUMB_FUZZ_PRINT in the environment, each world is printed before it is made.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>

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

/// Steps a world to its end; returns its hash.
std::uint64_t run(const fuzz::RandomWorld& random, Isa isa) {
  Settings settings = random.settings;
  settings.isa = isa;
  World world(random.scene, settings);
  const Particle& pushed = random.scene.particles.at(random.pushed);
  for (int step = 0; step < random.steps; ++step) {
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
  return world.state_hash();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const fuzz::RandomWorld random = fuzz::make_random_world(data, size);
    if (random.pushed >= random.scene.particles.size()) return 0;
    if (std::getenv("PLUMB_FUZZ_PRINT") != nullptr) print(random);
    if (run(random, Isa::scalar) != run(random, best_isa())) fail(random, "instruction sets do not agree");
  } catch (const InputError&) {
  }
  return 0;
}
