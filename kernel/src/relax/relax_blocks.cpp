// This file turns the islands that relaxation moves into blocks, each with a solver.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "plumb/measures.hpp"
#include "relax/plan.hpp"
#include "relax/relax_solver.hpp"
#include "scene/project_velocities.hpp"
#include "scene/refuse.hpp"
#include "threads/sharing.hpp"

namespace plumb::detail {
namespace {

/// Returns the shortest rod (m) whose length is kept to rounding. What is left of a violation is some epsilon
/// of L^2, which must not be flushed to zero. It is 3.2e-16 m in float and 1.0e-146 m in double. Float rods
/// of 1e-17 m are off by 1e-4, and of 1e-19 m they break.
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

/// Returns the rods that relaxation moves.
Array<std::uint32_t> relaxed_rods(const IslandSets& sets) {
  Array<std::uint32_t> rods;
  for (const auto& set : sets.sets)
    for (const std::uint32_t island : set)
      rods.insert(rods.end(), sets.islands.edges(island).begin(), sets.islands.edges(island).end());
  std::sort(rods.begin(), rods.end());
  return rods;
}

/// Returns a scene's particles and those of `rods` that resist a velocity from the start. Elastic rods do
/// not, and cables only once they pull.
Scene rigid_part(const Scene& scene, std::span<const std::uint32_t> rods) {
  Scene out;
  out.particles = scene.particles;
  for (const std::uint32_t rod : rods) {
    const RodLaw& law = scene.rods[rod].law;
    if (law.is_elastic() || law.one_sided) continue;
    out.rods.push_back(scene.rods[rod]);
    out.rods.back().length = rod_length(scene, rod);
  }
  return out;
}

/// Divides islands into those of rigid rods and those with rods that give, which do not share blocks.
std::array<IslandSets, 2> divided(const Scene& scene, const IslandSets& sets) {
  std::array<IslandSets, 2> out{IslandSets{sets.graph, sets.islands, {}},
                                IslandSets{sets.graph, sets.islands, {}}};
  const auto gives = [&](std::uint32_t island) {
    const auto& rods = sets.islands.edges(island);
    return std::any_of(rods.begin(), rods.end(),
                       [&](std::uint32_t rod) { return !scene.rods[rod].law.is_rigid(); });
  };
  for (const auto& set : sets.sets) {
    Array<std::uint32_t> parts[2];
    for (const std::uint32_t island : set) parts[gives(island) ? 1 : 0].push_back(island);
    for (int i = 0; i < 2; ++i)
      if (!parts[i].empty()) out[i].sets.push_back(std::move(parts[i]));
  }
  return out;
}

template <class T>
void add_blocks(const Scene& scene, const IslandSets& sets, const std::shared_ptr<RelaxRules>& rules,
                Array<MadeSolver>& out) {
  for (layouts::Packing& packing :
       plan_blocks(sets, rules->settings.layout, common_rods(scene, rules->constants), layouts::lane_width<T>,
                   sizeof(T))) {
    MadeSolver& made = out.emplace_back();
    made.places.reserve(packing.slot_vertex.size());
    for (Slot slot = 0; slot < packing.slot_vertex.size(); ++slot)
      made.places.push_back({packing.slot_vertex[slot], slot});
    for (Slot lane = 0; lane < packing.lane_edge.size(); ++lane)
      if (packing.lane_edge[lane] != layouts::none) made.cords.push_back({packing.lane_edge[lane], lane});
    made.solver = std::make_unique<RelaxSolver<T>>(rules, scene, std::move(packing));
    if (rules->settings.tensions) made.solver->count_pulls();
  }
}

template <class T>
Array<MadeSolver> make_blocks(const Scene& scene, const IslandSets& sets,
                              const std::shared_ptr<RelaxRules>& rules) {
  require_representable<T>(scene, rules->settings.precision);
  Array<MadeSolver> out;
  for (const IslandSets& part : divided(scene, sets))
    if (!part.sets.empty()) add_blocks<T>(scene, part, rules, out);
  return out;
}

}  // namespace

Array<MadeSolver> make_relax_solvers(const Scene& scene, const IslandSets& sets, const Settings& settings,
                                     StartReport& report) {
  const auto rules = std::make_shared<RelaxRules>();
  rules->settings = settings;
  rules->verlet = {settings.gradient.value_or(Gradient::new_), scene.drag};
  rules->gravity = scene.gravity;
  rules->constants = make_constants(scene);
  rules->shared_rods = thresholds_of(settings.executor).rods;
  rules->initial_velocities.resize(scene.particles.size());
  std::size_t rods = 0;
  for (const auto& set : sets.sets)
    for (const std::uint32_t island : set) rods += sets.islands.edges(island).size();
  rules->relaxed_rods = std::max(report.relaxed_rods, static_cast<std::uint32_t>(rods));
  for (const auto& set : sets.sets)
    for (const std::uint32_t island : set)
      for (const std::uint32_t particle : sets.islands.vertices(island))
        if (!scene.particles[particle].fixed)
          rules->initial_velocities[particle] = scene.particles[particle].velocity;
  if (!report.goes_on)
    report.projected_velocity =
        std::max(report.projected_velocity,
                 project_velocities(rigid_part(scene, relaxed_rods(sets)), rules->constants.inverse_mass,
                                    rules->initial_velocities));
  if (settings.precision == Precision::single) return make_blocks<float>(scene, sets, rules);
  return make_blocks<double>(scene, sets, rules);
}

}  // namespace plumb::detail
