#include "stability/hangings/hangings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "plumb/measures.hpp"

namespace plumb::scenes {
namespace {

/// A rod off its length by more is a problem that a frame must name.
constexpr double most_strain = 0.01;
/// What must move comes at least so far, relative to the scene's diagonal.
constexpr double least_way = 1e-3;

double median_of(std::vector<double> values) {
  if (values.empty()) return 0;
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

/// Says whether a rod that is rigid, or a rigid cable, is off its length.
bool is_stretched(const Scene& scene, const World& world) {
  for (std::uint32_t i = 0; i < scene.rods.size(); ++i) {
    const Rod& rod = scene.rods[i];
    if (rod.law.is_elastic()) continue;
    const double strain =
        norm(world.position(rod.b) - world.position(rod.a)) / plumb::rod_length(scene, i) - 1;
    if ((rod.law.one_sided ? strain : std::abs(strain)) > most_strain) return true;
  }
  return false;
}

/// Returns how far the farthest particle is from where it was, and infinity if one is not finite.
double way_from(const std::vector<Vec3>& places, const World& world) {
  double most = 0;
  for (std::uint32_t i = 0; i < places.size(); ++i) {
    if (!is_finite(world.position(i))) return std::numeric_limits<double>::infinity();
    most = std::max(most, norm(world.position(i) - places[i]));
  }
  return most;
}
std::vector<Vec3> places_of(const World& world) {
  std::vector<Vec3> out(world.particle_count());
  world.copy_positions(out);
  return out;
}

}  // namespace

std::string HangingResult::fault() const {
  if (!finite) return "not finite";
  if (silent > 0) return "not solved and not named";
  if (stands_still) return "stands still";
  return {};
}

HangingResult hang(std::uint64_t seed, double duration) {
  const Hanging hanging = random_hanging(seed);
  const Scene& scene = hanging.scene;
  World world(scene, {.threads = 1});
  HangingResult out{
      .seed = seed, .kind = hanging.kind, .rods = static_cast<std::uint32_t>(scene.rods.size())};
  std::vector<double> work, moving;
  double way = 0;
  std::vector<Vec3> start, before;
  for (const Particle& particle : scene.particles) start.push_back(particle.position);
  const auto frames = static_cast<std::uint32_t>(std::lround(60 * duration));
  for (; out.frames < frames && out.finite; ++out.frames) {
    before = places_of(world);
    const StepReport report = world.step(1.0 / 60);
    out.total += report;
    const auto done = static_cast<double>(report.newton + report.halvings + report.block_sweeps);
    if (done > 0) work.push_back(done);
    if (done > 0 && 60 * way_from(before, world) > HangingResult::rest) moving.push_back(done);
    const bool is_named = !world.problems(most_strain).empty();
    const bool is_bad = report.unsolved + report.capped_steps + report.frozen_islands > 0;
    out.named += is_named;
    out.silent += !is_named && (is_bad || is_stretched(scene, world));
    way = std::max(way, way_from(start, world));
    out.finite = std::isfinite(way);
  }
  out.stands_still = hanging.must_move && way < least_way * bounding_diagonal(scene);
  out.median_work = median_of(moving.size() < HangingResult::least_moving ? work : moving);
  for (const double each : work) out.worst_work = std::max(out.worst_work, each);
  return out;
}

}  // namespace plumb::scenes
