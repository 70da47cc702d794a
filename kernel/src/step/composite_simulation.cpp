#include "step/composite_simulation.hpp"

#include <algorithm>
#include <vector>

#include "direct/direct_simulation.hpp"
#include "plumb/layouts/islands.hpp"
#include "plumb/layouts/trees.hpp"
#include "scene/scene_graph.hpp"
#include "step/choose_method.hpp"

namespace plumb::detail {
namespace {

/// What moves an island.
struct Kind {
  Method method = Method::relax;
  // Of method direct:
  Gradient gradient = Gradient::new_;
  std::uint32_t time_order = 2;

  bool operator==(const Kind&) const = default;
};

/// A scene of its own for the islands that are moved alike.
struct Part {
  Kind kind;
  Scene scene;
  std::vector<std::uint32_t> particles;  ///< the whole scene's numbers, by the part's
  std::unique_ptr<Simulation> simulation;
};

/// Where a particle is: in one part if it is movable, in every part that hangs from it if it is fixed.
struct Home {
  std::uint32_t part, particle;
};

std::unique_ptr<Simulation> simulate(const Scene& scene, Kind kind, const Settings& settings) {
  Settings own = settings;
  own.method = kind.method;
  if (kind.method == Method::relax) {
    own.mass.reset();
    return make_simulation(scene, own);
  }
  own.gradient = kind.gradient;
  own.time_order = kind.time_order;
  const bool changes_gradient =
      settings.accuracy && !settings.gradient && kind.gradient == Gradient::old && kind.time_order == 2;
  return make_direct_simulation(scene, own, changes_gradient);
}

class CompositeSimulation final : public Simulation {
 public:
  CompositeSimulation(const Scene& scene, std::vector<Part> parts, const Settings& settings)
      : parts_(std::move(parts)), homes_(scene.particles.size()) {
    for (std::uint32_t p = 0; p < parts_.size(); ++p) {
      Part& part = parts_[p];
      for (std::uint32_t i = 0; i < part.particles.size(); ++i) homes_[part.particles[i]].push_back({p, i});
      part.simulation = simulate(part.scene, part.kind, settings);
      part.scene = {};
    }
    gather_info(scene);
  }

  StepReport step(double dt) override {
    StepReport report;
    for (Part& part : parts_) {
      const std::uint64_t before = report.substeps;
      report += part.simulation->step(dt);
      report.substeps = std::max(before, report.substeps - before);
    }
    return report;
  }

  void set_stop_rule(const StopRule& rule) override {
    for (Part& part : parts_) part.simulation->set_stop_rule(rule);
  }
  void set_weights(Weights weights) override {
    for (Part& part : parts_) part.simulation->set_weights(weights);
  }
  void set_force(std::uint32_t particle, Vec3 force) override {
    const Home home = homes_[particle].front();
    parts_[home.part].simulation->set_force(home.particle, force);
  }
  void move_anchor(std::uint32_t particle, Vec3 target) override {
    for (const Home home : homes_[particle]) parts_[home.part].simulation->move_anchor(home.particle, target);
  }
  Vec3 position(std::uint32_t particle) const override {
    const Home home = homes_[particle].front();
    return parts_[home.part].simulation->position(home.particle);
  }
  Vec3 velocity(std::uint32_t particle) const override {
    const Home home = homes_[particle].front();
    return parts_[home.part].simulation->velocity(home.particle);
  }
  std::uint64_t state_hash() const override {
    std::uint64_t hash = 0xcbf29ce484222325;
    for (const Part& part : parts_) hash = (hash ^ part.simulation->state_hash()) * 0x100000001b3;
    return hash;
  }
  const WorldInfo& info() const override { return info_; }

