// This file puts particles elsewhere between two steps.

#include <algorithm>
#include <cmath>
#include <tuple>
#include <unordered_map>

#include "plumb/layouts/memory.hpp"
#include "scene/project_velocities.hpp"
#include "scene/refuse.hpp"
#include "step/step.hpp"

namespace plumb::detail {
namespace {

/// Knows rods between particles that move, to tell how fast they stretch.
class Stretching {
 public:
  std::uint32_t add(Vec3 position, Vec3 velocity, double mass) {
    scene_.particles.push_back({.position = position, .velocity = velocity, .mass = mass});
    return static_cast<std::uint32_t>(scene_.particles.size() - 1);
  }
  /// Adds a rod, which has been stretched at `rate` (m/s) so far, and whose length changes at `wanted`.
  void add_rod(std::uint32_t a, std::uint32_t b, double rate, double wanted) {
    const Particle &from = scene_.particles[a], &to = scene_.particles[b];
    const double now = stretching_rate(to.position - from.position, to.velocity - from.velocity);
    const double speed = std::max({norm(from.velocity), norm(to.velocity), std::abs(wanted)});
    is_worse_ = is_worse_ || std::abs(now - wanted) > fits * speed + std::abs(rate - wanted);
    scene_.rods.push_back({.a = a, .b = b});
    wanted_.push_back(wanted);
  }
  static double stretching_rate(Vec3 way, Vec3 velocity) {
    const double length = norm(way);
    return length > 0 ? dot(way, velocity) / length : 0;
  }
  /// Returns velocities (m/s) that stretch nothing but what is wound, or none if rods are stretched no
  /// faster than before.
  Array<Vec3> projected() const {
    Array<Vec3> out;
    if (!is_worse_) return out;
    Array<double> inverse_masses;
    for (const Particle& particle : scene_.particles) {
      out.push_back(particle.velocity);
      inverse_masses.push_back(1 / particle.mass);
    }
    project_velocities(scene_, inverse_masses, out, wanted_);
    return out;
  }

