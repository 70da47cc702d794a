#include "stability/shots/shots.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "plumb/measures.hpp"
#include "plumb/world.hpp"
#include "scenes/basics/lists.hpp"
#include "scenes/humanoid/limbs.hpp"

namespace plumb::scenes {
namespace {

constexpr double most_beyond = 1e-3;   // m
constexpr double edge = 0.8;           // Share of a wall's width that is looked at.
constexpr double least_change = 1e-3;  // Share of the velocity; what changed by less has not been touched.
constexpr double most_inside = 0.5;    // Share of the thinner one's radius.

/// Returns how far ends and corners are beyond the wall's middle, in m: negative where all are on their own
/// side, and infinite if something may be past the wall's edge.
double beyond_wall(const Shot& shot, std::span<const Vec3> positions) {
  double most = -std::numeric_limits<double>::infinity();
  for (const Point& each : shot.outermost) {
    const Vec3 at = place_of(each, positions);
    if (std::max(std::abs(at.x), std::abs(at.z)) >= edge * wall_reach)
      return std::numeric_limits<double>::infinity();
    most = std::max(most, -shot.out.y * at.y);
  }
  return most;
}

/// Returns where an end of a missile's axis is; every core has two.
Vec3 end_of(const Shot& shot, std::size_t i, std::span<const Vec3> positions) {
  const Core& core = shot.missiles[i / 2];
  return place_of(i % 2 == 0 ? core.a : core.b, positions);
}

/// Marks ends that are beside a held net: out of its frame, or in a mesh at its corner. That one is open,
/// since no rods lie along the frame.
void mark_ends_beside_net(const Shot& shot, std::span<const Vec3> positions, std::vector<bool>& beside) {
  const Vec3 corner = positions.front();
  const double mesh = norm(shot.scene.particles[1].position - shot.scene.particles[0].position);
  for (std::size_t i = 0; i < beside.size(); ++i) {
    const Vec3 at = end_of(shot, i, positions);
    const double x = std::abs(at.x) - std::abs(corner.x), z = std::abs(at.z) - std::abs(corner.z);
    if (std::max(x, z) > 0 || std::min(x, z) > -mesh) beside[i] = true;
  }
}

/// Says whether an end is behind a held net. Ends that were beside it may have gone round it.
bool is_through_net(const Shot& shot, std::span<const Vec3> positions, const std::vector<bool>& beside) {
  for (std::size_t i = 0; i < beside.size(); ++i)
    if (!beside[i] && is_behind_net(positions, shot.net, end_of(shot, i, positions), shot.out)) return true;
  return false;
}

/// The state of a flight, and the energy that it started with.
struct Flight {
  const Shot& shot;
  World world;
  MassModel mass;
  std::vector<Vec3> positions, velocities;
  std::vector<bool> beside;  ///< Two for each core of the missile: whether that end was beside a held net.
  double energy_before = 0;

  Flight(const Shot& of, const Settings& settings)
      : shot(of),
        world(of.scene, settings),
        mass(mass_model_of(settings)),
        positions(of.scene.particles.size()),
        velocities(of.scene.particles.size()),
        beside(2 * of.missiles.size(), false) {
    energy_before = energy();
  }
  double energy() {
    world.copy_positions(positions);
    world.copy_velocities(velocities);
    return measure_energy(shot.scene, positions, velocities, mass).total();
  }
  bool is_finite() const {
    const auto fine = [](Vec3 v) { return plumb::is_finite(v); };
    return std::all_of(positions.begin(), positions.end(), fine) &&
           std::all_of(velocities.begin(), velocities.end(), fine);
  }
  /// Whether the missile flies as it did at first.
  bool is_untouched() const {
    const double most = least_change * norm(shot.approach);
    for (std::size_t i = shot.first; i < velocities.size(); ++i)
      if (norm(velocities[i] - shot.scene.particles[i].velocity) > most) return false;
    return true;
  }
};

/// Looks at the target after a step. Returns false once there is nothing more to see.
bool look(const Shot& shot, Flight& flight, ShotResult& result) {
  if (is_wall(shot.target)) {
    const double beyond = beyond_wall(shot, flight.positions);
    if (std::isinf(beyond)) return false;
    result.depth = std::max(result.depth, beyond);
    result.through = result.through || beyond > most_beyond;
    return true;
  }
  result.depth = std::max(result.depth, share_inside(shot.targets, shot.missiles, flight.positions));
  result.deep = result.depth > most_inside;
  if (shot.target == Target::net) {
    mark_ends_beside_net(shot, flight.positions, flight.beside);
    result.through = result.through || is_through_net(shot, flight.positions, flight.beside);
  }
  return true;
}

}  // namespace

const std::vector<ShotWay>& shot_ways() {
  static const std::vector<ShotWay> ways = [] {
    const Settings automatic{.sleep = false, .threads = 1};
    Settings direct = automatic, relaxed = automatic;
    direct.method = Method::direct;
    relaxed.method = Method::relax;
    Settings single = relaxed;
    single.precision = Precision::single;
    return std::vector<ShotWay>{
        {"auto", automatic}, {"direct", direct}, {"relax", relaxed}, {"relax, float", single, 1e-4}};
  }();
  return ways;
}

std::string fault_of(const ShotResult& result) {
  std::string out;
  if (!result.finite) append_item(out, "not finite");
  if (result.through) append_item(out, "through");
  if (result.gained) append_item(out, "gained energy");
  return out;
}

bool is_behind_net(std::span<const Vec3> positions, std::uint32_t side, Vec3 at, Vec3 out) {
  int crossings = 0;
  const auto cross_triangle = [&](Vec3 a, Vec3 b, Vec3 c) {
    // Twice the areas of the triangles that the point makes with the sides, as seen along y.
    const auto area = [&](Vec3 p, Vec3 q) {
      return (p.x - at.x) * (q.z - at.z) - (q.x - at.x) * (p.z - at.z);
    };
    const double wa = area(b, c), wb = area(c, a), wc = area(a, b), sum = wa + wb + wc;
    if (!((wa >= 0 && wb >= 0 && wc >= 0) || (wa < 0 && wb < 0 && wc < 0)) || sum == 0) return;
    crossings += ((wa * a.y + wb * b.y + wc * c.y) / sum - at.y) * out.y > 0;
  };
  for (std::uint32_t row = 0; row + 1 < side; ++row)
    for (std::uint32_t column = 0; column + 1 < side; ++column) {
      const std::uint32_t i = row * side + column;
      cross_triangle(positions[i], positions[i + 1], positions[i + side + 1]);
      cross_triangle(positions[i], positions[i + side + 1], positions[i + side]);
    }
  return crossings % 2 == 1;
}

ShotResult fly(const Shot& shot, const ShotWay& way) {
  Flight flight(shot, way.settings);
  ShotResult result;
  for (std::uint32_t step = 0; step < shot.steps; ++step) {
    const StepReport report = flight.world.step(shot.dt);
    const double share = flight.energy() / flight.energy_before - 1;
    result.finite = report.frozen_islands == 0 && flight.is_finite();
    if (!result.finite) return result;
    result.gain = std::max(result.gain, share);
    if (!look(shot, flight, result)) break;
  }
  result.gained = result.gain > way.most_gain;
  const bool untouched = flight.is_untouched();
  result.hit = !untouched;
  if (untouched && !is_wall(shot.target)) {
    const double time = 0.999 * shot.steps * shot.dt;
    result.through =
        result.through || flies_into(shot.targets, shot.missiles, start_of(shot.scene), time * shot.approach);
  }
  return result;
}

}  // namespace plumb::scenes
