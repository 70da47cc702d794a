#include "contact/linkage_simulation.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "contact/group_stepper.hpp"
#include "contact/linkage_bounds.hpp"
#include "contact/spatial_hash.hpp"
#include "scene/refuse.hpp"
#include "step/scene_parts.hpp"
#include "step/state_hash.hpp"
#include "threads/workers.hpp"

namespace plumb::detail {
namespace {

/// Awake islands below which one thread is faster than the start of another.
constexpr std::size_t worth_threads = 16;

/// Where a particle is.
struct Home {
  std::uint32_t island = 0, particle = 0;
};

Surroundings surroundings_of(const Scene& scene) {
  Surroundings out{.planes = scene.planes, .boxes = {}};
  for (const Box& box : scene.boxes) {
    const auto [w, x, y, z] = box.orientation;
    const Frame3 frame{{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)},
                       {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)},
                       {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)}};
    const auto far = [&](double a, double b, double c) {
      return std::abs(a) * box.half_size.x + std::abs(b) * box.half_size.y + std::abs(c) * box.half_size.z;
    };
    const Vec3 most{far(frame.x.x, frame.y.x, frame.z.x), far(frame.x.y, frame.y.y, frame.z.y),
                    far(frame.x.z, frame.y.z, frame.z.z)};
    out.boxes.push_back(
        {box.center, box.half_size, frame, {box.center - most, box.center + most}, box.surface});
  }
  return out;
}

class LinkageSimulation final : public Simulation {
 public:
  LinkageSimulation(const Scene& scene, const Settings& settings)
      : surroundings_(surroundings_of(scene)),
        homes_(scene.particles.size()),
        pins_(scene.particles.size()),
        workers_(settings) {
    rules_.substeps = settings.substeps;
    rules_.sleep = settings.sleep;
    for (const Particle& particle : scene.particles) {
      fixed_.push_back(particle.fixed);
      anchors_.push_back(particle.position);
    }
    targets_ = anchors_;
    info_.isa = settings.isa.value_or(best_isa());
    make_islands(scene);
    start_hashes();
    info_.threads = workers_.size();
    info_.parallel = workers_.size() > 1 && islands_.size() >= worth_threads;
    steppers_.assign(workers_.size(), GroupStepper(info_.isa));
    reports_.resize(workers_.size());
    info_.particles = static_cast<std::uint32_t>(scene.particles.size());
    info_.rods = info_.direct_rods = static_cast<std::uint32_t>(scene.rods.size());
    info_.islands = static_cast<std::uint32_t>(islands_.size());
    info_.direct_gradient = Gradient::old;
    info_.linkages = static_cast<std::uint32_t>(linkages_.size());
    for (const auto& linkage : linkages_) describe(*linkage);
    info_.skipped_drag = scene.drag == 0;
    project_velocities(scene);
  }

  StepReport step(double dt) override {
    StepReport report;
    report.substeps = rules_.substeps;
    if (moving_) start_anchors(dt);
    if (!awake_.empty())
      workers_.lead(awake_.size() >= worth_threads, [&] {
        group_islands(dt);
        move_groups(dt, report);
        settle(report);
      });
    if (moving_) finish_anchors();
    report.awake_islands = static_cast<std::uint32_t>(awake_.size());
    return report;
  }

  void set_stop_rule(const StopRule&) override {}
  void set_weights(Weights) override {}
  void set_force(std::uint32_t particle, Vec3 force) override {
    LinkageState& island = islands_[homes_[particle].island];
    island.force[homes_[particle].particle] = force;
    island.energy.reset();
    wake(homes_[particle].island);
  }
  void move_anchor(std::uint32_t particle, Vec3 target) override {
    targets_[particle] = target;
    if (target == anchors_[particle]) return;
    moving_ = true;
    for (const Home& pin : pins_[particle]) wake(pin.island);
  }

