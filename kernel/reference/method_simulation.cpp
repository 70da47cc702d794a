#include "reference/method_simulation.hpp"

#include <algorithm>
#include <unordered_map>
#include <utility>

#include "plumb/layouts/islands.hpp"
#include "plumb/measures.hpp"
#include "reference/mechanical_system.hpp"
#include "reference/springs/springs.hpp"
#include "scene/project_velocities.hpp"
#include "scene/scene_graph.hpp"
#include "step/state_hash.hpp"
#include "threads/flush_denormals.hpp"

namespace plumb::detail {
namespace {

/// One island: its equations, its state, and the last state that was finite.
struct Island {
  std::unique_ptr<MechanicalSystem> system;
  MechanicalState state, last;
  Drive drive;
  std::vector<std::uint32_t> particles;  ///< The scene's number of each of the island's particles.
  bool frozen = false;
};

/// The island that holds a movable particle, and the particle's number there.
struct Home {
  std::uint32_t island = 0, particle = 0;
};

class MethodSimulation final : public Simulation {
 public:
  MethodSimulation(const Scene& scene, const Settings& settings)
      : settings_(settings), homes_(scene.particles.size()), pins_(scene.particles.size()) {
    for (const Particle& particle : scene.particles) {
      fixed_.push_back(particle.fixed);
      anchors_.push_back(particle.position);
    }
    targets_ = anchors_;
    diagonal_ = bounding_diagonal(scene);
    make_islands(scene);
    for (std::uint32_t i = 0; i < scene.particles.size(); ++i)
      if (!fixed_[i])
        info_.projected_velocity =
            std::max(info_.projected_velocity, norm(velocity(i) - scene.particles[i].velocity));
  }

  StepReport step(double dt) override {
    const FlushDenormals flush;
    StepReport report;
    report.substeps = settings_.substeps;
    start_anchors(dt);
    for (Island& island : islands_) {
      if (island.frozen) continue;
      island.last = island.state;
      for (std::uint32_t i = 0; i < settings_.substeps; ++i) {
        const double h = dt / settings_.substeps;
        island.system->advance(island.state, island.drive, h);
        for (std::size_t p = 0; p < island.particles.size(); ++p)
          island.drive.anchors[p] = island.drive.anchor(static_cast<std::uint32_t>(p), h);
      }
      if (island.state.finite()) {
        island.system->report(island.state, island.drive, report);
        island.system->place(island.state, island.drive);
        continue;
      }
      std::swap(island.state, island.last);
      island.frozen = true;
      ++report.frozen_islands;
    }
    finish_anchors();
    return report;
  }

  void set_stop_rule(const StopRule&) override {}
  void set_weights(Weights) override {}
  void set_force(std::uint32_t particle, Vec3 force) override {
    islands_[homes_[particle].island].drive.forces[homes_[particle].particle] = force;
  }
  void move_anchor(std::uint32_t particle, Vec3 target) override { targets_[particle] = target; }

  Vec3 position(std::uint32_t particle) const override {
    if (fixed_[particle]) return anchors_[particle];
    const Island& island = islands_[homes_[particle].island];
    return island.system->position(island.state, homes_[particle].particle);
  }
  Vec3 velocity(std::uint32_t particle) const override {
    if (fixed_[particle]) return {};
    const Island& island = islands_[homes_[particle].island];
    return island.frozen ? Vec3{} : island.system->velocity(island.state, homes_[particle].particle);
  }
  std::uint64_t state_hash() const override {
    StateHash hash;
    for (std::uint32_t i = 0; i < fixed_.size(); ++i) {
      hash.add<double>(position(i));
      hash.add<double>(velocity(i));
    }
    return hash.value();
  }
  const WorldInfo& info() const override { return info_; }

 private:
  void make_islands(const Scene& scene) {
    const SceneGraph owner(scene);
    const layouts::Graph graph = owner.view();
    const layouts::Islands islands = layouts::find_islands(graph);
    info_.particles = static_cast<std::uint32_t>(scene.particles.size());
    info_.rods = static_cast<std::uint32_t>(scene.rods.size());
    info_.islands = islands.count();
    info_.skipped_drag = scene.drag == 0;
    islands_.reserve(islands.count());
    for (std::uint32_t i = 0; i < islands.count(); ++i) add_island(scene, graph, islands, i);
  }

  void add_island(const Scene& scene, const layouts::Graph& graph, const layouts::Islands& islands,
                  std::uint32_t i) {
    const layouts::LocalGraph local = layouts::local_graph(graph, islands, i);
    Island& island = islands_.emplace_back();
    const auto vertices = islands.vertices(i);
    island.particles.assign(vertices.begin(), vertices.end());
    Scene own;
    own.gravity = scene.gravity;
    own.drag = scene.drag;
    for (std::uint32_t p = 0; p < vertices.size(); ++p) {
      const std::uint32_t particle = vertices[p];
      own.particles.push_back(scene.particles[particle]);
      if (fixed_[particle])
        pins_[particle].push_back({i, p});
      else
        homes_[particle] = {i, p};
    }
    const auto edges = islands.edges(i);
    for (std::size_t r = 0; r < edges.size(); ++r) {
      Rod rod = scene.rods[edges[r]];
      rod.length = rod_length(scene, edges[r]);
      rod.a = local.edges[r].a;
      rod.b = local.edges[r].b;
      own.rods.push_back(rod);
    }
    island.drive.forces.resize(vertices.size());
    island.drive.anchor_velocities.resize(vertices.size());
    island.drive.scene_diagonal = diagonal_;
    for (const Particle& particle : own.particles) island.drive.anchors.push_back(particle.position);
    island.system = make_system(own, settings_, {vertices, edges});
    island.state = island.system->initial_state(island.drive);
    island.system->place(island.state, island.drive);
  }

  /// Gives fixed particles the velocity that takes them to their targets in `dt`.
  void start_anchors(double dt) {
    for (std::uint32_t i = 0; i < fixed_.size(); ++i)
      for (const Home& pin : pins_[i])
        islands_[pin.island].drive.anchor_velocities[pin.particle] = (1 / dt) * (targets_[i] - anchors_[i]);
  }
  /// Puts anchors at their targets exactly, without the rounding that their way accumulated.
  void finish_anchors() {
    for (std::uint32_t i = 0; i < fixed_.size(); ++i)
      for (const Home& pin : pins_[i]) islands_[pin.island].drive.anchors[pin.particle] = targets_[i];
    anchors_ = targets_;
  }

  Settings settings_;
  double diagonal_ = 0;  ///< Diagonal of the scene, in m.
  WorldInfo info_;
  std::vector<Island> islands_;
  std::vector<Home> homes_;
  std::vector<std::vector<Home>> pins_;  ///< Places of each anchor, in every island that hangs from it.
  std::vector<std::uint8_t> fixed_;
  std::vector<Vec3> anchors_, targets_;  ///< Of anchors, by the scene's numbers, in m.
};

}  // namespace

std::unique_ptr<Simulation> make_method_simulation(const Scene& scene, const Settings& settings) {
  if (settings.method == Method::springs) require_spring_bodies(scene, settings);
  return std::make_unique<MethodSimulation>(scene, settings);
}

}  // namespace plumb::detail
