#include "plumb/world.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "relax/plan.hpp"
#include "scene/reels/reels.hpp"
#include "scene/refuse.hpp"
#include "scene/springs/springs.hpp"
#include "scene/validate_bodies.hpp"
#include "step/snapshot/fingerprint.hpp"
#include "step/world_impl.hpp"

namespace plumb {

using detail::refuse;

namespace {

/// Longest step (s), four months. In that time gravity throws things half as far as coordinates in float go.
constexpr double longest_step = 1e7;

/// Returns the shortest substep (s). Its square still fits the precision, with room for masses and forces.
double shortest_substep(Precision precision) {
  return precision == Precision::single ? 1e-15 : 1e-100;
}

void require_length(const char* what, std::uint32_t number, double target) {
  if (!(target > 0 && std::isfinite(target)))
    refuse(what, number, ": a length must be positive and finite, got ", target, " m");
}

}  // namespace

World::World(const Scene& scene, const Settings& settings)
    : World(std::make_shared<const Scene>(scene), settings) {}

World::World(std::shared_ptr<const Scene> shared, const Settings& settings)
    : impl_(std::make_unique<Impl>(settings.memory)) {
  if (!shared) refuse("a world needs a scene, and there is none");
  const Scene& scene = *shared;
  validate(scene);
  Impl::require_sound(settings);
  detail::require_addressable(scene.particles.size(), scene.rods.size());
  impl_->step = detail::make_step(impl_->memory, std::move(shared), settings);
  impl_->fingerprint = detail::fingerprint_of(scene, settings);
  for (const Particle& particle : scene.particles) impl_->fixed.push_back(particle.fixed);
  impl_->take(settings);
  impl_->twists = static_cast<std::uint32_t>(scene.twists.size());
  for (const std::size_t count : {scene.capsules.size(), scene.hulls.size(), scene.planes.size(),
                                  scene.boxes.size(), scene.ground_capsules.size(), scene.ground_hulls.size(),
                                  scene.meshes.size(), scene.height_fields.size()})
    impl_->of_kind.push_back(static_cast<std::uint32_t>(count));
  impl_->platforms.assign(scene.platforms.begin(), scene.platforms.end());
  impl_->targets = impl_->platforms;
  impl_->bodies = detail::BodyPoses(scene);
  if (!scene.bodies.empty()) {
    impl_->positions.resize(scene.particles.size());
    impl_->velocities.resize(scene.particles.size());
  }
  if (!scene.reels.empty()) {
    const detail::RodTable rods(scene);
    for (const Reel& reel : scene.reels) impl_->chains.push_back(detail::chain_length(scene, rods, reel));
  }
}
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

StepReport World::step(double dt) {
  if (!(dt > 0) || !std::isfinite(dt)) refuse("dt must be positive and finite, got ", dt);
  if (dt > longest_step) refuse("dt ", dt, " s is too long: a step takes at most ", longest_step, " s");
  const std::uint32_t substeps = impl_->step->substeps();
  if (dt / substeps < shortest_substep(impl_->precision))
    refuse("dt ", dt, " s in ", substeps, " substeps is too short for ", to_string(impl_->precision),
           ": a substep takes at least ", shortest_substep(impl_->precision), " s");
  impl_->step->ask_load(impl_->time, dt);
  const StepReport report = impl_->step->run(dt);
  impl_->time += dt;
  impl_->platforms = impl_->targets;
  if (impl_->log.hears()) impl_->log.tell(report, *this);
  impl_->step->rethrow_executor_failure();
  return report;
}

void World::set_stop_rule(const StopRule& rule) {
  validate(rule);
  impl_->step->set_stop_rule(rule);
}

void World::set_weights(Weights weights) {
  impl_->step->set_weights(weights);
}

void World::set_substeps(std::uint32_t substeps) {
  validate(Settings{.substeps = substeps});
  impl_->step->set_substeps(substeps);
}

void World::set_accuracy(double accuracy) {
  validate(Settings{.accuracy = accuracy});
  if (!impl_->step->accuracy())
    refuse("this world began without an accuracy, and what it has cannot keep one");
  impl_->step->set_accuracy(accuracy);
}

void World::set_budget(std::optional<double> microseconds) {
  if (microseconds && !(*microseconds > 0 && std::isfinite(*microseconds)))
    refuse("a step's budget must be positive and finite, got ", *microseconds, " us");
  impl_->step->set_budget(microseconds);
}

void World::set_zones(Zones zones) {
  impl_->step->set_zones(std::move(zones));
}

void World::set_log(Log log) {
  impl_->log = detail::StepLog(std::move(log));
  if (impl_->log.hears()) impl_->log.begin(info());
}

void World::set_force(std::uint32_t particle, Vec3 force) {
  impl_->require(particle, false, "a force cannot move it");
  if (!is_finite(force)) refuse("particle ", particle, ": force is not finite");
  impl_->step->set_force(particle, force);
}

void World::set_load(Load load) {
  impl_->step->set_load(std::move(load));
}

void World::move_anchor(std::uint32_t particle, Vec3 target) {
  impl_->require(particle, true, "only fixed particles are moved as anchors");
  if (!is_finite(target)) refuse("particle ", particle, ": target is not finite");
  const double most = farthest_coordinate(impl_->precision);
  if (std::max({std::abs(target.x), std::abs(target.y), std::abs(target.z)}) > most)
    refuse("particle ", particle, ": target is too far for ", to_string(impl_->precision), ", at most ", most,
           " m from the origin");
  impl_->step->move_anchor(particle, target);
}

void World::move_platform(std::uint32_t platform, const Pose& target) {
  Impl::require_one_of(static_cast<std::uint32_t>(impl_->platforms.size()), "platform", platform);
  detail::validate_pose(target, platform);
  impl_->targets[platform] = target;
  impl_->step->move_platform(platform, target);
}

Pose World::platform(std::uint32_t number) const {
  Impl::require_one_of(static_cast<std::uint32_t>(impl_->platforms.size()), "platform", number);
  return impl_->platforms[number];
}

void World::set_length(std::uint32_t rod, double target) {
  impl_->require_rod(rod);
  require_length("rod ", rod, target);
  impl_->step->set_length(rod, target);
}
void World::set_tackle_length(std::uint32_t tackle, double target) {
  impl_->require_tackle(tackle);
  require_length("tackle ", tackle, target);
  impl_->step->set_length(impl_->step->tackle_cord(tackle), target);
}

void World::set_reel(std::uint32_t reel, double out) {
  impl_->require_reel(reel);
  require_length("reel ", reel, out);
  const double whole = impl_->chains[reel];
  if (detail::exceeds_chain(out, whole))
    refuse("reel ", reel, ": ", out, " m cannot be out of a chain of ", whole, " m");
  impl_->step->set_length(impl_->step->reel_cord(reel), std::min(out, whole));
}
double World::reel_out(std::uint32_t reel) const {
  impl_->require_reel(reel);
  return impl_->step->length(impl_->step->reel_cord(reel));
}

void World::set_twist(std::uint32_t twist, double angle) {
  impl_->require_twist(twist);
  if (!std::isfinite(angle)) refuse("twist ", twist, ": angle is not finite");
  impl_->step->set_twist(twist, angle);
}
double World::twist(std::uint32_t twist) const {
  impl_->require_twist(twist);
  return impl_->step->twist(twist);
}
void World::set_spring(std::uint32_t number, const Spring& spring) {
  detail::require_sound(spring, number);
  impl_->require_law<Spring>(number);
  impl_->step->set_law(number, spring);
}
void World::set_torsion(std::uint32_t number, const Torsion& torsion) {
  detail::require_sound(torsion, number);
  impl_->require_law<Torsion>(number);
  impl_->step->set_law(number, torsion);
}
void World::set_angle(std::uint32_t number, const AngleControl& angle) {
  detail::require_sound(angle, number);
  impl_->require_law<AngleControl>(number);
  impl_->step->set_law(number, angle);
}
double World::torsion_angle(std::uint32_t number) const {
  impl_->require_law<Torsion>(number);
  return impl_->step->torsion_angle(number);
}

double World::tension(std::uint32_t rod) const {
  impl_->require_rod(rod);
  impl_->require_tensions();
  return impl_->step->pull(rod);
}
void World::copy_tensions(std::span<double> out) const {
  impl_->require_tensions();
  if (out.size() != rod_count())
    refuse("tensions of ", rod_count(), " rods cannot be copied into ", out.size(), " elements");
  impl_->step->copy_pulls(out);
}
double World::power(std::uint32_t rod) const {
  impl_->require_rod(rod);
  impl_->require_tensions();
  return impl_->step->power(rod);
}
bool World::is_broken(std::uint32_t rod) const {
  impl_->require_rod(rod);
  return impl_->step->is_broken(rod);
}

double World::tackle_tension(std::uint32_t tackle) const {
  impl_->require_tackle(tackle);
  impl_->require_tensions();
  return impl_->step->pull(impl_->step->tackle_cord(tackle));
}
double World::tackle_power(std::uint32_t tackle) const {
  impl_->require_tackle(tackle);
  impl_->require_tensions();
  return impl_->step->power(impl_->step->tackle_cord(tackle));
}
double World::tackle_tension(std::uint32_t tackle, std::uint32_t segment) const {
  impl_->require_tackle(tackle);
  impl_->require_tensions();
  const std::size_t segments = impl_->step->tackle(tackle).particles.size() - 1;
  if (segment >= segments) refuse("tackle ", tackle, ": segment ", segment, " is unknown, it has ", segments);
  return impl_->step->pull(impl_->step->tackle_cord(tackle), segment);
}

Vec3 World::reaction(std::uint32_t particle) const {
  impl_->require(particle, true, "nothing holds it");
  impl_->require_tensions();
  return impl_->step->reaction(particle);
}
void World::copy_reactions(std::span<Vec3> out) const {
  impl_->require_tensions();
  impl_->require_fit(out, "reactions");
  for (std::uint32_t i = 0; i < particle_count(); ++i)
    out[i] = impl_->fixed[i] != 0 ? impl_->step->reaction(i) : Vec3{};
}

Vec3 World::pin_force(std::uint32_t pin) const {
  return impl_->mean_of<Pin>(pin, &detail::ContactSolver::pin_force);
}
double World::angle_torque(std::uint32_t angle) const {
  return impl_->mean_of<AngleControl>(angle, &detail::ContactSolver::angle_torque);
}
Vec3 World::spring_force(std::uint32_t spring) const {
  return impl_->mean_of<Spring>(spring, &detail::ContactSolver::spring_force);
}
double World::torsion_torque(std::uint32_t torsion) const {
  return impl_->mean_of<Torsion>(torsion, &detail::ContactSolver::torsion_torque);
}
Vec3 World::contact_force(std::uint32_t shape) const {
  Impl::require_one_of(impl_->shape_count(), "shape", shape);
  return contact_force(impl_->shape(shape));
}
Vec3 World::contact_force(ShapeId shape) const {
  const bool moves = impl_->moves(shape);
  impl_->require_tensions();
  return moves ? impl_->step->contact().contact_force(shape) : impl_->step->force_on_ground(shape);
}
bool World::has_shape(ShapeId shape) const {
  return !impl_->moves(shape) || impl_->step->has_shape(shape);
}
std::span<const Contact> World::contacts() const {
  if (!impl_->contacts) refuse("contacts are not known: Settings::contacts asks for them");
  return impl_->step->contacts();
}
std::span<const Event> World::events() const {
  if (!impl_->events) refuse("events are not known: Settings::events asks for them");
  return impl_->step->events();
}
void World::copy_contact_forces(std::span<Vec3> out) const {
  impl_->require_tensions();
  const std::uint32_t shapes = impl_->shape_count();
  if (out.size() != shapes)
    refuse("contact forces of ", shapes, " shapes cannot be copied into ", out.size(), " elements");
  for (std::uint32_t i = 0; i < shapes; ++i) out[i] = impl_->step->contact().contact_force(impl_->shape(i));
}

std::vector<Problem> World::problems(double most_strain) const {
  const Array<Problem> found = impl_->step->problems(most_strain);
  return {found.begin(), found.end()};
}

std::uint32_t World::particle_count() const {
  return static_cast<std::uint32_t>(impl_->fixed.size());
}
std::uint32_t World::shape_count() const {
  return impl_->shape_count();
}
std::uint32_t World::rod_count() const {
  return impl_->step->population().rods.count();
}
double World::time() const {
  return impl_->time;
}

void World::copy_positions(std::span<Vec3> out) const {
  impl_->require_fit(out, "positions");
  impl_->step->copy_positions(out);
}
void World::copy_velocities(std::span<Vec3> out) const {
  impl_->require_fit(out, "velocities");
  impl_->step->copy_velocities(out);
}
Vec3 World::position(std::uint32_t particle) const {
  impl_->require_known(particle);
  return (*impl_->step).position(particle);
}
Vec3 World::velocity(std::uint32_t particle) const {
  impl_->require_known(particle);
  return (*impl_->step).velocity(particle);
}
std::uint64_t World::state_hash() const {
  return impl_->step->state_hash();
}
const WorldInfo& World::info() const {
  return impl_->step->info(impl_->memory.held());
}

StepReport& StepReport::operator+=(const StepReport& other) {
  substeps += other.substeps;
  block_sweeps += other.block_sweeps;
  rod_projections += other.rod_projections;
  stopped_by = std::max(stopped_by, other.stopped_by);
  skipped_within_tolerance += other.skipped_within_tolerance;
  mid_guarded += other.mid_guarded;
  frozen_islands += other.frozen_islands;
  direct_substeps += other.direct_substeps;
  newton += other.newton;
  halvings += other.halvings;
  fallbacks += other.fallbacks;
  repeated_steps += other.repeated_steps;
  elastic_substeps += other.elastic_substeps;
  unsolved += other.unsolved;
  largest_gap = std::max(largest_gap, other.largest_gap);
  rms_gap = std::max(rms_gap, other.rms_gap);
  inaccurate_steps += other.inaccurate_steps;
  capped_steps += other.capped_steps;
  step_us += other.step_us;
  asked_us += other.asked_us;
  broken_rods += other.broken_rods;
  contact_points = std::max(contact_points, other.contact_points);
  guarded_energy += other.guarded_energy;
  trimmed_energy += other.trimmed_energy;
  missed_contacts += other.missed_contacts;
  awake_islands = other.awake_islands;
  fell_asleep += other.fell_asleep;
  return *this;
}

std::string_view to_string(StoppedBy reason) {
  switch (reason) {
    case StoppedBy::nothing:
      return "nothing";
    case StoppedBy::tolerance:
      return "tolerance";
    case StoppedBy::sweeps:
      return "sweeps";
    case StoppedBy::budget:
      break;
  }
  return "budget";
}

}  // namespace plumb
