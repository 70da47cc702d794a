#include "direct/loops/loop_group.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "step/choose_method.hpp"

namespace plumb::detail {

LoopGroup::LoopGroup(const Scene& scene, Gradient gradient, Isa isa, bool estimates, std::uint32_t time_order)
    : gradient_(gradient),
      isa_(isa),
      estimates_(estimates),
      stepper_(gradient, scene.drag, time_order),
      places_(scene.particles.size()),
      fixed_in_(scene.particles.size()) {}

void LoopGroup::add(const Scene& scene, MassModel model, const layouts::Islands& islands,
                    std::span<const std::uint32_t> equal, const layouts::Graph& local) {
  const bool couples = std::any_of(equal.begin(), equal.end(), [&](std::uint32_t island) {
    return carries_mass(scene, islands.edges(island), model);
  });
  const auto topology = std::make_shared<LoopTopology>(local);
  if (couples || is_thin(local)) {
    topology->system =
        std::make_unique<LoopSystem>(topology->rods, topology->nodes, LoopStepper::couples(gradient_, model));
  } else {
    std::vector<Vec3> positions;
    for (const std::uint32_t vertex : islands.vertices(equal.front()))
      positions.push_back(scene.particles[vertex].position);
    topology->use_lines(positions);
  }
  for (const std::uint32_t island : equal) {
    std::vector<std::uint32_t> vertices;
    for (const std::uint32_t i : topology->order) vertices.push_back(islands.vertices(island)[i]);
    const auto number = size();
    for (std::uint32_t i = 0; i < vertices.size(); ++i) {
      if (i < topology->nodes)
        places_[vertices[i]] = {number, i};
      else
        fixed_in_[vertices[i]].push_back({number, i});
    }
    LoopState state(topology, scene, model, vertices, islands.edges(island));
    if (estimates_) state.acceleration = state.acceleration_before = state.u;
    LoopWorkspace work(state, gradient_, isa_);
    islands_.push_back(
        {std::move(state), std::move(work), std::vector<double>(3 * std::size_t{topology->nodes})});
  }
}

void LoopGroup::advance(std::uint32_t number, double h, std::uint32_t substeps, DirectCounters& counters) {
  Island& island = islands_[number];
  begin_step(island);
  advance(island, h, substeps, counters);
}

void LoopGroup::advance(std::uint32_t number, double dt, AccuracyControl control, DirectCounters& counters) {
  Island& island = islands_[number];
  begin_step(island);
  island.start = island.state.motion();
  control.begin_step(island.anchors_changed, stepper_.pieces(island.state, dt));
  control.step(
      dt, island.substep, counters,
      [&](double h, std::uint32_t substeps, DirectCounters& of_attempt) {
        if (control.by_comparison) return advance_and_compare(island, h, substeps, control, of_attempt);
        const double error = advance(island, h, substeps, of_attempt);
        return AccuracyControl::Attempt{
            .error = error, .is_blind = of_attempt.fallbacks > 0, .is_final = of_attempt.unsolved > 0};
      },
      [&] {
        island.state.motion() = island.start;
        if (island.work.lines) island.work.lines->forget();
      });
  if (island.anchors_changed) island.state.known = 0;
}

AccuracyControl::Attempt LoopGroup::advance_and_compare(Island& island, double h, std::uint32_t substeps,
                                                        const AccuracyControl& control,
                                                        DirectCounters& counters) const {
  return control.compare(
      h, substeps, island.anchors_changed || island.state.u_step == 0, counters,
      [&](double length, std::uint32_t count, DirectCounters& counted) {
        advance(island, length, count, counted);
      },
      [&] {
        island.stretch = island.state.motion();
        if (island.work.lines) island.work.lines->keep_history();
      },
      [&] {
        island.coarse = island.state.x;
        island.state.motion() = island.stretch;
        if (island.work.lines) island.work.lines->take_history_back();
      },
      [&] { return largest_distance(island.state.x, island.coarse, island.state.topology->nodes, 1); });
}

void LoopGroup::begin_step(Island& island) const {
  island.velocity_known = false;
  if (island.anchors_changed && gradient_ == Gradient::mid)
    stepper_.project_velocities(island.state, island.work);
}

double LoopGroup::advance(Island& island, double h, std::uint32_t substeps, DirectCounters& counters) const {
  double error = 0;
  for (std::uint32_t i = 0; i < substeps; ++i)
    error = std::max(error, stepper_.advance(island.state, h, island.work, counters));
  return error;
}

Vec3 LoopGroup::position(std::uint32_t particle) const {
  const Place place = places_[particle];
  return islands_[place.island].state.position(place.vertex);
}

Vec3 LoopGroup::displacement(std::uint32_t particle) const {
  const Place place = places_[particle];
  const double* u = islands_[place.island].state.u.data() + 3 * std::size_t{place.vertex};
  return {u[0], u[1], u[2]};
}

Vec3 LoopGroup::velocity(std::uint32_t particle) const {
  const Place place = places_[particle];
  Island& island = islands_[place.island];
  find_velocities(island);
  const double* v = island.velocity.data() + 3 * std::size_t{place.vertex};
  return {v[0], v[1], v[2]};
}

void LoopGroup::find_velocities(Island& island) const {
  if (island.velocity_known) return;
  stepper_.find_velocities(island.state, island.work);
  std::copy_n(island.work.delta.begin(), island.velocity.size(), island.velocity.begin());
  island.velocity_known = true;
}

void LoopGroup::set_force(std::uint32_t particle, Vec3 newton) {
  const Place place = places_[particle];
  Island& island = islands_[place.island];
  if (gradient_ == Gradient::old && island.state.u_step != 0) {
    // A displacement stands for the velocity of now under the force that made it.
    find_velocities(island);
    island.state.u = island.velocity;
    island.state.u_step = 0;
  }
  island.state.set_force(place.vertex, newton);
}

void LoopGroup::set_velocity(std::uint32_t particle, Vec3 velocity) {
  const Place place = places_[particle];
  double* u = islands_[place.island].state.u.data() + 3 * std::size_t{place.vertex};
  u[0] = velocity.x;
  u[1] = velocity.y;
  u[2] = velocity.z;
}

bool LoopGroup::project_positions(std::uint32_t number, double h) {
  Island& island = islands_[number];
  LoopState projected = island.state;
  DirectCounters counters;
  LoopStepper(Gradient::new_, 0).advance(projected, h, island.work, counters);
  if (counters.unsolved == 0) island.state.x = projected.x;
  if (island.work.lines) island.work.lines->forget();
  return counters.unsolved == 0;
}

void LoopGroup::project_velocities() {
  for (Island& island : islands_) {
    island.velocity_known = false;
    const bool rests =
        std::all_of(island.state.u.begin(), island.state.u.end(), [](double u) { return u == 0; });
    if (!rests) stepper_.project_velocities(island.state, island.work);
  }
}

void LoopGroup::set_anchor_velocity(std::uint32_t particle, Vec3 velocity) {
  for (const Place place : fixed_in_[particle]) {
    LoopState& state = islands_[place.island].state;
    state.fixed_velocity[place.vertex - state.topology->nodes] = velocity;
    state.anchors_move = true;
  }
}

void LoopGroup::start_anchors() {
  for (Island& island : islands_)
    island.anchors_changed = island.state.fixed_velocity != island.state.fixed_last_velocity;
}

void LoopGroup::set_anchor_position(std::uint32_t particle, Vec3 position) {
  for (const Place place : fixed_in_[particle]) {
    double* x = islands_[place.island].state.x.data() + 3 * std::size_t{place.vertex};
    x[0] = position.x;
    x[1] = position.y;
    x[2] = position.z;
  }
}

void LoopGroup::finish_anchors() {
  for (Island& island : islands_) {
    LoopState& state = island.state;
    if (!state.anchors_move) continue;
    state.anchors_move = std::any_of(state.fixed_velocity.begin(), state.fixed_velocity.end(),
                                     [](Vec3 v) { return v != Vec3{}; });
    state.fixed_last_velocity = state.fixed_velocity;
    std::fill(state.fixed_velocity.begin(), state.fixed_velocity.end(), Vec3{});
  }
}

}  // namespace plumb::detail
