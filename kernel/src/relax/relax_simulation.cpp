#include "relax/relax_simulation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "plumb/measures.hpp"
#include "relax/compile.hpp"
#include "relax/describe.hpp"
#include "scene/project_velocities.hpp"
#include "scene/refuse.hpp"
#include "scene/scene_graph.hpp"
#include "step/state_hash.hpp"

namespace plumb::detail {
namespace {

std::vector<Vec3> positions_of(const Scene& scene) {
  std::vector<Vec3> positions;
  for (const Particle& particle : scene.particles) positions.push_back(particle.position);
  return positions;
}

/// Shortest rod whose length is kept to rounding: what is left of a violation is some epsilon of L^2, which
/// must not be flushed to zero. 3.2e-16 m in float (at 1e-17 m rods are off by 1e-4, at 1e-19 m they break),
/// 1.0e-146 m in double.
template <class T>
double shortest_rod() {
  return std::sqrt(static_cast<double>(std::numeric_limits<T>::min()) / std::numeric_limits<T>::epsilon());
}

/// Refuses numbers that T is too coarse for.
template <class T>
void require_representable(const Scene& scene, Precision precision) {
  for (std::size_t i = 0; i < scene.particles.size(); ++i)
    if (!std::isfinite(static_cast<T>(norm(scene.particles[i].position))))
      refuse("particle ", i, ": position is too large for ", to_string(precision));
  for (std::size_t i = 0; i < scene.rods.size(); ++i)
    if (const double length = rod_length(scene, i); length < shortest_rod<T>())
      refuse("rod ", i, ": length ", length, " m is too short for ", to_string(precision), ", which needs ",
             shortest_rod<T>(), " m");
}

}  // namespace

// --- Compiling

template <class T>
RelaxSimulation<T>::RelaxSimulation(const Scene& scene, const Settings& settings)
    : settings_(settings),
      verlet_{gradient_of(settings), scene.drag},
      gravity_(scene.gravity),
      constants_(make_constants(scene)),
      workers_(settings),
      kernels_(simd::kernels<T>(settings.isa.value_or(best_isa()))),
      initial_velocities_(scene.particles.size()) {
  for (std::size_t i = 0; i < scene.particles.size(); ++i)
    if (!scene.particles[i].fixed) initial_velocities_[i] = scene.particles[i].velocity;
  info_.projected_velocity = project_velocities(scene, constants_.inverse_mass, initial_velocities_);
  require_representable<T>(scene, settings.precision);
  make_blocks(scene);
  fill_info(scene);
}

template <class T>
void RelaxSimulation<T>::make_blocks(const Scene& scene) {
  const SceneGraph owner(scene);
  const layouts::Graph graph = owner.view();
  Plan plan =
      plan_blocks(graph, settings_.layout, common_rods(scene, constants_), layouts::lane_width<T>, sizeof(T));
  info_.islands = plan.islands;
  for (auto& packing : plan.packings) {
    Block<T>& block = blocks_.emplace_back(std::move(packing), settings_.order == SweepOrder::jacobi);
    block.set_weights(constants_, settings_.weights, settings_.order, settings_.omega);
    const auto& vertices = block.packing().slot_vertex;
    for (std::uint32_t slot = 0; slot < vertices.size(); ++slot)
      block.write(block.x(), slot, scene.particles[vertices[slot]].position);
  }
  starts_off_length_ = measure_stretch(scene, positions_of(scene)).max > 1e-9;
  std::vector<std::span<const std::uint32_t>> slot_vertex;
  for (const auto& block : blocks_) slot_vertex.emplace_back(block.packing().slot_vertex);
  places_ = Places(graph.vertices, slot_vertex);
  schedule_ = make_schedule<T>(blocks_, thresholds_.rods);
}

template <class T>
void RelaxSimulation<T>::fill_info(const Scene& scene) {
  info_.particles = static_cast<std::uint32_t>(scene.particles.size());
  info_.rods = static_cast<std::uint32_t>(scene.rods.size());
  info_.relaxed_rods = info_.rods;
  info_.isa = settings_.isa.value_or(best_isa());
  info_.threads = workers_.size();
  info_.parallel = uses_threads();
  info_.skipped_drag = verlet_.drag == 0;
  describe_blocks();
}

template <class T>
void RelaxSimulation<T>::describe_blocks() {
  info_.skipped_per_rod_weights = 0;
  info_.blocks.clear();
  for (const auto& block : blocks_) {
    info_.skipped_per_rod_weights += block.uniform_rods();
    add_to_list(info_.blocks, describe(block));
  }
}

// --- Stepping

template <class T>
StepReport RelaxSimulation<T>::step(double dt) {
  start_step(dt / settings_.substeps);
  RelaxCounters counters;
  workers_.lead(uses_threads(), [&] { run_blocks(counters); });
  finish_anchors();
  time_advanced_ = true;

  StepReport report;
  report.substeps = settings_.substeps;
  report.block_sweeps = counters.block_sweeps;
  report.rod_projections = counters.rod_projections;
  report.stopped_by = static_cast<StoppedBy>(counters.stopped_by.load());
  report.skipped_within_tolerance = counters.skipped_within_tolerance;
  report.mid_guarded = counters.mid_guarded;
  report.frozen_islands = counters.frozen_islands;
  return report;
}

template <class T>
void RelaxSimulation<T>::start_step(double h) {
  const bool first = !time_advanced_;
  if (first) {
    start_displacements(h);
  } else if (h != h_) {
    change_step(h);
  }
  if (first || h != h_) kicks_stale_ = true;
  h_ = h;
  if (kicks_stale_) write_kicks();
  for (auto& block : blocks_) {
    block.release_anchors();
    if (first && starts_off_length_) block.settle();
  }
  start_anchors();
}

template <class T>
void RelaxSimulation<T>::start_displacements(double h) {
  for_slots([&](Block<T>& block, std::uint32_t slot, std::uint32_t particle) {
    if (!is_movable(particle)) return;
    const auto start = verlet_.start(initial_velocities_[particle], acceleration(particle), h);
    block.write(block.displacement(0), slot, start.last);
    block.write(block.displacement(1), slot, start.before);
  });
}

template <class T>
void RelaxSimulation<T>::change_step(double h) {
  for_slots([&](Block<T>& block, std::uint32_t slot, std::uint32_t particle) {
    if (!is_movable(particle)) return;
    T* const last = block.displacement(0);
    block.write(last, slot, verlet_.change_step(block.read(last, slot), acceleration(particle), h_, h));
  });
}

template <class T>
void RelaxSimulation<T>::write_kicks() {
  for_slots([&](Block<T>& block, std::uint32_t slot, std::uint32_t particle) {
    block.write(block.kick(), slot, verlet_.kick(acceleration(particle), h_));
  });
  kicks_stale_ = false;
}

template <class T>
void RelaxSimulation<T>::run_blocks(RelaxCounters& counters) {
  RelaxSettings<T> relax{&kernels_,
                         verlet_.gradient,
                         settings_.order,
                         settings_.stop,
                         settings_.substeps,
                         static_cast<T>(verlet_.decay(h_)),
                         0};
  const double budget = settings_.stop.budget_us.value_or(0) / settings_.substeps;
  const double rods = std::max<double>(1, static_cast<double>(constants_.length2.size()));
  for (const std::uint32_t b : schedule_.shared_blocks) {
    relax.budget_us = budget * blocks_[b].rods() / rods;
    for (std::uint32_t substep = 0; substep < settings_.substeps; ++substep)
      relax_block(blocks_[b], relax, counters, workers_.team());
  }
  workers_.team().for_each(
      static_cast<std::uint32_t>(schedule_.lone_work.size()), [&](std::uint32_t i, unsigned) {
        const auto [b, begin, end] = schedule_.lone_work[i];
        RelaxSettings<T> mine = relax;
        mine.budget_us = budget * workers_.team().parts() * blocks_[b].rods(begin, end) / rods;
        relax_alone(blocks_[b], begin, end, mine, counters);
      });
  for (const std::uint32_t b : schedule_.lone_blocks) blocks_[b].count_substeps(settings_.substeps);
}

template <class T>
bool RelaxSimulation<T>::uses_threads() const {
  const double projections =
      double{1} * constants_.length2.size() * settings_.stop.sweeps * settings_.substeps;
  return workers_.size() > 1 && projections >= thresholds_.projections;
}

template <class T>
Vec3 RelaxSimulation<T>::acceleration(std::uint32_t particle) const {
  if (!is_movable(particle)) return {};
  return forces_.empty() ? gravity_ : gravity_ + constants_.inverse_mass[particle] * forces_[particle];
}

template <class T>
template <class F>
void RelaxSimulation<T>::for_slots(F&& f) {
  for (auto& block : blocks_) {
    const auto& vertices = block.packing().slot_vertex;
    for (std::uint32_t slot = 0; slot < vertices.size(); ++slot)
      if (!block.is_frozen(slot)) f(block, slot, vertices[slot]);
  }
}

template <class T>
template <class F>
void RelaxSimulation<T>::for_places(std::uint32_t particle, F&& f) {
  for (const Place place : places_.of(particle)) f(blocks_[place.block], place.slot);
}

// --- Anchors

template <class T>
void RelaxSimulation<T>::move_anchor(std::uint32_t particle, Vec3 target) {
  if (anchor_of_.empty()) anchor_of_.assign(info_.particles, layouts::none);
  std::uint32_t& known = anchor_of_[particle];
  if (known != layouts::none) {
    anchors_[known].target = target;
    return;
  }
  known = static_cast<std::uint32_t>(anchors_.size());
  anchors_.push_back({particle, target});
}

template <class T>
void RelaxSimulation<T>::start_anchors() {
  for (const Anchor& anchor : anchors_)
    for_places(anchor.particle, [&](Block<T>& block, std::uint32_t slot) {
      block.move_anchor(slot, (1.0 / settings_.substeps) * (anchor.target - block.read(block.x(), slot)));
    });
  for (auto& block : blocks_) block.sort_moving_anchors();
}

/// Substeps add up to the target but for rounding; an anchor stands exactly where it was sent.
template <class T>
void RelaxSimulation<T>::finish_anchors() {
  for (const Anchor& anchor : anchors_) {
    for_places(anchor.particle,
               [&](Block<T>& block, std::uint32_t slot) { block.write(block.x(), slot, anchor.target); });
    anchor_of_[anchor.particle] = layouts::none;
  }
  anchors_.clear();
}

// --- Changes

template <class T>
void RelaxSimulation<T>::set_stop_rule(const StopRule& rule) {
  settings_.stop = rule;
  info_.parallel = uses_threads();
}

template <class T>
void RelaxSimulation<T>::set_weights(Weights weights) {
  settings_.weights = weights;
  for (auto& block : blocks_) block.set_weights(constants_, weights, settings_.order, settings_.omega);
  describe_blocks();
}

template <class T>
void RelaxSimulation<T>::set_force(std::uint32_t particle, Vec3 force) {
  if (forces_.empty()) forces_.resize(constants_.inverse_mass.size());
  const Vec3 change = (h_ * h_ * constants_.inverse_mass[particle]) * (force - forces_[particle]);
  forces_[particle] = force;
  kicks_stale_ = true;
  if (!time_advanced_ || verlet_.gradient == Gradient::mid) return;
  for_places(particle, [&](Block<T>& block, std::uint32_t slot) {
    if (block.is_frozen(slot)) return;
    T* const last = block.displacement(0);
    T* const before = block.displacement(1);
    const auto changed =
        verlet_.change_acceleration({block.read(last, slot), block.read(before, slot)}, change);
    block.write(last, slot, changed.last);
    block.write(before, slot, changed.before);
  });
}

// --- Reading

template <class T>
Vec3 RelaxSimulation<T>::position(std::uint32_t particle) const {
  const Place place = places_.first(particle);
  const Block<T>& block = blocks_[place.block];
  return block.read(block.x(), place.slot);
}

template <class T>
Vec3 RelaxSimulation<T>::velocity(std::uint32_t particle) const {
  if (!time_advanced_) return initial_velocities_[particle];
  const Place place = places_.first(particle);
  const Block<T>& block = blocks_[place.block];
  return verlet_.velocity(
      {block.read(block.displacement(0), place.slot), block.read(block.displacement(1), place.slot)}, h_);
}

template <class T>
std::uint64_t RelaxSimulation<T>::state_hash() const {
  StateHash hash;
  for (std::uint32_t particle = 0; particle < info_.particles; ++particle) {
    const Place place = places_.first(particle);
    const Block<T>& block = blocks_[place.block];
    for (const T* field : {block.x(), block.displacement(0)}) hash.add<T>(block.read(field, place.slot));
  }
  return hash.value();
}

template class RelaxSimulation<float>;
template class RelaxSimulation<double>;

}  // namespace plumb::detail