 private:
  void gather_info(const Scene& scene) {
    for (const Part& part : parts_) {
      const WorldInfo& own = part.simulation->info();
      info_.islands += own.islands;
      info_.isa = own.isa;
      info_.threads = own.threads;
      info_.parallel = info_.parallel || own.parallel;
      info_.relaxed_rods += own.relaxed_rods;
      info_.direct_rods += own.direct_rods;
      if (part.kind.method == Method::direct && info_.direct_rods == own.direct_rods) {  // the first such
        info_.direct_gradient = own.direct_gradient;
        info_.direct_time_order = own.direct_time_order;
        info_.changes_gradient = own.changes_gradient;
      }
      info_.skipped_per_rod_weights += own.skipped_per_rod_weights;
      info_.skipped_drag = own.skipped_drag;
      info_.projected_velocity = std::max(info_.projected_velocity, own.projected_velocity);
      info_.projected_position = std::max(info_.projected_position, own.projected_position);
      info_.unprojected_islands += own.unprojected_islands;
      info_.blocks.insert(info_.blocks.end(), own.blocks.begin(), own.blocks.end());
    }
    info_.particles = static_cast<std::uint32_t>(scene.particles.size());
    info_.rods = static_cast<std::uint32_t>(scene.rods.size());
  }

  std::vector<Part> parts_;
  std::vector<std::vector<Home>> homes_;
  WorldInfo info_;
};

/// The islands of a scene by what moves them. Fixed particles that hold nothing go to the first part.
std::vector<Part> split(const Scene& scene, const Settings& settings) {
  const SceneGraph owner(scene);
  const layouts::Graph graph = owner.view();
  const layouts::Islands islands = layouts::find_islands(graph);

  struct Members {
    Kind kind;
    std::vector<std::uint8_t> has_particle, has_rod;
  };
  std::vector<Members> kinds;
  const auto members_of = [&](const Kind& kind) -> Members& {
    const auto found = std::find_if(kinds.begin(), kinds.end(),
                                    [&](const Members& members) { return members.kind == kind; });
    if (found != kinds.end()) return *found;
    return kinds.emplace_back(Members{kind, std::vector<std::uint8_t>(scene.particles.size()),
                                      std::vector<std::uint8_t>(scene.rods.size())});
  };
  std::vector<std::uint8_t> placed(scene.particles.size(), 0);
  for (const auto& equal : layouts::group_equal_islands(graph, islands)) {
    const layouts::LocalGraph local = layouts::local_graph(graph, islands, equal.front());
    const bool is_tree = layouts::find_tree(local.view()).has_value();
    const bool shape_is_for_direct = is_tree || is_thin(local.view());
    for (const std::uint32_t island : equal) {
      const auto rods = islands.edges(island);
      Kind kind{.method = choose_method(scene, shape_is_for_direct, rods, settings)};
      if (kind.method == Method::direct) {
        kind.gradient = choose_gradient(scene, is_tree, rods, settings);
        kind.time_order = choose_time_order(kind.gradient, is_tree, rods.size(), settings);
      }
      Members& members = members_of(kind);
      for (const std::uint32_t v : islands.vertices(island)) members.has_particle[v] = placed[v] = 1;
      for (const std::uint32_t e : rods) members.has_rod[e] = 1;
    }
  }
  if (kinds.empty()) members_of({.method = Method::direct, .gradient = Gradient::old});
  for (std::size_t v = 0; v < placed.size(); ++v)
    if (!placed[v]) kinds.front().has_particle[v] = 1;

  std::vector<Part> parts;
  std::vector<std::uint32_t> number(scene.particles.size());
  for (const auto& [kind, has_particle, has_rod] : kinds) {
    Part part;
    part.kind = kind;
    for (std::uint32_t v = 0; v < number.size(); ++v) {
      if (!has_particle[v]) continue;
      number[v] = static_cast<std::uint32_t>(part.particles.size());
      part.particles.push_back(v);
      part.scene.particles.push_back(scene.particles[v]);
    }
    if (part.particles.empty()) continue;
    for (std::size_t e = 0; e < scene.rods.size(); ++e) {
      if (!has_rod[e]) continue;
      Rod rod = scene.rods[e];
      rod.a = number[rod.a];
      rod.b = number[rod.b];
      part.scene.rods.push_back(rod);
    }
    part.scene.gravity = scene.gravity;
    part.scene.drag = scene.drag;
    parts.push_back(std::move(part));
  }
  return parts;
}

}  // namespace

std::unique_ptr<Simulation> make_composite_simulation(const Scene& scene, const Settings& settings) {
  std::vector<Part> parts = split(scene, settings);
  if (parts.size() == 1 && parts.front().kind.method == Method::direct)
    return simulate(scene, parts.front().kind, settings);
  return std::make_unique<CompositeSimulation>(scene, std::move(parts), settings);
}

}  // namespace plumb::detail
