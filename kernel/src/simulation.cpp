#include "simulation.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <tuple>

#include "compile.hpp"
#include "direct_simulation.hpp"
#include "plumb/measures.hpp"
#include "project_velocities.hpp"
#include "refuse.hpp"
#include "relax.hpp"
#include "sharing.hpp"

namespace plumb::detail {
namespace {

/// (1 - e^-z)/z, the mean of e^-t over [0, z].
double mean_decay(double z) {
  return z > 1e-8 ? -std::expm1(-z) / z : 1 - z / 2;
}

/// 1 for each rod of the commonest kind with equal masses at both ends.
std::vector<std::uint8_t> common_rods(const Scene& scene, const Constants& constants) {
  using Key = std::tuple<double, double, double>;
  const auto key = [&](std::size_t i) {
    return Key{constants.length2[i], constants.inverse_mass[scene.rods[i].a],
               constants.inverse_mass[scene.rods[i].b]};
  };
  std::map<Key, std::uint32_t> counts;
  for (std::size_t i = 0; i < scene.rods.size(); ++i) {
    const Key k = key(i);
    if (std::get<1>(k) == std::get<2>(k)) ++counts[k];
  }
  std::vector<std::uint8_t> common(scene.rods.size(), 0);
  if (counts.empty()) return common;
  const Key most = std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) {
                     return a.second < b.second;
                   })->first;
  for (std::size_t i = 0; i < scene.rods.size(); ++i) common[i] = key(i) == most;
  return common;
}

std::vector<Vec3> positions_of(const Scene& scene) {
  std::vector<Vec3> positions;
  for (const Particle& particle : scene.particles) positions.push_back(particle.position);
  return positions;
}

Constants make_constants(const Scene& scene) {
  Constants constants;
  for (std::size_t i = 0; i < scene.rods.size(); ++i) {
    const double length = rod_length(scene, i);
    constants.length2.push_back(length * length);
  }
  for (const double mass : lumped_masses(scene)) constants.inverse_mass.push_back(1 / mass);
  constants.valence.assign(scene.particles.size(), 0);
  for (const Rod& rod : scene.rods) {
    ++constants.valence[rod.a];
    ++constants.valence[rod.b];
  }
  return constants;
}

template <class T>
class SimulationOf final : public Simulation {
 public:
  SimulationOf(const Scene& scene, const Settings& settings)
      : settings_(settings),
        gradient_(gradient_of(settings)),
        gravity_(scene.gravity),
        drag_(scene.drag),
        constants_(make_constants(scene)),
        own_executor_(settings.executor || settings.threads == 1 ? nullptr
                                                                 : make_tbb_executor(settings.threads)),
        executor_(settings.executor ? settings.executor : own_executor_.get()),
        team_(executor_ ? (settings.threads ? settings.threads : executor_->concurrency()) : 1),
        kernels_(simd::kernels<T>(settings.isa.value_or(best_isa()))),
        initial_velocities_(scene.particles.size()) {
    for (std::size_t i = 0; i < scene.particles.size(); ++i)
      if (!scene.particles[i].fixed) initial_velocities_[i] = scene.particles[i].velocity;
    info_.projected_velocity = project_velocities(scene, constants_.inverse_mass, initial_velocities_);
    for (std::size_t i = 0; i < scene.particles.size(); ++i)
      if (!std::isfinite(static_cast<T>(norm(scene.particles[i].position))))
        refuse("particle ", i, ": position is too large for ", to_string(settings.precision));
    make_blocks(scene);
    fill_info(scene);
  }

