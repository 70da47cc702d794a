// Small worlds: an InputError, or a state that stays finite, the same with every instruction set.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "fuzz/random_world.hpp"
#include "plumb/plumb.hpp"
#include "scenes/files/scene_file.hpp"

namespace {

using namespace plumb;

[[noreturn]] void fail(const fuzz::RandomWorld& random, const char* what) {
  std::fprintf(stderr, "%s\nmethod %s, precision %s, dt %.17g, %d steps\n%s\n", what,
               std::string(to_string(random.settings.method)).c_str(),
               std::string(to_string(random.settings.precision)).c_str(), random.dt, random.steps,
               scenes::format_scene(random.scene).c_str());
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
    world.step(random.dt);
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
    if (run(random, Isa::scalar) != run(random, best_isa())) fail(random, "instruction sets do not agree");
  } catch (const InputError&) {
  }
  return 0;
}
