#include "contact/contact_solver.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "contact/linkage_bounds.hpp"
#include "contact/scene_parts.hpp"

namespace plumb::detail {
namespace {

/// Slower than this (m/s) for so long (s), an island that something holds is at rest.
constexpr double sleep_speed = 0.02, sleep_time = 0.5;

}  // namespace

// --- Layout

ContactSolver::ContactSolver(const Scene& scene, const Settings& settings, unsigned threads)
    : isa_(settings.isa.value_or(best_isa())),
      sleep_(settings.sleep),
      surroundings_(scene),
      steppers_(threads, ClusterStepper(isa_)) {
  const SceneParts parts(scene);
  states_.resize(parts.count());
  histories_.resize(settings.accuracy ? parts.count() : 0);
  std::map<std::vector<double>, const Linkage*> kinds;
  for (std::uint32_t i = 0; i < parts.count(); ++i) {
    const Scene& part = parts.part(i);
    std::uint32_t movable = 0;
    bool asleep = true;
    for (const Particle& particle : part.particles) {
      movable += !particle.fixed;
      asleep = asleep && (particle.fixed || particle.asleep);
    }
    const Linkage*& kind = kinds[likeness(part)];
    if (kind == nullptr) {
      linkages_.push_back(std::make_unique<Linkage>(part, movable, isa_));
      kind = linkages_.back().get();
    }
    LinkageState& state = states_[i];
    state.linkage = kind;
    state.number = i;
    state.particles = parts.particles(i);
    state.force.resize(movable);
    state.acceleration.resize(movable);
    for (const Particle& particle : part.particles) {
      state.x.push_back(particle.position);
      state.v.push_back(particle.fixed || asleep ? Vec3{} : particle.velocity);
    }
    state.asleep = asleep;
    first_slot_.push_back(static_cast<Slot>(island_of_.size()));
    island_of_.resize(island_of_.size() + part.particles.size(), i);
  }
  clusters_.start(states_);
}

std::vector<MadeSolver::Place> ContactSolver::places() const {
  std::vector<MadeSolver::Place> out;
  for (Slot slot = 0; slot < island_of_.size(); ++slot)
    out.push_back({state_of(slot).particles[local(slot)], slot});
  return out;
}

// --- Steps

void ContactSolver::begin_step(double dt, Team& team) {
  clusters_.form(dt, team);
  rests_.assign(clusters_.count(), 0);
}

std::uint32_t ContactSolver::islands(std::uint32_t piece) const {
  return static_cast<std::uint32_t>(clusters_[piece].size());
}

double ContactSolver::advance(std::uint32_t piece, double h, std::uint32_t count, unsigned part,
                              StepReport& report) {
  steppers_[part].step(clusters_[piece], surroundings_, h * count, count, report);
  return 0;
}

void ContactSolver::end_piece(std::uint32_t piece, double dt) {
  rests_[piece] = rests(clusters_[piece], dt);
}

void ContactSolver::end_step(StepReport& report) {
  report.fell_asleep += clusters_.settle(rests_);
  report.awake_islands += static_cast<std::uint32_t>(clusters_.awake().size());
}

/// Whether a cluster has been slow for long enough to sleep, and something holds it: what nothing holds is
/// only slow for a while.
bool ContactSolver::rests(std::span<LinkageState* const> cluster, double dt) const {
  bool calm = sleep_, held = false;
  for (LinkageState* const state : cluster) {
    if (state->asleep) continue;
    state->calm = top_speed(*state) < sleep_speed ? state->calm + dt : 0;
    held = held || state->linkage->is_grounded() || !state->kept.empty();
    calm = calm && state->calm >= sleep_time;
  }
  return calm && held;
}

// --- Accuracy

double& ContactSolver::best_substep(std::uint32_t piece) {
  return histories_[clusters_[piece].front()->number].best_substep;
}

void ContactSolver::save(std::uint32_t piece, Saved which) {
  for (LinkageState* const state : clusters_[piece])
    histories_[state->number].saved[static_cast<int>(which)] = state->motion();
}

void ContactSolver::restore(std::uint32_t piece, Saved which) {
  for (LinkageState* const state : clusters_[piece]) {
    state->motion() = histories_[state->number].saved[static_cast<int>(which)];
    state->factored = false;
  }
}

void ContactSolver::mark(std::uint32_t piece) {
  for (LinkageState* const state : clusters_[piece]) histories_[state->number].mark = state->x;
}

double ContactSolver::distance_from_mark(std::uint32_t piece) const {
  double worst = 0;
  for (const LinkageState* const state : clusters_[piece]) {
    double sum = 0;
    for (std::uint32_t k = 0; k < state->linkage->movable(); ++k) {
      const Vec3 apart = state->x[k] - histories_[state->number].mark[k];
      sum += dot(apart, apart);
    }
    worst = std::max(worst, sum / state->linkage->movable());
  }
  return std::sqrt(worst);
}

// --- Particles

Vec3 ContactSolver::velocity(Slot slot) const {
  return is_fixed(slot) ? Vec3{} : state_of(slot).v[local(slot)];
}

void ContactSolver::add_to_hash(Slot slot, StateHash& hash) const {
  hash.add<double>(position(slot));
  hash.add<double>(velocity(slot));
}

void ContactSolver::set_force(Slot slot, Vec3 newton) {
  LinkageState& state = state_of(slot);
  state.force[local(slot)] = newton;
  state.energy.reset();
  clusters_.wake(state.number);
}

void ContactSolver::move_anchor(Slot slot, const AnchorMove& move) {
  state_of(slot).v[local(slot)] = move.velocity();
  if (move.to != move.from) clusters_.wake(state_of(slot).number);
}

void ContactSolver::place_anchor(Slot slot, Vec3 target) {
  LinkageState& state = state_of(slot);
  state.x[local(slot)] = target;
  state.v[local(slot)] = {};
  state.factored = false;
}

void ContactSolver::set_motion(Slot slot, Vec3 position, Vec3 velocity) {
  LinkageState& state = state_of(slot);
  state.x[local(slot)] = position;
  state.v[local(slot)] = velocity;
  state.factored = false;
  state.energy.reset();
}

// --- Reports

void ContactSolver::describe(WorldInfo& info) const {
  info.linkages = static_cast<std::uint32_t>(linkages_.size());
  info.direct_gradient = Gradient::old;
  for (const auto& linkage : linkages_) {
    BlockInfo block{.shape = "linkage", .layout = "aos"};
    for (const LinkageState& state : states_) {
      if (state.linkage != linkage.get()) continue;
      ++block.islands;
      block.particles += linkage->particles();
      block.rods += linkage->rods();
      block.bytes += (2 * linkage->particles() + linkage->movable()) * sizeof(Vec3) +
                     linkage->plan().blocks() * sizeof(simd::Block);
    }
    info.direct_rods += block.rods;
    info.blocks.push_back(block);
  }
}

// --- Making it

double ContactSolver::project_velocities() {
  double largest = 0;
  for (const std::uint32_t i : clusters_.awake()) {
    LinkageState& state = states_[i];
    const Linkage& linkage = *state.linkage;
    if (linkage.constraints() == 0) continue;
    state.factor();
    std::vector<Vec3> momentum(linkage.movable());
    std::vector<simd::Quad> unknowns(linkage.plan().columns(), simd::Quad{});
    const std::span<double> right = numbers(unknowns);
    linkage.momenta(state.v, momentum);
    linkage.put(momentum, right);
    linkage.plan().solve(state.factors, unknowns);
    for (std::uint32_t k = 0; k < linkage.movable(); ++k) {
      const Vec3 given = std::exchange(state.v[k], linkage.taken(right, k));
      const double change = norm(state.v[k] - given);
      // Where nothing but rounding changed, velocities stay as they were given, bit for bit.
      if (change <= 1e-12 * norm(given)) state.v[k] = given;
      largest = std::max(largest, change);
    }
  }
  return largest;
}

MadeSolver make_contact_solver(const Scene& scene, const Settings& settings, StartReport& report) {
  auto solver = std::make_unique<ContactSolver>(scene, settings, settings.threads);
  report.projected_velocity = std::max(report.projected_velocity, solver->project_velocities());
  MadeSolver made;
  made.places = solver->places();
  made.solver = std::move(solver);
  return made;
}

}  // namespace plumb::detail
