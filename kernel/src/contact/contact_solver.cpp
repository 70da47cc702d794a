#include "contact/contact_solver.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "contact/linkage/linkage_bounds.hpp"
#include "contact/relaxed/relaxed_stepper.hpp"
#include "contact/solved/cluster_stepper.hpp"

namespace plumb::detail {
namespace {

/// From these accuracies on the higher order takes less time for a figure in the air.
constexpr double worth_order_4 = 1e-3, worth_order_6 = 1e-6;

std::uint32_t time_order_of(const Settings& settings) {
  const Gradient gradient = IslandGradients(settings).homeless;
  if (gradient != Gradient::old) return gradient == Gradient::new_ ? 1 : 2;
  const bool chooses = settings.method == Method::automatic && settings.accuracy;
  if (!chooses || *settings.accuracy > worth_order_4) return settings.time_order;
  return *settings.accuracy > worth_order_6 ? 4 : 6;
}

std::unique_ptr<ClusterMover> make_mover(const Settings& settings, Isa isa, const ContactSettings& contact) {
  if (settings.method != Method::relax) {
    const bool picks = settings.method == Method::automatic && !settings.accuracy && !settings.gradient;
    const CrowdRules rules{.stop = {}, .step_sweeps = 120};
    return std::make_unique<ClusterStepper>(
        isa, contact, std::make_unique<RelaxedStepper<double>>(isa, contact, rules), picks);
  }
  const CrowdRules rules{IslandGradients(settings).homeless, settings.weights, settings.omega, settings.stop};
  if (settings.precision == Precision::single)
    return std::make_unique<RelaxedStepper<float>>(isa, contact, rules);
  return std::make_unique<RelaxedStepper<double>>(isa, contact, rules);
}

}  // namespace

// --- Layout

ContactSolver::ContactSolver(const std::shared_ptr<const Scene>& scene, const SceneParts& parts,
                             const Settings& settings)
    : isa_(settings.isa.value_or(best_isa())),
      relaxes_(settings.method == Method::relax),
      sleep_(settings.sleep),
      sleep_time_(settings.sleep_time),
      settings_(scaled(settings.contact)),
      time_order_(time_order_of(settings)),
      surroundings_(*scene),
      is_controlled_(settings.accuracy.has_value()),
      gradients_(settings) {
  for (unsigned part = 0; part < settings.threads; ++part)
    movers_.push_back(make_mover(settings, isa_, settings_));
  std::multimap<Array<double>, std::size_t> kinds;
  Array<std::uint32_t> number_of(parts.count(), no_island);
  for (std::uint32_t p = 0; p < parts.count(); ++p) {
    Scene part = parts.part(p);
    const bool plain = is_plain(part);
    if (plain && part.capsules.empty()) continue;
    const bool is_lumped = mass_model_of(settings) == MassModel::lumped && (plain || relaxes_);
    if (is_lumped) lump_masses(part);
    Array<double> numbers = likeness(part);
    const auto [first, last] = kinds.equal_range(numbers);
    const auto like = std::find_if(first, last, [&](const auto& of) { return is_of_kind(of.second, part); });
    const std::size_t kind = like != last ? like->second : add_kind(part, {scene, parts.names(p), is_lumped});
    if (like == last) kinds.emplace(std::move(numbers), kind);
    const std::uint32_t number = number_of[p] = static_cast<std::uint32_t>(states_.size());
    states_.emplace_back(*linkages_[kind], number, part, relaxes_).particles = parts.particles(p);
    ++uses_[kind];
    states_.back().gradient = gradients_.of(*linkages_[kind], plain);
    is_plain_.push_back(plain);
    first_slot_.push_back(static_cast<Slot>(island_of_.size()));
    island_of_.resize(island_of_.size() + part.particles.size(), number);
  }
  name(parts, number_of);
  begin_pulls(settings);
  visitors_.resize(states_.size());
  rooms_.resize(states_.size());
  histories_.resize(is_controlled_ ? states_.size() : 0);
  clusters_.start(states_, settings_.margin);
}

auto ContactSolver::plain_islands() const -> Array<PlainIsland> {
  Array<PlainIsland> out;
  for (const LinkageState& state : states_)
    if (is_plain_[state.number] != 0)
      out.push_back({state.number, state.particles, state.linkage->movable()});
  return out;
}

void ContactSolver::set_home(std::uint32_t island, Solver& home, std::uint32_t number, Array<Slot> slots) {
  visitors_[island] = Visitor(home, number, std::move(slots));
}

Array<MadeSolver::Place> ContactSolver::places() const {
  Array<MadeSolver::Place> out;
  for (Slot slot = 0; slot < island_of_.size(); ++slot)
    out.push_back({state_of(slot).particles[local(slot)], slot});
  return out;
}

// --- Steps

void ContactSolver::wake_carried() {
  woken_.clear();
  if (surroundings_.any_moves()) wake_those([&](const LinkageState& state) { return is_carried(state); });
}

/// Wakes islands that sleep, of which is_meant(state).
template <class IsMeant>
void ContactSolver::wake_those(IsMeant&& is_meant) {
  for (const LinkageState& state : states_) {
    if (!state.asleep || state.linkage == nullptr || !is_meant(state)) continue;
    clusters_.wake(state.number);
    if (const Visitor& visitor = visitors_[state.number]; visitor.is_at_home())
      woken_.push_back({visitor.number(), visitor.first_slot()});
  }
}

void ContactSolver::put_anchors(std::span<const std::uint32_t> anchors, std::span<const Vec3> positions) {
  woken_.clear();
  const auto is_beside = [&](const LinkageState& state) {
    return surroundings_.anchored.reach_into(bounds_of(*state.linkage, state.x, settings_.margin), anchors,
                                             state.linkage->filters());
  };
  wake_those(is_beside);
  for (std::size_t k = 0; k < anchors.size(); ++k) surroundings_.anchored.put(anchors[k], positions[k]);
  wake_those(is_beside);
}

/// Returns whether ground moves where an island is.
bool ContactSolver::is_carried(const LinkageState& state) const {
  return surroundings_.move_under(bounds_of(*state.linkage, state.x, settings_.margin),
                                  state.linkage->filters());
}

void ContactSolver::begin_step(double dt, Team& team) {
  clusters_.form(team, [&](LinkageState& state) {
    const Visitor& visitor = visitors_[state.number];
    const double speed = visitor.is_at_home() ? visitor.look(state) : top_speed(state);
    return surroundings_.carried(reach(state, speed, dt, settings_.margin), state.linkage->filters());
  });
  pieces_.clear();
  returned_.clear();
  for (std::uint32_t c = 0; c < clusters_.count(); ++c) {
    if (!can_stay_home(clusters_[c])) {
      pieces_.push_back(c);
      for (LinkageState* const state : clusters_[c])
        if (visitors_[state->number].is_at_home())
          visitors_[state->number].come(*state, relaxes_ ? nullptr : &work_);
      continue;
    }
    LinkageState& state = *clusters_[c].front();
    if (visitors_[state.number].is_at_home()) continue;
    visitors_[state.number].leave(state);
    returned_.push_back({visitors_[state.number].number(), visitors_[state.number].first_slot()});
  }
  rests_.assign(clusters_.count(), 0);
  work_of_pieces_ = 0;
  for (const std::uint32_t c : pieces_) work_of_pieces_ += clusters_[c].size();
}

bool ContactSolver::is_for_team(std::uint32_t piece, unsigned parts) const {
  const std::size_t islands = cluster(piece).size();
  return islands >= worth_threads && islands * parts > work_of_pieces_;
}

/// Returns whether a cluster is a single island that its own solver can move, with nothing near.
bool ContactSolver::can_stay_home(std::span<LinkageState* const> cluster) const {
  const LinkageState& state = *cluster.front();
  // Rods that are off their lengths would be brought there in one substep, as a blow.
  return cluster.size() == 1 && visitors_[state.number].has_home() && !state.frozen &&
         state.strain == Strain::none && !state.linkage->neighbors().any_may_touch() &&
         !surroundings_.reach_into(clusters_.reach_of(state.number), state.linkage->filters());
}

std::uint32_t ContactSolver::islands(std::uint32_t piece) const {
  return static_cast<std::uint32_t>(cluster(piece).size());
}

double ContactSolver::advance(std::uint32_t piece, double h, std::uint32_t count, unsigned part,
                              Tally& report) {
  const ClusterRules rules{count, time_order_, is_controlled_, team_};
  movers_[part]->step(cluster(piece), surroundings_, rules, h * count, report);
  return 0;
}

void ContactSolver::begin_piece(std::uint32_t piece, unsigned) {
  for (LinkageState* const state : cluster(piece)) {
    state->elapsed = 0;
    if (!state->asleep) state->pulls.begin_step();
    state->lengths.begin_step();
    if (!grabs_.empty()) begin_grabs(*state);
  }
}

void ContactSolver::end_piece(std::uint32_t piece, double dt, unsigned) {
  for (LinkageState* const state : cluster(piece))
    if (!state->asleep) {
      state->pulls.dt = dt;
      if (state->pulls.counts && !grabs_.empty()) count_grabs(*state, dt);
      state->pulls.touched.merge();
    }
  rests_[pieces_[piece]] = rests(cluster(piece), dt);
}

void ContactSolver::end_step(StepReport& report) {
  report.fell_asleep += clusters_.settle(rests_);
  for (const std::uint32_t island : clusters_.awake())
    if (!visitors_[island].is_at_home()) ++report.awake_islands;
}

/// Returns whether a cluster has been slow for long enough to sleep and something holds it. What nothing
/// holds is slow only for a while, as at the top of a throw, and so is what turns round, which accelerates.
bool ContactSolver::rests(std::span<LinkageState* const> cluster, double dt) const {
  bool slow = sleep_, held = false;
  for (LinkageState* const state : cluster) {
    if (state->asleep) continue;
    // What sweeps leave makes a particle here or there jump, though its island rests.
    const double speed = relaxes_ || state->is_relaxed ? mean_speed(*state) : top_speed(*state);
    const bool is_slow = speed < settings_.sleep_speed && !state->is_pushed_out;
    state->follow_slowness(is_slow, dt);
    const bool is_grabbed = state->linkage->first_grab() < state->linkage->elastics().size();
    held = held || state->linkage->is_grounded() || is_grabbed || !state->kept.empty();
    slow = slow && is_slow && state->slow_time >= sleep_time_ && !is_carried(*state) &&
           2 * state->change_within(sleep_time_) < settings_.sleep_speed;
  }
  return slow && held;
}

// --- Accuracy

/// An island that may touch something has order 2, because contact allows no more.
ErrorModel ContactSolver::error_model() const {
  const auto lives = [](const LinkageState& state) { return state.linkage != nullptr; };
  const bool is_alone =
      surroundings_.are_empty() && std::count_if(states_.begin(), states_.end(), lives) == 1;
  return {.order = is_alone ? time_order_ : std::min(time_order_, 2u), .by_comparison = true};
}

double& ContactSolver::best_substep(std::uint32_t piece) {
  return histories_[cluster(piece).front()->number].best_substep;
}

void ContactSolver::save(std::uint32_t piece, Saved which) {
  for (LinkageState* const state : cluster(piece))
    histories_[state->number].saved[static_cast<int>(which)] = state->motion();
}

void ContactSolver::restore(std::uint32_t piece, Saved which) {
  for (LinkageState* const state : cluster(piece))
    state->return_to(histories_[state->number].saved[static_cast<int>(which)]);
}

void ContactSolver::mark(std::uint32_t piece) {
  for (LinkageState* const state : cluster(piece)) histories_[state->number].mark = state->x;
}

double ContactSolver::distance_from_mark(std::uint32_t piece) const {
  double worst = 0;
  for (const LinkageState* const state : cluster(piece)) {
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

// These make no virtual call for each, since nothing is derived from this class.
void ContactSolver::read_positions(std::span<const Run> runs, Vec3* out) const {
  for (const Run& run : runs)
    if (run.is_in_turn())
      copy_positions(run, out);
    else
      run.read_slots(out, [this](Slot slot) { return position(slot); });
}

void ContactSolver::read_velocities(std::span<const Run> runs, Vec3* out) const {
  for (const Run& run : runs) run.read_slots(out, [this](Slot slot) { return velocity(slot); });
}

/// Copies those of a run of one slot after the other, island by island. Each lies elsewhere, so that memory
/// is asked for some of the next ahead.
void ContactSolver::copy_positions(const Run& run, Vec3* out) const {
  constexpr std::uint32_t near = 6, far = 12;
  Vec3* to = out + run.first;
  for (Slot slot = run.slot, end = run.slot + run.count; slot < end;) {
    const std::uint32_t island = island_of_[slot];
    if (island + far < states_.size()) {
      __builtin_prefetch(&states_[island + far].x);
      __builtin_prefetch(states_[island + near].x.data());
    }
    const Array<Vec3>& x = states_[island].x;
    std::uint32_t i = slot - first_slot_[island];
    for (; i < x.size() && slot < end; ++i, ++slot) {
      const Vec3 at = x[i];
      *to++ = {at.x, at.y, at.z};
    }
  }
}

void ContactSolver::add_to_hash(Slot slot, StateHash& hash) const {
  hash.add<double>(position(slot));
  hash.add<double>(velocity(slot));
}

double ContactSolver::read(std::span<const Slot> slots, std::span<Vec3> out) const {
  double most = 0;  // a squared speed, m²/s²
  for (std::size_t i = 0; i < slots.size(); ++i) {
    out[i] = position(slots[i]);
    most = std::max(most, dot(velocity(slots[i]), velocity(slots[i])));
  }
  return std::sqrt(most);
}

void ContactSolver::set_force(Slot slot, Vec3 newton) {
  LinkageState& state = state_of(slot);
  Vec3& force = state.force[local(slot)];
  // What it may have follows, so that a force that is given again and again gives no more than its work.
  if (state.energy) *state.energy -= dot(newton - force, state.x[local(slot)]);
  force = newton;
  clusters_.wake(state.number);
}

void ContactSolver::move_anchor(Slot slot, const AnchorMove& move) {
  state_of(slot).v[local(slot)] = move.velocity();
  if (move.to != move.from) clusters_.wake(state_of(slot).number);
}

void ContactSolver::place_anchor(Slot slot, Vec3 target) {
  LinkageState& state = state_of(slot);
  if (state.x[local(slot)] != target) clusters_.wake(state.number);
  state.x[local(slot)] = target;
  state.v[local(slot)] = {};
  state.factored = false;
}

void ContactSolver::set_motion(Slot slot, Vec3 position, Vec3 velocity) {
  LinkageState& state = state_of(slot);
  state.x[local(slot)] = position;
  state.v[local(slot)] = velocity;
  state.elastic_rates.clear();
  state.factored = false;
  state.energy.reset();
}

// --- Reports

void ContactSolver::describe(WorldInfo& info) const {
  for (const auto& linkage : linkages_) {
    BlockInfo block{.shape = "linkage", .layout = "aos"};
    for (const LinkageState& state : states_) {
      if (state.linkage == nullptr || kind_of(state) != linkage.get() || is_plain_[state.number] != 0)
        continue;
      ++block.islands;
      block.particles += linkage->particles();
      block.rods += linkage->rods();
      block.bytes += (2 * linkage->particles() + linkage->movable()) * sizeof(Vec3) +
                     linkage->plan().blocks() * sizeof(simd::Block);
    }
    if (block.islands == 0) continue;
    ++info.linkages;
    (relaxes_ ? info.relaxed_rods : info.direct_rods) += block.rods;
    info.blocks.push_back(block);
  }
}

bool ContactSolver::set_stop_rule(const StopRule& rule) {
  const auto reads = [&](const auto& mover) { return mover->set_stop_rule(rule); };
  return std::count_if(movers_.begin(), movers_.end(), reads) > 0;
}

bool ContactSolver::set_weights(Weights weights) {
  const auto reads = [&](const auto& mover) { return mover->set_weights(weights); };
  return std::count_if(movers_.begin(), movers_.end(), reads) > 0;
}

double ContactSolver::project_initial_velocities() {
  double largest = 0;
  for (const std::uint32_t island : clusters_.awake())
    if (is_plain_[island] == 0) largest = std::max(largest, project_initial_velocities(island));
  return largest;
}

double ContactSolver::project_initial_velocities(std::uint32_t island) {
  return relaxes_ ? 0 : project_velocities(states_[island], work_);
}

}  // namespace plumb::detail
