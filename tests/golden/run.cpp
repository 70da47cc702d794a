#include "golden/run.hpp"

#include <algorithm>
#include <bit>
#include <vector>

#include "golden/scenes.hpp"
#include "golden/settings_text.hpp"
#include "plumb/error.hpp"
#include "scenes/basics/numbers.hpp"

namespace plumb::golden {
namespace {

/// FNV-1a over the bytes of all coordinates. It is the test's own, so that a change of state_hash() alone can
/// be told from a change of the motion.
std::uint64_t hash_motion(const World& world) {
  std::uint64_t hash = 0xcbf29ce484222325;
  const auto add = [&](double value) {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    for (int byte = 0; byte < 8; ++byte) hash = (hash ^ ((bits >> (8 * byte)) & 0xff)) * 0x100000001b3;
  };
  for (std::uint32_t i = 0; i < world.particle_count(); ++i)
    for (const Vec3 v : {world.position(i), world.velocity(i)}) {
      add(v.x);
      add(v.y);
      add(v.z);
    }
  return hash;
}

Hashes hashes_of(const World& world) {
  return {world.state_hash(), hash_motion(world)};
}

bool is_finite_world(const World& world) {
  for (std::uint32_t i = 0; i < world.particle_count(); ++i)
    if (!is_finite(world.position(i)) || !is_finite(world.velocity(i))) return false;
  return true;
}

/// What is done to a world between its steps.
class Drive {
 public:
  Drive(const Row& row, const Scene& scene, const Settings& settings)
      : scene_(scene), settings_(settings), steps_(row.steps) {
    for (const std::string& word : split(row.drive, '+')) {
      bool* const flag = word == "anchors"     ? &anchors_
                         : word == "forces"    ? &forces_
                         : word == "uneven"    ? &uneven_
                         : word == "rules"     ? &rules_
                         : word == "platforms" ? &platforms_
                                               : nullptr;
      if (flag != nullptr) {
        *flag = true;
      } else if (word != "still") {
        throw InputError("'" + word + "' drives nothing");
      }
    }
    const auto& particles = scene_.particles;
    while (anchors_ && !particles.at(anchor_).fixed) ++anchor_;
    pushed_ = static_cast<std::uint32_t>(particles.size() - 1);
    while (forces_ && particles.at(pushed_).fixed) --pushed_;
  }

  void before_step(World& world, std::uint32_t step) const {
    if (anchors_ && step % 12 < 8) {
      const double far = 0.002 * (step - step / 12 * 4.0);
      world.move_anchor(anchor_, scene_.particles[anchor_].position + far * Vec3{1, 0.5, -0.75});
    }
    if (platforms_ && step % 16 < 12) {
      const double far = 0.002 * step, half = 0.004 * step, over = 1 / (1 + half * half);
      world.move_platform(0, {.position = scene_.platforms.at(0).position + far * Vec3{-1, 0.5, 0.25},
                              .orientation = {over * (1 - half * half), 0, over * 2 * half, 0}});
    }
    if (forces_ && step == steps_ / 8) world.set_force(pushed_, {0.5, 6, 2});
    if (forces_ && step == steps_ / 2) world.set_force(pushed_, {-1, 0.25, 3});
    if (forces_ && step == steps_ - steps_ / 4) world.set_force(pushed_, {});
    if (rules_ && step == steps_ / 2) {
      StopRule rule = settings_.stop;
      rule.sweeps *= 2;
      world.set_stop_rule(rule);
      world.set_weights(Weights::equal);
    }
  }

  double length(double dt, std::uint32_t step) const {
    constexpr double shares[] = {1, 0.75, 1.25};
    return uneven_ ? dt * shares[step % 3] : dt;
  }

 private:
  const Scene& scene_;
  const Settings& settings_;
  std::uint32_t steps_, anchor_ = 0, pushed_ = 0;
  bool anchors_ = false, forces_ = false, uneven_ = false, rules_ = false, platforms_ = false;
};

}  // namespace

struct RowRun::Parts {
  Parts(const Row& row, const Machine& machine)
      : scene(build_scene(row.scene)),
        settings(parse_settings(row.settings, has_more_than_rods(scene))),
        dt(*scenes::parse_fraction(row.dt)),
        drive(row, scene, settings),
        world(scene, on(settings, machine)) {}

  static Settings on(Settings settings, const Machine& machine) {
    settings.isa = machine.isa;
    settings.threads = machine.threads;
    settings.executor = machine.executor;
    return settings;
  }

  Scene scene;
  Settings settings;
  double dt;
  Drive drive;
  World world;
};

RowRun::RowRun(const Row& row, const Machine& machine) : parts_(std::make_unique<Parts>(row, machine)) {}
RowRun::~RowRun() = default;

StepReport RowRun::step(std::uint32_t number) {
  parts_->drive.before_step(parts_->world, number);
  return parts_->world.step(parts_->drive.length(parts_->dt, number));
}
World& RowRun::world() {
  return parts_->world;
}
const Scene& RowRun::scene() const {
  return parts_->scene;
}

Outcome run_row(const Row& row, const Machine& machine) {
  RowRun run(row, machine);
  Outcome out;
  out.has_shapes = !run.scene().capsules.empty();
  out.before = hashes_of(run.world());
  for (std::uint32_t step = 0; step < row.steps; ++step) out.total += run.step(step);
  out.finite = is_finite_world(run.world());
  out.hashes = hashes_of(run.world());
  return out;
}

}  // namespace plumb::golden