  StepReport step(double dt) override {
    start_step(dt / settings_.substeps);
    RelaxCounters counters;
    team_.lead(uses_threads() ? executor_ : nullptr, [&] { run_blocks(counters); });
    // Substeps add up to the target but for rounding; an anchor stands exactly where it was sent.
    for (const Anchor& anchor : anchors_)
      for_places(anchor.particle,
                 [&](Block<T>& block, std::uint32_t slot) { block.write(block.x(), slot, anchor.target); });
    anchors_.clear();
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

  void set_stop_rule(const StopRule& rule) override {
    settings_.stop = rule;
    info_.parallel = uses_threads();
  }

  void set_weights(Weights weights) override {
    settings_.weights = weights;
    for (auto& block : blocks_) block.set_weights(constants_, weights, settings_.order, settings_.omega);
    count_uniform();
  }

  void set_force(std::uint32_t particle, Vec3 force) override {
    if (forces_.empty()) forces_.resize(constants_.inverse_mass.size());
    // A displacement is the velocity half a substep ago, under the old force; mid's is the velocity now.
    const Vec3 change = (h_ * h_ * constants_.inverse_mass[particle]) * (force - forces_[particle]);
    forces_[particle] = force;
    if (time_advanced_ && gradient_ != Gradient::mid)
      for_places(particle, [&](Block<T>& block, std::uint32_t slot) {
        if (block.is_frozen(slot)) return;
        block.write(block.displacement(0), slot, block.read(block.displacement(0), slot) - 0.5 * change);
        block.write(block.displacement(1), slot, block.read(block.displacement(1), slot) - 1.5 * change);
      });
    kicks_stale_ = true;
  }

  void move_anchor(std::uint32_t particle, Vec3 target) override {
    for (auto& [anchor, old] : anchors_)
      if (anchor == particle) {
        old = target;
        return;
      }
    anchors_.push_back({particle, target});
  }

  Vec3 position(std::uint32_t particle) const override {
    const Place place = places_[first_place_[particle]];
    const Block<T>& block = blocks_[place.block];
    return block.read(block.x(), place.slot);
  }

  Vec3 velocity(std::uint32_t particle) const override {
    if (!time_advanced_) return initial_velocities_[particle];
    const Place place = places_[first_place_[particle]];
    const Block<T>& block = blocks_[place.block];
    const Vec3 last = block.read(block.displacement(0), place.slot);
    if (gradient_ == Gradient::mid) return (1 / h_) * last;
    // Displacements are mean velocities of substeps; extrapolated by half a substep they are second order
    // accurate.
    const Vec3 before = block.read(block.displacement(1), place.slot);
    return (0.5 / h_) * (3 * last - before);
  }

  std::uint64_t state_hash() const override {
    using Bits = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;
    std::uint64_t hash = 0xcbf29ce484222325;  // FNV-1a, over the bits of every number in the scene's order
    const auto add = [&](double value) {
      const auto bits = std::bit_cast<Bits>(static_cast<T>(value));
      for (unsigned byte = 0; byte < sizeof bits; ++byte)
        hash = (hash ^ ((bits >> (8 * byte)) & 0xff)) * 0x100000001b3;
    };
    for (const std::uint32_t first : first_place_) {
      const Place place = places_[first];
      const Block<T>& block = blocks_[place.block];
      for (const T* field : {block.x(), block.displacement(0)}) {
        const Vec3 v = block.read(field, place.slot);
        add(v.x);
        add(v.y);
        add(v.z);
      }
    }
    return hash;
  }

  const WorldInfo& info() const override { return info_; }

 private:
  /// Where a particle is. A fixed particle has a place in every island that hangs from it; the first is read.
  struct Place {
    std::uint32_t block;
    std::uint32_t slot;
  };
  struct Anchor {
    std::uint32_t particle;
    Vec3 target;
  };

  // --- Compiling

  void make_blocks(const Scene& scene) {
    std::vector<layouts::Edge> edges;
    for (const Rod& rod : scene.rods) edges.push_back({rod.a, rod.b});
    std::vector<std::uint8_t> movable;
    for (const Particle& particle : scene.particles) movable.push_back(!particle.fixed);
    const layouts::Graph graph{static_cast<std::uint32_t>(movable.size()), edges, movable};
    Plan plan = plan_blocks(graph, settings_.layout, common_rods(scene, constants_), layouts::lane_width<T>,
                            sizeof(T));
    info_.islands = plan.islands;
    for (auto& packing : plan.packings) {
      Block<T>& block = blocks_.emplace_back(std::move(packing), settings_.order == SweepOrder::jacobi);
      block.set_weights(constants_, settings_.weights, settings_.order, settings_.omega);
      const auto& vertices = block.packing().slot_vertex;
      for (std::uint32_t slot = 0; slot < vertices.size(); ++slot)
        block.write(block.x(), slot, scene.particles[vertices[slot]].position);
    }
    starts_off_length_ = measure_stretch(scene, positions_of(scene)).max > 1e-9;
    index_places(scene.particles.size());
    sort_work();
  }

  void index_places(std::size_t particles) {
    first_place_.assign(particles + 1, 0);
    for (const auto& block : blocks_)
      for (const std::uint32_t vertex : block.packing().slot_vertex) ++first_place_[vertex + std::size_t{1}];
    for (std::size_t i = 0; i < particles; ++i) first_place_[i + 1] += first_place_[i];
    places_.resize(first_place_.back());
    std::vector<std::uint32_t> next(first_place_.begin(), first_place_.end() - 1);
    for (std::uint32_t b = 0; b < blocks_.size(); ++b) {
      const auto& packing = blocks_[b].packing();
      for (std::uint32_t slot = 0; slot < packing.slot_vertex.size(); ++slot)
        places_[next[packing.slot_vertex[slot]]++] = {b, slot};
    }
    place_end_ = {first_place_.begin() + 1, first_place_.end()};
    first_place_.pop_back();
  }

  /// Splits the work into pieces that one thread does alone and blocks that all threads share.
  void sort_work() {
    for (std::uint32_t b = 0; b < blocks_.size(); ++b) {
      const auto& packing = blocks_[b].packing();
      if (packing.coupling == layouts::Coupling::independent) {
        for (std::uint32_t q = 0; q < packing.positions; ++q) lone_work_.push_back({b, q});
      } else if (blocks_[b].rods() >= thresholds_.rods) {
        shared_work_.push_back(b);
      } else {
        lone_work_.push_back({b, layouts::none});
      }
    }
  }

  void fill_info(const Scene& scene) {
    info_.particles = static_cast<std::uint32_t>(scene.particles.size());
    info_.rods = static_cast<std::uint32_t>(scene.rods.size());
    info_.isa = settings_.isa.value_or(best_isa());
    info_.threads = team_.size();
    info_.parallel = uses_threads();
    info_.skipped_drag = drag_ == 0;
    count_uniform();
  }

  void count_uniform() {
    info_.skipped_per_rod_weights = 0;
    info_.blocks.clear();
    for (const auto& block : blocks_) {
      info_.skipped_per_rod_weights += block.uniform_rods();
      add_block_info(block);
    }
  }

  void add_block_info(const Block<T>& block) {
    const auto& packing = block.packing();
    constexpr const char* layout_names[] = {"aos", "soa", "aosoa"};
    BlockInfo info;
    info.shape = packing.shape;
    info.layout = layout_names[static_cast<int>(packing.layout)];
    auto islands = packing.slot_island;
    std::sort(islands.begin(), islands.end());
    info.islands = static_cast<std::uint32_t>(std::unique(islands.begin(), islands.end()) - islands.begin());
    if (info.islands > 0 && *(islands.begin() + info.islands - 1) == layouts::none)
      --info.islands;  // loose fixed
    info.particles = static_cast<std::uint32_t>(
        std::count(packing.slot_duplicate.begin(), packing.slot_duplicate.end(), std::uint8_t{0}));
    info.rods = block.rods();
    info.colors = packing.colors;
    info.bytes = block.bytes();
    info.uniform_fraction = block.uniform_rods() / std::max(1.0, double{1} * info.rods);
    // Two ends read and written, the rod's vector and violation read, weights where rods differ, addresses.
    const double end_numbers = packing.access == layouts::Access::records ? 16 : 12;
    const double numbers = end_numbers + simd::rod_fields + 3 * (1 - info.uniform_fraction);
    const double rods_per_address = packing.access == layouts::Access::rows ? packing.lanes : 1;
    info.bytes_per_projection = numbers * sizeof(T) + 2 * sizeof(std::uint32_t) / rods_per_address;
    for (BlockInfo& known : info_.blocks) {
      if (known.shape != info.shape || known.layout != info.layout || known.colors != info.colors) continue;
      const double rods = std::max(1.0, double{1} * known.rods + info.rods);
      known.uniform_fraction =
          (known.uniform_fraction * known.rods + info.uniform_fraction * info.rods) / rods;
      known.islands += info.islands;
      known.particles += info.particles;
      known.rods += info.rods;
      known.bytes += info.bytes;
      return;
    }
    info_.blocks.push_back(std::move(info));
  }

  // --- Stepping

  double projections_per_step() const {
    return double{1} * constants_.length2.size() * settings_.stop.sweeps * settings_.substeps;
  }

  bool uses_threads() const { return team_.size() > 1 && projections_per_step() >= thresholds_.projections; }

  bool is_movable(std::uint32_t particle) const { return constants_.inverse_mass[particle] > 0; }

  Vec3 acceleration(std::uint32_t particle) const {
    if (!is_movable(particle)) return {};
    return forces_.empty() ? gravity_ : gravity_ + constants_.inverse_mass[particle] * forces_[particle];
  }

  template <class F>
  void for_slots(F&& f) {
    for (auto& block : blocks_) {
      const auto& vertices = block.packing().slot_vertex;
      for (std::uint32_t slot = 0; slot < vertices.size(); ++slot)
        if (!block.is_frozen(slot)) f(block, slot, vertices[slot]);
    }
  }
  template <class F>
  void for_places(std::uint32_t particle, F&& f) {
    for (std::uint32_t i = first_place_[particle]; i < place_end_[particle]; ++i)
      f(blocks_[places_[i].block], places_[i].slot);
  }

  void start_step(double h) {
    const bool first = !time_advanced_;
    if (first || h != h_) {
      for_slots([&](Block<T>& block, std::uint32_t slot, std::uint32_t particle) {
        if (is_movable(particle)) start_displacement(block, slot, particle, h, first);
      });
      kicks_stale_ = true;
      h_ = h;
    }
    if (kicks_stale_) {
      for_slots([&](Block<T>& block, std::uint32_t slot, std::uint32_t particle) {
        block.write(block.kick(), slot, kick(particle));
      });
      kicks_stale_ = false;
    }
    for (auto& block : blocks_) {
      block.release_anchors();
      if (first && starts_off_length_) block.settle();
    }
    for (const Anchor& anchor : anchors_)
      for_places(anchor.particle, [&](Block<T>& block, std::uint32_t slot) {
        block.move_anchor(slot, (1.0 / settings_.substeps) * (anchor.target - block.read(block.x(), slot)));
      });
  }

  /// The constant part of a prediction: what force and gravity add to a displacement in a substep, with drag
  /// exact for constant forces. Verlet (thesis eq. 3.6, 4.5) adds a h^2; gradient mid, whose displacements
  /// are velocities times h, adds half of it.
  Vec3 kick(std::uint32_t particle) const {
    const double factor = gradient_ == Gradient::mid ? 0.5 : mean_decay(drag_ * h_);
    return factor * h_ * h_ * acceleration(particle);
  }

  /// c h. What is left of a velocity after e^-50 is nothing; more would overflow the start's e^(c h).
  double drag_exponent(double h) const { return std::min(drag_ * h, 50.0); }

  double decay() const { return std::exp(-drag_exponent(h_) * (gradient_ == Gradient::mid ? 0.5 : 1)); }

  /// The displacement before the first substep that makes it x + v h + a h^2 / 2 (with drag, the exact
  /// solution), or, when h changes, the one that keeps the velocity to second order.
  void start_displacement(Block<T>& block, std::uint32_t slot, std::uint32_t particle, double h, bool first) {
    T* const last = block.displacement(0);
    T* const before = block.displacement(1);
    if (gradient_ == Gradient::mid) {
      const Vec3 v = first ? initial_velocities_[particle] : (1 / h_) * block.read(last, slot);
      return block.write(last, slot, h * v);
    }
    if (!first) {
      // A displacement is the velocity half a substep ago. Force, gravity and drag take it to where it would
      // be with the new h; rods must not, they act anew in the next solve (extrapolating them too would be
      // first order).
      const Vec3 mean = (1 / h_) * block.read(last, slot);
      const Vec3 a = acceleration(particle) - drag_ * mean;
      return block.write(last, slot, h * mean + (0.5 * h * (h_ - h)) * a);
    }
    const double z = drag_ * h;
    const Vec3 v = initial_velocities_[particle], a = acceleration(particle);
    // First displacement of the exact solution of v' = a - c v, then Verlet's prediction solved for its
    // input.
    const double phi = mean_decay(z);
    const double psi = z > 1e-4 ? (1 - phi) / z : 0.5 - z / 6;
    const Vec3 first_step = (h * phi) * v + (h * h * psi) * a;
    const Vec3 u = std::exp(drag_exponent(h)) * (first_step - (phi * h * h) * a);
    block.write(last, slot, u);
    block.write(before, slot, u - (h * h) * a);
  }

  void run_blocks(RelaxCounters& counters) {
    RelaxSettings<T> relax{
        &kernels_, gradient_, settings_.order, settings_.stop, settings_.substeps, static_cast<T>(decay()),
        0};
    const double budget = settings_.stop.budget_us.value_or(0) / settings_.substeps;
    const double rods = std::max<double>(1, static_cast<double>(constants_.length2.size()));
    for (const std::uint32_t b : shared_work_) {
      relax.budget_us = budget * blocks_[b].rods() / rods;
      for (std::uint32_t substep = 0; substep < settings_.substeps; ++substep)
        relax_block(blocks_[b], relax, counters, team_);
    }
    team_.for_each(static_cast<std::uint32_t>(lone_work_.size()), [&](std::uint32_t i) {
      const auto [b, q] = lone_work_[i];
      Block<T>& block = blocks_[b];
      const std::uint32_t begin = q == layouts::none ? 0 : q;
      const std::uint32_t end = q == layouts::none ? block.packing().positions : q + 1;
      RelaxSettings<T> mine = relax;
      mine.budget_us = budget * team_.parts() * block.rods(begin, end) / rods;
      relax_alone(block, begin, end, mine, counters);
    });
    if (settings_.substeps % 2 == 1)
      for (std::uint32_t b = 0; b < blocks_.size(); ++b)
        if (!std::binary_search(shared_work_.begin(), shared_work_.end(), b)) blocks_[b].swap_displacements();
  }

  Settings settings_;
  Gradient gradient_;
  SharingThresholds thresholds_ = sharing_thresholds;
  Vec3 gravity_;
  double drag_;
  Constants constants_;
  std::unique_ptr<Executor> own_executor_;
  Executor* executor_;
  Team team_;
  const simd::Kernels<T>& kernels_;
  std::vector<Vec3> initial_velocities_;

  std::vector<Block<T>> blocks_;
  std::vector<Place> places_;
  std::vector<std::uint32_t> first_place_, place_end_;  ///< per particle, into places_
  struct LoneWork {
    std::uint32_t block;
    std::uint32_t position;  ///< none: the whole block
  };
  std::vector<LoneWork> lone_work_;
  std::vector<std::uint32_t> shared_work_;

  double h_ = 0;
  bool starts_off_length_ = false;
  bool time_advanced_ = false;
  bool kicks_stale_ = true;
  std::vector<Vec3> forces_;
  std::vector<Anchor> anchors_;
  WorldInfo info_;
};

}  // namespace

std::unique_ptr<Simulation> make_simulation(const Scene& scene, const Settings& settings) {
  if (settings.isa && !is_supported(*settings.isa))
    refuse("instruction set ", to_string(*settings.isa), " is not supported by this machine");
  if (settings.method == Method::direct) return make_direct_simulation(scene, settings);
  if (settings.precision == Precision::single) return std::make_unique<SimulationOf<float>>(scene, settings);
  return std::make_unique<SimulationOf<double>>(scene, settings);
}

}  // namespace plumb::detail