 private:
  Scene scene_;
  Array<double> wanted_;  ///< m/s, by rod
  bool is_worse_ = false;
};

}  // namespace

/// Says where a movable particle goes (m), and how fast (m/s).
struct Step::Motion {
  std::uint32_t particle;
  Vec3 position, velocity;
};

/// Returns the misfit (m) of a rod as it is now, with ends so far apart.
double Step::misfit_now(std::uint32_t rod, double distance) const {
  return is_broken(rod) ? 0 : misfit(distance, lengths_.length(rod), breaks_.scene_now().rods[rod].law);
}

/// Refuses to free a fixed particle whose rods to others were pulled off their lengths while nobody kept
/// them: a solver would take the misfit for speed. Relaxation may have left them off, and sweeps it away.
void Step::require_fit_of_fixed(std::uint32_t particle) const {
  if (settings_.method == Method::relax) return;
  for (const std::uint32_t rod : breaks_.rods_at(particle)) {
    const auto& [a, b] = std::tie(breaks_.scene_now().rods[rod].a, breaks_.scene_now().rods[rod].b);
    if (!anchors_.is_fixed(a) || !anchors_.is_fixed(b)) continue;
    const double distance = norm(position(b) - position(a));
    if (!(misfit_now(rod, distance) <= fits * lengths_.length(rod)))
      refuse("particle ", particle, ": cannot be free, since rod ", rod, " is ", lengths_.length(rod),
             " m long, and its ends are ", distance, " m apart");
  }
}

/// Refuses a move after which something rigid fits worse than before. at(particle) says where one will be.
template <class At>
void Step::require_fit(std::span<const std::uint32_t> particles, At&& at) const {
  const Scene& scene = breaks_.scene_now();
  for (const std::uint32_t particle : particles) {
    if (const auto reel = breaks_.reel_at(particle))
      refuse("particle ", particle, ": reel ", *reel, " is of its island, which keeps its place");
    for (std::size_t k = 0; k < edits_.joined.names.rods.size(); ++k) {
      const Rod& rod = edits_.joined.scene.rods[k];
      if ((rod.a == particle || rod.b == particle) &&
          !(misfit(norm(at(rod.b) - at(rod.a)), rod.length, rod.law) <= fits * rod.length))
        refuse("rod ", edits_.joined.names.rods[k], ": is joined in the next step, ", rod.length,
               " m long, and its ends would be ", norm(at(rod.b) - at(rod.a)), " m apart");
    }
    for (const std::uint32_t rod : breaks_.rods_at(particle)) {
      const auto& [a, b] = std::tie(scene.rods[rod].a, scene.rods[rod].b);
      if (anchors_.is_fixed(a) && anchors_.is_fixed(b)) continue;
      const double length = lengths_.length(rod), distance = norm(at(b) - at(a));
      const double before = misfit_now(rod, norm(position(b) - position(a)));
      if (!(misfit_now(rod, distance) <= fits * length + before))
        refuse("rod ", rod, ": is ", length, " m long, and its ends would be ", distance, " m apart");
    }
  }
}

/// Takes out of velocities what stretches rigid rods faster than before, as a start does. Rods that are wound
/// go on at the rate of the last step, which solvers go by. at(anchor) says where a fixed particle will be.
/// Sweeps do that by themselves where they move an island.
template <class At>
void Step::keep_lengths(Array<Motion>& motions, At&& at) const {
  constexpr double immovable = 1e12;  // times the mass of what hangs from it: an anchor may move
  Stretching stretching;
  std::unordered_map<std::uint32_t, std::uint32_t> number;
  std::unordered_map<std::uint32_t, bool> seen;
  double heaviest = 0;
  for (const auto& [particle, position, velocity] : motions) {
    double mass = breaks_.own_mass(particle);
    for (const std::uint32_t rod : breaks_.rods_at(particle)) mass += breaks_.scene_now().rods[rod].mass / 2;
    heaviest = std::max(heaviest, mass);
    number[particle] = stretching.add(position, velocity, mass);
  }
  const auto number_of = [&](std::uint32_t particle) {
    const auto found = number.find(particle);
    if (found != number.end()) return found->second;
    return number[particle] =
               stretching.add(at(particle), anchors_.last_velocity(particle), immovable * heaviest);
  };
  const auto speed = [&](std::uint32_t particle) {
    return anchors_.is_fixed(particle) ? anchors_.last_velocity(particle) : velocity(particle);
  };
  for (const Motion& motion : motions) {
    const Place& place = compiled_.places.of(motion.particle).front();
    if (solver(place).sweeps()) continue;
    for (const std::uint32_t rod : breaks_.rods_at(motion.particle)) {
      const Rod& of = breaks_.scene_now().rods[rod];
      if (of.law.is_elastic() || of.law.one_sided || is_broken(rod)) continue;
      if (!seen.emplace(rod, true).second) continue;
      const Vec3 way = position(of.b) - position(of.a);
      stretching.add_rod(number_of(of.a), number_of(of.b),
                         Stretching::stretching_rate(way, speed(of.b) - speed(of.a)), lengths_.rate(rod));
    }
  }
  const Array<Vec3> velocities = stretching.projected();
  for (std::size_t k = 0; k < motions.size() && !velocities.empty(); ++k) motions[k].velocity = velocities[k];
}

/// Puts those of some particles that are fixed to at(particle), and wakes what hangs from them or lies on
/// them.
template <class At>
void Step::put_anchors(std::span<const std::uint32_t> particles, At&& at) {
  Array<std::uint32_t> anchors;
  Array<Vec3> positions;
  for (const std::uint32_t particle : particles) {
    if (!anchors_.is_fixed(particle)) continue;
    anchors.push_back(particle);
    positions.push_back(at(particle));
    anchors_.put(particle, positions.back());
    for (const Place& place : compiled_.places.of(particle)) {
      solver(place).place_anchor(place.slot, positions.back());
      sleep_.wake(compiled_.solvers, place);
    }
  }
  if (!compiled_.contact) return;
  compiled_.contact->put_anchors(anchors, positions);
  for (const auto& [home, slot] : compiled_.contact->woken()) sleep_.wake(compiled_.solvers, {home, slot});
}

void Step::teleport(std::span<const std::uint32_t> particles, std::span<const Vec3> positions,
                    std::span<const Vec3> velocities) {
  breaks_.begin();
  std::unordered_map<std::uint32_t, std::size_t> number;
  for (std::size_t k = 0; k < particles.size(); ++k)
    if (!number.emplace(particles[k], k).second) refuse("particle ", particles[k], ": is listed twice");
  const auto at = [&](std::uint32_t particle) {
    const auto found = number.find(particle);
    return found == number.end() ? position(particle) : positions[found->second];
  };
  require_fit(particles, at);
  // All particles of an island get their motion at once, so that those that stay are read before.
  Array<Motion> motions;
  const auto add = [&](std::uint32_t particle) {
    const auto found = number.find(particle);
    if (found == number.end())
      motions.push_back({particle, position(particle), velocity(particle)});
    else
      motions.push_back({particle, positions[found->second], velocities[found->second]});
  };
  std::unordered_map<std::uint32_t, bool> seen;
  for (const std::uint32_t particle : particles)
    for (const std::uint32_t each : breaks_.island_at(particle))
      if (!anchors_.is_fixed(each) && seen.emplace(each, true).second) add(each);
  keep_lengths(motions, at);
  put_anchors(particles, at);
  Array<Solver::Past> pasts;
  for (const Motion& motion : motions) {
    put_force(motion.particle, loads_.force(motion.particle));  // which wakes it
    const Place& home = compiled_.places.of(motion.particle).front();
    pasts.push_back(solver(home).past(home.slot));
  }
  for (const auto& [particle, position, velocity] : motions)
    for (const Place& place : compiled_.places.of(particle))
      solver(place).set_motion(place.slot, position, velocity);
  for (std::size_t k = 0; k < motions.size(); ++k)
    if (pasts[k].substep > 0)
      for (const Place& place : compiled_.places.of(motions[k].particle))
        solver(place).go_on(place.slot, pasts[k]);
}

}  // namespace plumb::detail