  Vec3 position(std::uint32_t particle) const override {
    return fixed_[particle] ? anchors_[particle]
                            : islands_[homes_[particle].island].x[homes_[particle].particle];
  }
  Vec3 velocity(std::uint32_t particle) const override {
    return fixed_[particle] ? Vec3{} : islands_[homes_[particle].island].v[homes_[particle].particle];
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
    const SceneParts parts(scene);
    islands_.resize(parts.count());
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
        linkages_.push_back(std::make_unique<Linkage>(part, movable, info_.isa));
        kind = linkages_.back().get();
      }
      LinkageState& state = islands_[i];
      state.linkage = kind;
      state.number = i;
      state.particles = parts.particles(i);
      state.force.resize(movable);
      state.acceleration.resize(movable);
      for (std::uint32_t p = 0; p < part.particles.size(); ++p) {
        const Particle& particle = part.particles[p];
        state.x.push_back(particle.position);
        state.v.push_back(particle.fixed || asleep ? Vec3{} : particle.velocity);
        if (particle.fixed)
          pins_[state.particles[p]].push_back({i, p});
        else
          homes_[state.particles[p]] = {i, p};
      }
      state.asleep = asleep;
      if (!asleep) awake_.push_back(i);
    }
  }

  void describe(const Linkage& linkage) {
    BlockInfo block{.shape = "linkage", .layout = "aos"};
    for (const LinkageState& state : islands_) {
      if (state.linkage != &linkage) continue;
      ++block.islands;
      block.particles += linkage.particles();
      block.rods += linkage.rods();
      block.bytes += (2 * linkage.particles() + linkage.movable()) * sizeof(Vec3) +
                     linkage.plan().blocks() * sizeof(simd::Block);
    }
    info_.blocks.push_back(block);
  }

  /// Initial velocities that pull on rods are projected, once.
  void project_velocities(const Scene& scene) {
    for (const std::uint32_t i : awake_) {
      LinkageState& state = islands_[i];
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
        const Vec3 given = scene.particles[state.particles[k]].velocity;
        state.v[k] = linkage.taken(right, k);
        const double change = norm(state.v[k] - given);
        // Nothing to correct but rounding: as it was given, bit for bit.
        if (change <= 1e-12 * norm(given)) state.v[k] = given;
        info_.projected_velocity = std::max(info_.projected_velocity, change);
      }
    }
  }

  void start_hashes() {
    double sum = 0;
    for (const LinkageState& state : islands_) sum += state.linkage->size();
    const double cell = islands_.empty() ? 1 : 4 * sum / static_cast<double>(islands_.size());
    sleepers_.start(cell, 8 * islands_.size());
    walkers_cell_ = cell;
    marks_.assign(islands_.size(), 0);
    root_.resize(islands_.size());
    bounds_.resize(islands_.size());
    for (const LinkageState& state : islands_) {
      if (state.linkage->shapes().empty()) continue;
      any_shapes_ = true;
      if (!state.asleep) continue;
      bounds_[state.number] = reach(state, 0);
      sleepers_.insert(state.number, bounds_[state.number]);
    }
  }

  void wake(std::uint32_t i) {
    LinkageState& state = islands_[i];
    if (!state.asleep) return;
    state.asleep = false;
    state.calm = 0;
    awake_.insert(std::lower_bound(awake_.begin(), awake_.end(), i), i);
    if (state.linkage->shapes().empty()) return;
    sleepers_.remove(i, bounds_[i]);
    wake_neighbours(i);
  }

  /// Sleepers that may lie on it, or it on them.
  void wake_neighbours(std::uint32_t i) {
    std::vector<std::uint32_t> near;
    sleepers_.find(bounds_[i], [&](std::uint32_t j) {
      if (bounds_[i].overlaps(bounds_[j])) near.push_back(j);
    });
    for (const std::uint32_t j : near) wake(j);
  }

  std::uint32_t root(std::uint32_t i) {
    while (root_[i] != i) i = root_[i] = root_[root_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = root(a), b = root(b);
    if (a != b) root_[std::max(a, b)] = std::min(a, b);
  }

  /// Groups of islands that may touch within dt as they move now (reach()), by their numbers; sleepers nearby
  /// included.
  void group_islands(double dt) {
    members_ = awake_;
    for (const std::uint32_t i : awake_) root_[i] = i;
    if (any_shapes_ && islands_.size() > 1) {
      walkers_.start(walkers_cell_, 8 * awake_.size());
      ++mark_;
      workers_.team().for_each(static_cast<std::uint32_t>(awake_.size()), [&](std::uint32_t k, unsigned) {
        const LinkageState& state = islands_[awake_[k]];
        bounds_[state.number] = state.linkage->shapes().empty() ? nowhere : reach(state, dt);
      });
      for (const std::uint32_t i : awake_) {
        if (bounds_[i].is_empty()) continue;
        walkers_.find_and_insert(i, bounds_[i], [&](std::uint32_t j) {
          if (bounds_[i].overlaps(bounds_[j])) join(i, j);
        });
        if (sleepers_.is_empty()) continue;
        sleepers_.find(bounds_[i], [&](std::uint32_t j) {
          if (!bounds_[i].overlaps(bounds_[j])) return;
          if (marks_[j] != mark_) {
            marks_[j] = mark_;
            root_[j] = j;
            members_.push_back(j);
          }
          join(i, j);
        });
      }
    }
    // By group, and within a group by number.
    order_.clear();
    for (const std::uint32_t i : members_) order_.push_back(std::uint64_t{root(i)} << 32 | i);
    if (!std::is_sorted(order_.begin(), order_.end())) std::sort(order_.begin(), order_.end());
    group_.clear();
    starts_.clear();
    for (std::size_t k = 0; k < order_.size(); ++k) {
      if (k == 0 || order_[k] >> 32 != order_[k - 1] >> 32) starts_.push_back(static_cast<std::uint32_t>(k));
      group_.push_back(&islands_[order_[k] & 0xffffffff]);
    }
    starts_.push_back(static_cast<std::uint32_t>(group_.size()));
  }

  std::span<LinkageState* const> group(std::uint32_t g) const {
    return {group_.data() + starts_[g], starts_[g + 1] - starts_[g]};
  }

  void move_groups(double dt, StepReport& report) {
    const auto groups = static_cast<std::uint32_t>(starts_.size() - 1);
    rests_.resize(groups);
    for (StepReport& own : reports_) own = {};
    workers_.team().for_each(groups, [&](std::uint32_t g, unsigned part) {
      steppers_[part].step(group(g), surroundings_, rules_, dt, reports_[part]);
      rests_[g] = rests(group(g), dt);
    });
    for (const StepReport& own : reports_) report += own;
  }

  /// Whether a group has been slow for long enough to sleep, and something holds it: what nothing holds is
  /// only slow for a while.
  bool rests(std::span<LinkageState* const> group, double dt) const {
    bool calm = rules_.sleep, held = false;
    for (LinkageState* const state : group) {
      if (state->asleep) continue;
      const bool slow = top_speed(*state) < rules_.sleep_speed;
      state->calm = slow ? state->calm + dt : 0;
      held = held || state->linkage->is_grounded() || !state->kept.empty();
      calm = calm && state->calm >= rules_.sleep_time;
    }
    return calm && held;
  }

  /// Takes in those that were woken, and lets groups that rest sleep.
  void settle(StepReport& report) {
    // Those that sleepers' neighbours woke within the step are still listed as sleepers; in members_ they
    // follow the others. In a long step they may sleep again at once.
    for (std::size_t k = awake_.size(); k < members_.size(); ++k)
      if (const std::uint32_t i = members_[k]; !islands_[i].asleep) {
        sleepers_.remove(i, bounds_[i]);
        woken_.push_back(i);
      }
    awake_.insert(awake_.end(), woken_.begin(), woken_.end());
    if (!woken_.empty()) std::sort(awake_.begin(), awake_.end());
    for (std::uint32_t g = 0; g < rests_.size(); ++g) {
      if (rests_[g] == 0) continue;
      for (LinkageState* const state : group(g)) {
        if (state->asleep) continue;
        state->asleep = true;
        state->calm = 0;
        ++report.fell_asleep;
        if (state->linkage->shapes().empty()) continue;
        bounds_[state->number] = reach(*state, 0);
        sleepers_.insert(state->number, bounds_[state->number]);
      }
    }
    if (report.fell_asleep > 0) std::erase_if(awake_, [&](std::uint32_t i) { return islands_[i].asleep; });
    for (const std::uint32_t i : woken_)
      if (!islands_[i].asleep) wake_neighbours(i);
    woken_.clear();
  }

  void start_anchors(double dt) {
    for (std::uint32_t i = 0; i < fixed_.size(); ++i)
      for (const Home& pin : pins_[i])
        islands_[pin.island].v[pin.particle] = (1 / dt) * (targets_[i] - anchors_[i]);
  }
  /// At their targets exactly, without the rounding of the way.
  void finish_anchors() {
    for (std::uint32_t i = 0; i < fixed_.size(); ++i)
      for (const Home& pin : pins_[i]) {
        islands_[pin.island].x[pin.particle] = targets_[i];
        islands_[pin.island].v[pin.particle] = {};
        islands_[pin.island].factored = false;
      }
    anchors_ = targets_;
    moving_ = false;
  }

  Surroundings surroundings_;
  ContactRules rules_;
  WorldInfo info_;
  std::vector<std::unique_ptr<Linkage>> linkages_;
  std::vector<LinkageState> islands_;
  std::vector<Home> homes_;
  std::vector<std::vector<Home>> pins_;
  std::vector<std::uint8_t> fixed_;
  std::vector<Vec3> anchors_, targets_;
  bool moving_ = false;  ///< some anchor has a target of its own

  std::vector<std::uint32_t> awake_;  ///< ascending
  SpatialHash sleepers_, walkers_;
  bool any_shapes_ = false;
  double walkers_cell_ = 1;
  std::vector<Bounds> bounds_;  ///< by island: of sleepers as listed, of others this step's reach
  std::vector<std::uint32_t> marks_, root_, members_, starts_, woken_;
  std::uint32_t mark_ = 0;
  std::vector<std::uint64_t> order_;
  std::vector<LinkageState*> group_;
  std::vector<std::uint8_t> rests_;  ///< by group, after its step

  Workers workers_;
  std::vector<GroupStepper> steppers_;  ///< by part of the team
  std::vector<StepReport> reports_;     ///< likewise
};

}  // namespace

std::unique_ptr<Simulation> make_linkage_simulation(const Scene& scene, const Settings& settings) {
  if (settings.method != Method::automatic && settings.method != Method::direct)
    refuse(
        "method ", to_string(settings.method),
        " knows particles and rods alone; limbs that touch, bodies, joints and sleepers want direct or auto");
  const auto require = [](bool holds, const char* what) {
    if (!holds) refuse(what, " where limbs may touch");
  };
  require(!settings.accuracy, "accuracy cannot be asked for, substeps can,");
  require(settings.gradient.value_or(Gradient::old) == Gradient::old, "there is no gradient but old");
  require(settings.time_order == 2, "there is no time order but 2");
  require(settings.precision == Precision::double_, "there is no precision but double");
  require(mass_model_of(settings) == MassModel::consistent, "there is no mass but consistent");
  return std::make_unique<LinkageSimulation>(scene, settings);
}

}  // namespace plumb::detail
