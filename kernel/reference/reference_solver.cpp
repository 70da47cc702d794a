#include "reference/reference_solver.hpp"

#include <algorithm>
#include <numbers>
#include <utility>

#include "reference/featherstone/featherstone.hpp"
#include "reference/multipliers/multipliers.hpp"
#include "reference/springs/springs.hpp"
#include "scene/refuse.hpp"
#include "threads/flush_denormals.hpp"

namespace plumb::detail {

ReferenceSolver::ReferenceSolver(const Scene& island, std::unique_ptr<MechanicalSystem> system,
                                 double diagonal)
    : system_(std::move(system)) {
  drive_.forces.resize(island.particles.size());
  drive_.anchor_velocities.resize(island.particles.size());
  drive_.scene_diagonal = diagonal;
  for (const Particle& particle : island.particles) {
    drive_.anchors.push_back(particle.position);
    fixed_.push_back(particle.fixed);
  }
  state_ = system_->initial_state(drive_);
  system_->place(state_, drive_);
}

double ReferenceSolver::advance(std::uint32_t, double h, std::uint32_t count, unsigned, Tally& report) {
  const FlushDenormals flush;
  last_ = state_;
  for (std::uint32_t i = 0; i < count; ++i) {
    system_->advance(state_, drive_, h);
    for (std::uint32_t p = 0; p < fixed_.size(); ++p) drive_.anchors[p] = drive_.anchor(p, h);
  }
  if (state_.finite()) {
    system_->report(state_, drive_, report);
    system_->place(state_, drive_);
    return 0;
  }
  std::swap(state_, last_);
  frozen_ = true;
  ++report.frozen_islands;
  return 0;
}

Vec3 ReferenceSolver::position(Slot slot) const {
  return fixed_[slot] ? drive_.anchors[slot] : system_->position(state_, slot);
}

Vec3 ReferenceSolver::velocity(Slot slot) const {
  return fixed_[slot] || frozen_ ? Vec3{} : system_->velocity(state_, slot);
}

void ReferenceSolver::add_to_hash(Slot slot, StateHash& hash) const {
  hash.add<double>(position(slot));
  hash.add<double>(velocity(slot));
}

void ReferenceSolver::move_anchor(Slot slot, const AnchorMove& move) {
  drive_.anchor_velocities[slot] = move.velocity();
}

void ReferenceSolver::end_anchors() {
  std::fill(drive_.anchor_velocities.begin(), drive_.anchor_velocities.end(), Vec3{});
}

namespace {

/// Returns one island as a scene of its own.
Scene island_scene(const Scene& scene, const IslandSets& sets, std::uint32_t island) {
  const layouts::LocalGraph local = layouts::local_graph(sets.graph, sets.islands, island);
  Scene out;
  out.gravity = scene.gravity;
  out.drag = scene.drag;
  for (const std::uint32_t particle : sets.islands.vertices(island))
    out.particles.push_back(scene.particles[particle]);
  const auto rods = sets.islands.edges(island);
  for (std::size_t r = 0; r < rods.size(); ++r) {
    Rod rod = scene.rods[rods[r]];
    rod.length = rod_length(scene, rods[r]);
    rod.a = local.edges[r].a;
    rod.b = local.edges[r].b;
    out.rods.push_back(rod);
  }
  return out;
}

MadeSolver made_of(const Scene& island, std::span<const std::uint32_t> particles,
                   std::unique_ptr<MechanicalSystem> system, double diagonal, StartReport& report) {
  auto solver = std::make_unique<ReferenceSolver>(island, std::move(system), diagonal);
  MadeSolver made;
  for (Slot slot = 0; slot < particles.size(); ++slot) {
    made.places.push_back({particles[slot], slot});
    if (island.particles[slot].fixed) continue;
    report.projected_velocity =
        std::max(report.projected_velocity, norm(solver->velocity(slot) - island.particles[slot].velocity));
  }
  made.solver = std::move(solver);
  return made;
}

/// Refuses what makes forces that are not smooth, and air, which both methods do not know.
void require_known_joints(const Scene& island, std::uint32_t particle, Method method) {
  const auto require = [&](bool has, const char* what, const char* others = "relax, direct and auto") {
    if (has)
      refuse("particle ", particle, ": its island has ", what, ", which method ", to_string(method),
             " does not know; ", others, " do");
  };
  require(island.joint_drag != 0, "drag of joints");
  for (const Rod& rod : island.rods)
    require(rod.linear_drag != 0 || rod.orthogonal_drag != 0, "air on rods", "direct and auto");
  for (const AngleControl& angle : island.angles) {
    require(angle.lower > 0 || angle.upper < std::numbers::pi, "limits of angles");
    require(angle.friction > 0, "dry friction");
  }
  for (const Particle& each : island.particles) require(each.asleep && !each.fixed, "sleepers");
}

}  // namespace

Array<MadeSolver> make_reference_solvers(const Scene& scene, const IslandSets& sets, const Settings& settings,
                                         StartReport& report) {
  if (settings.method == Method::springs) {
    if (!scene.hulls.empty()) refuse("hull 0: method springs lets nothing touch; relax, direct and auto do");
    if (!scene.capsules.empty())
      refuse("capsule 0: method springs lets nothing touch; relax, direct and auto do");
    require_spring_bodies(scene, settings);
  }
  const double diagonal = bounding_diagonal(scene);
  Array<MadeSolver> out;
  for (std::uint32_t island = 0; island < sets.islands.count(); ++island) {
    const auto particles = sets.islands.vertices(island);
    const Scene alone = island_scene(scene, sets, island);
    auto system = make_system(alone, settings, IslandNames{particles, sets.islands.edges(island)});
    out.push_back(made_of(alone, particles, std::move(system), diagonal, report));
  }
  return out;
}

MadeSolver make_jointed_solver(const Scene& island, std::span<const std::uint32_t> particles,
                               const Settings& settings, StartReport& report) {
  require_known_joints(island, particles.front(), settings.method);
  auto system = settings.method == Method::multipliers
                    ? make_jointed_multipliers(island, settings)
                    : make_jointed_featherstone(island, settings, particles.front());
  // No method that gets here reads an accuracy, which is what the diagonal is for.
  return made_of(island, particles, std::move(system), bounding_diagonal(island), report);
}

}  // namespace plumb::detail
