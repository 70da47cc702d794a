#include "direct/direct_simulation.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>

#include "direct/loops/loop_group.hpp"
#include "direct/trees/tree_stepper.hpp"
#include "plumb/layouts/islands.hpp"
#include "plumb/layouts/trees.hpp"
#include "scene/scene_graph.hpp"
#include "step/state_hash.hpp"
#include "threads/workers.hpp"
#include "time/accuracy_control.hpp"

namespace plumb::detail {
namespace {

using layouts::lane_width;

/// Relative to the velocity of an anchor: below, it differs by the rounding of its path only.
constexpr double unchanged = 1e-9;
/// Of a step: in float, displacements of shorter ones are rounding.
template <class T>
constexpr std::uint32_t most_substeps = sizeof(T) == 4 ? 1 << 8 : 1 << 20;

/// s, of the step that brings rods to their lengths: without velocities yet, and too short for loads to act.
constexpr double projection_step = 1e-9;
/// Of a rod's length: rods that start off it by less do so by the rounding of their coordinates.
constexpr double least_gap = 1e-9;

/// A tree is calm once gradient mid would need no more substeps than a step has at least: if so many steps in
/// turn it would make this share of the error allowed. Found on chains with end masses of 1 to 10,000, at
/// rest, swinging and whipping, and trees of rods with mass.
constexpr double calm_rate = 0.3;
constexpr int calm_after = 2;
/// Fewer substeps of old than this are no dearer than one of mid, on lines and on other trees.
constexpr std::uint32_t dear_on_lines = 4, dear_on_trees = 2;

/// Stretch that nets solved by their lines may keep where an accuracy is asked for: so much of it, and in the
/// order of what float leaves at most. The next substep takes it back: even 1e-5 changes a net of 128 x 128
/// after 0.5 s by no more than 2e-9 of its diagonal. A substep of another length makes a velocity of it,
/// which more than this share shows as error the more the shorter substeps are.
constexpr double stretch_of_accuracy = 0.01, most_stretch = 1e-6;

double line_tolerance(const Settings& settings) {
  if (!settings.accuracy) return settings.stop.tolerance.value_or(0);
  return std::min({stretch_of_accuracy * *settings.accuracy, most_stretch,
                   settings.stop.tolerance.value_or(most_stretch)});
}

template <class T>
class DirectSimulation final : public Simulation {
 public:
  DirectSimulation(const Scene& scene, const Settings& settings, bool changes_gradient)
      : settings_(settings),
        isa_(settings.isa.value_or(best_isa())),
        workers_(settings),
        counters_(workers_.size()),
        stepper_(gradient_of(settings), scene.drag, estimates(), isa_, settings.time_order),
        loops_(scene, gradient_of(settings), isa_, estimates(), settings.time_order),
        diagonal_(bounding_diagonal(scene)),
        places_(scene.particles.size()) {
    if (changes_gradient) calm_stepper_.emplace(Gradient::mid, scene.drag, true, isa_);
    for (const Particle& particle : scene.particles) {
      fixed_.push_back(particle.fixed);
      fixed_position_.push_back(particle.position);
    }
    pins_of_.resize(scene.particles.size());
    anchor_of_.assign(scene.particles.size(), no_anchor);
    make_groups(scene);
    loops_.set_line_tolerance(line_tolerance(settings));
    fill_info(scene);
    project_initial_positions(scene);  // before there are velocities
    set_initial_velocities(scene);
  }

  StepReport step(double dt) override {
    start_anchors(dt);
    workers_.lead(uses_threads(), [&] {
      std::atomic<std::size_t> next{0};
      workers_.team().for_parts([&](unsigned part) {
        DirectCounters& counters = counters_[part];
        counters = {};
        const std::size_t count = loops_.size() + groups_.size();
        for (std::size_t i; (i = next.fetch_add(1, std::memory_order_relaxed)) < count;) {
          if (i < loops_.size()) {
            advance_loops(static_cast<std::uint32_t>(i), dt, counters);
          } else {
            advance(groups_[i - loops_.size()], dt, part, counters);
          }
        }
      });
    });
    finish_anchors();
    velocities_known_ = false;

    DirectCounters counters;
    for (const DirectCounters& of_part : counters_) counters.add(of_part);
    StepReport report;
    report.substeps = settings_.substeps;
    report.direct_substeps = counters.substeps;
    report.newton = counters.newton;
    report.halvings = counters.halvings;
    report.fallbacks = counters.fallbacks;
    report.unsolved = counters.unsolved;
    report.repeated_steps = counters.repeated;
    report.inaccurate_steps = counters.inaccurate;
    return report;
  }

  void set_stop_rule(const StopRule& rule) override {
    settings_.stop = rule;
    loops_.set_line_tolerance(line_tolerance(settings_));
  }
  void set_weights(Weights weights) override { settings_.weights = weights; }

  void set_force(std::uint32_t particle, Vec3 force) override {
    if (loops_.holds(particle)) return loops_.set_force(particle, force);
    const Place place = places_[particle];
    Group& group = groups_[place.group];
    if (gradient_of(settings_) == Gradient::old) keep_velocities(group, place.lane);
    group.state.set_force(place.node, place.lane, force);
  }

  void move_anchor(std::uint32_t particle, Vec3 target) override {
    if (anchor_of_[particle] == no_anchor) {
      anchor_of_[particle] = static_cast<std::uint32_t>(anchors_.size());
      anchors_.push_back({particle, target});
    } else {
      anchors_[anchor_of_[particle]].target = target;
    }
  }

  Vec3 position(std::uint32_t particle) const override {
    if (fixed_[particle]) return fixed_position_[particle];
    if (loops_.holds(particle)) return loops_.position(particle);
    const Place place = places_[particle];
    return groups_[place.group].state.position(place.node, place.lane);
  }

  Vec3 velocity(std::uint32_t particle) const override {
    if (fixed_[particle]) return {};
    if (loops_.holds(particle)) return loops_.velocity(particle);
    find_velocities();
    const Place place = places_[particle];
    const Group& group = groups_[place.group];
    const auto at = [&](std::uint32_t c) {
      return static_cast<double>(group.velocity[group.state.at(3 * place.node + c, place.lane)]);
    };
    return {at(0), at(1), at(2)};
  }

  std::uint64_t state_hash() const override {
    StateHash hash;
    for (std::uint32_t i = 0; i < places_.size(); ++i) {
      hash.add<double>(position(i));
      if (fixed_[i]) continue;
      if (loops_.holds(i)) {
        hash.add<double>(loops_.displacement(i));
        continue;
      }
      const TreeState<T>& state = groups_[places_[i].group].state;
      for (std::uint32_t c = 0; c < 3; ++c)
        hash.add(static_cast<double>(state.u[state.at(3 * places_[i].node + c, places_[i].lane)]));
    }
    return hash.value();
  }

  const WorldInfo& info() const override { return info_; }

 private:
  /// One line in segments: how it is cut, and itself for what happens rarely.
  struct Line {
    LineSegments segments;
    TreeState<T> whole;
    TreeWorkspace<T> work;
  };
  struct Group {
    TreeState<T> state;
    std::uint32_t trees;
    std::size_t kind;  ///< of topology, into kinds_
    layouts::AlignedBuffer<T> velocity;
    std::unique_ptr<Line> line = nullptr;  ///< if state is one line in segments
    bool anchors_changed = false;
    bool is_calm = false;  ///< calm_stepper_ moves it
    int calm_steps = 0;    ///< in turn, in which it could have
    // With accuracy:
    std::unique_ptr<TreeState<T>> start = nullptr;    ///< of the step
    std::unique_ptr<TreeState<T>> stretch = nullptr;  ///< of a stretch that is compared
    double substep = 0;                               ///< s, that the last one thought best; 0: none yet
    layouts::AlignedBuffer<double> coarse{};          ///< m: where half as many substeps take it
  };
  /// What each thread needs for one topology.
  struct Crew {
    TreeWorkspace<T> work;
    TreeState<T> alone;
    TreeWorkspace<T> alone_work;
  };
  struct Place {
    std::uint32_t group = 0, node = 0, lane = 0;
  };
  struct Anchor {
    std::uint32_t particle;
    Vec3 target;
  };

  // --- Compiling

  void make_groups(const Scene& scene) {
    const SceneGraph owner(scene);
    const layouts::Graph graph = owner.view();
    const layouts::Islands islands = layouts::find_islands(graph);
    info_.islands = islands.count();
    for (const auto& equal : layouts::group_equal_islands(graph, islands)) {
      const layouts::LocalGraph local = layouts::local_graph(graph, islands, equal.front());
      const auto tree = layouts::find_tree(local.view());
      if (tree && !is_held_below_root(*tree))
        add_kind(scene, islands, equal, *tree);
      else
        loops_.add(scene, mass_model_of(settings_), islands, equal, local.view());
    }
  }

  /// Whether a node other than the root may be held for good, by three pins or, in a plane, by two:
  /// elimination from the tips would divide by zero at its rod to the parent. The solver for loops does not.
  static bool is_held_below_root(const layouts::Tree& tree) {
    for (std::uint32_t i = 1; i < tree.nodes(); ++i)
      if (tree.pin_begin[i + 1] - tree.pin_begin[i] > 1) return true;
    return false;
  }

  void add_kind(const Scene& scene, const layouts::Islands& islands, const std::vector<std::uint32_t>& equal,
                const layouts::Tree& tree) {
    const auto count = static_cast<std::uint32_t>(equal.size());
    // With fewer trees than this a whole vector would cost more than one after the other.
    const std::uint32_t lanes = count * 4 >= lane_width<T> ? lane_width<T> : 1;
    const auto topology = std::make_shared<const TreeTopology>(tree);
    const std::size_t kind = crews_.size();
    std::vector<Crew>& crews = crews_.emplace_back();
    for (unsigned part = 0; part < workers_.size(); ++part)
      crews.push_back(
          {TreeWorkspace<T>(*topology, lanes), TreeState<T>(topology, 1), TreeWorkspace<T>(*topology, 1)});
    for (std::uint32_t first = 0; first < count; first += lanes) {
      const std::uint32_t trees = std::min(lanes, count - first);
      const auto g = static_cast<std::uint32_t>(groups_.size());
      Group& group = groups_.emplace_back(Group{TreeState<T>(topology, lanes), trees, kind, {}});
      for (std::uint32_t lane = 0; lane < lanes; ++lane) {
        // Lanes without a tree repeat the last one; nobody looks at them.
        const std::uint32_t island = equal[first + std::min(lane, trees - 1)];
        const TreeMembers members{islands.vertices(island), islands.edges(island)};
        group.state.fill_lane(lane, scene, mass_model_of(settings_), tree, members);
        if (lane >= trees) continue;
        for (std::uint32_t i = 0; i < tree.nodes(); ++i) {
          places_[members.vertices[tree.vertex[i]]] = {g, i, lane};
          for (std::uint32_t k = tree.pin_begin[i]; k < tree.pin_begin[i + 1]; ++k)
            pins_of_[members.vertices[tree.pins[k].vertex]].push_back({g, k, lane});
        }
        if (lanes == 1) cut(g, tree, members);
      }
      group.velocity = layouts::AlignedBuffer<T>(group.state.u.size());
      allocate_starts(group);
    }
  }

  /// A long line moves in segments if nothing but its multipliers is unknown.
  void cut(std::uint32_t g, const layouts::Tree& tree, const TreeMembers& members) {
    Group& group = groups_[g];
    if (!TreeStepper<T>::is_line(group.state, gradient_of(settings_)) ||
        !LineSegments::fits(*group.state.topology, lane_width<T>))
      return;
    const LineSegments segments(tree.nodes(), lane_width<T>);
    TreeState<T> state = segments.cut(group.state);
    group.line = std::make_unique<Line>(
        Line{segments, std::move(group.state), TreeWorkspace<T>(*state.topology, state.lanes)});
    group.state = std::move(state);
    for (std::uint32_t i = 0; i < tree.nodes(); ++i)
      places_[members.vertices[tree.vertex[i]]] = {g, segments.entry(i), segments.lane(i)};
  }

  /// For what is taken back.
  void allocate_starts(Group& group) const {
    if (!settings_.accuracy) return;
    const auto another = [&] {
      return std::make_unique<TreeState<T>>(group.state.topology, group.state.lanes);
    };
    group.start = another();
    group.stretch = another();
    group.coarse = layouts::AlignedBuffer<double>(group.state.x.size());
  }

  void fill_info(const Scene& scene) {
    info_.particles = static_cast<std::uint32_t>(scene.particles.size());
    info_.rods = static_cast<std::uint32_t>(scene.rods.size());
    info_.direct_rods = info_.rods;
    info_.direct_gradient = gradient_of(settings_);
    info_.changes_gradient = calm_stepper_ && std::any_of(groups_.begin(), groups_.end(),
                                                          [](const Group& group) { return !group.line; });
    info_.direct_time_order = settings_.time_order;
    info_.isa = isa_;
    info_.threads = workers_.size();
    info_.parallel = uses_threads();
    info_.skipped_drag = scene.drag == 0;
  }

  /// Makes rods start at their lengths. The first substep would do it too, but as a velocity, the greater the
  /// shorter it is.
  void project_initial_positions(const Scene& scene) {
    std::vector<std::uint8_t> group_is_off(groups_.size()), loop_is_off(loops_.size());
    bool any = false;
    for (std::size_t i = 0; i < scene.rods.size(); ++i) {
      const Rod& rod = scene.rods[i];
      const double length = rod_length(scene, i);
      const double now = norm(scene.particles[rod.b].position - scene.particles[rod.a].position);
      if (std::abs(now - length) <= least_gap * length) continue;
      any = true;
      const std::uint32_t end = fixed_[rod.a] ? rod.b : rod.a;
      if (loops_.holds(end))
        loop_is_off[loops_.island(end)] = 1;
      else
        group_is_off[places_[end].group] = 1;
    }
    if (!any) return;
    for (std::uint32_t i = 0; i < loop_is_off.size(); ++i)
      if (loop_is_off[i] && !loops_.project_positions(i, projection_step)) ++info_.unprojected_islands;
    const TreeStepper<T> stepper(Gradient::new_, 0, false, isa_);
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      if (group_is_off[g] == 0) continue;
      Group& group = groups_[g];
      Crew& crew = crews_[group.kind][0];
      TreeState<T>& state = group.line ? group.line->whole : group.state;
      TreeState<T> before(state.topology, state.lanes);
      before.copy_motion(state);
      DirectCounters not_of_a_step;
      stepper.advance(state, group.trees, projection_step, crew.work, crew.alone, crew.alone_work,
                      not_of_a_step);
      info_.unprojected_islands += static_cast<std::uint32_t>(not_of_a_step.unsolved);
      std::copy_n(state.x.data(), state.x.size(), before.x.data());
      state.copy_motion(before);  // but for x
      if (group.line) group.line->segments.scatter(state, group.state);
    }
    for (std::uint32_t i = 0; i < scene.particles.size(); ++i)
      info_.projected_position =
          std::max(info_.projected_position, norm(position(i) - scene.particles[i].position));
  }

  void set_initial_velocities(const Scene& scene) {
    for (std::uint32_t i = 0; i < scene.particles.size(); ++i) {
      if (fixed_[i]) continue;
      const Vec3 v = scene.particles[i].velocity;
      if (loops_.holds(i)) {
        loops_.set_velocity(i, v);
        continue;
      }
      const Place place = places_[i];
      TreeState<T>& state = groups_[place.group].state;
      const double velocity[3] = {v.x, v.y, v.z};
      for (std::uint32_t c = 0; c < 3; ++c)
        state.u[state.at(3 * place.node + c, place.lane)] = static_cast<T>(velocity[c]);
    }
    loops_.project_velocities();
    for (Group& group : groups_) {
      TreeWorkspace<T>& work = crews_[group.kind][0].work;
      if (group.line) {
        group.line->segments.gather(group.state, group.line->whole);
        stepper_.project_velocities(group.line->whole, work);
        group.line->segments.scatter(group.line->whole, group.state);
      } else {
        stepper_.project_velocities(group.state, work);
      }
    }
    for (std::uint32_t i = 0; i < scene.particles.size(); ++i)
      if (!fixed_[i])
        info_.projected_velocity =
            std::max(info_.projected_velocity, norm(velocity(i) - scene.particles[i].velocity));
  }

  // --- Stepping

  bool uses_threads() const { return workers_.size() > 1 && groups_.size() + loops_.size() > 1; }

  void advance(Group& group, double dt, unsigned part, DirectCounters& counters) {
    Crew& crew = crews_[group.kind][part];
    if (group.anchors_changed && (group.is_calm || gradient_of(settings_) == Gradient::mid))
      stepper_.project_velocities(group.state, crew.work);
    if (!is_controlled()) {
      advance(group, crew, dt / settings_.substeps, settings_.substeps, counters);
      return;
    }
    AccuracyControl control = accuracy_control(most_substeps<T>);
    control.begin_step(group.anchors_changed, stepper_.pieces(group.state, dt));
    group.start->copy_motion(group.state);
    if (group.is_calm && step_calmly(group, crew, dt, control, counters)) return;
    double error = 0, h = dt;
    control.step(
        dt, group.substep, counters,
        [&](double length, std::uint32_t substeps, DirectCounters& of_attempt) {
          h = length;
          AccuracyControl::Attempt result;
          if (control.by_comparison)
            result = advance_and_compare(group, crew, h, control, substeps, of_attempt);
          else
            result.error = advance(group, crew, h, substeps, of_attempt);
          error = result.error;
          result.is_blind = result.is_blind || (control.by_comparison && of_attempt.halvings > 0);
          // What a thousandth of a substep did not solve, a shorter one will not.
          result.is_final = of_attempt.unsolved + of_attempt.fallbacks > 0;
          return result;
        },
        [&] { group.state.copy_motion(*group.start); });
    if (group.anchors_changed) std::fill(group.state.known.begin(), group.state.known.end(), std::uint8_t{0});
    if (calm_stepper_ && !group.line) watch(group, crew, error, h, dt / control.least, control.allowed);
  }

  // Gradient old has to resolve the fastest wave, even of a load that hangs still. Mid need not, but what
  // long steps do to fast motion it keeps, and would have to follow ever more closely later. So mid takes
  // steps that its own estimate finds short enough as they are, and old all that must be cut.

  /// One step with gradient mid; taken back if that is not accurate enough.
  bool step_calmly(Group& group, Crew& crew, double dt, const AccuracyControl& control,
                   DirectCounters& counters) {
    const double h = dt / control.least;
    DirectCounters attempt;
    if (advance(group, crew, h, control.least, attempt) <= h * control.allowed) {
      counters.add(attempt);
      return true;
    }
    group.state.copy_motion(*group.start);
    counters.newton += attempt.newton;  // work, all the same
    ++counters.repeated;
    group.is_calm = false;
    group.calm_steps = 0;
    return false;
  }

  /// After a step with gradient old by substeps of `h` with that error each: whether mid would do with
  /// substeps of `longest`, m/s allowed. A substep's error grows by the third power of its length. (The first
  /// two of mid have no estimate of their own yet.)
  void watch(Group& group, Crew& crew, double error, double h, double longest, double allowed) {
    const double rate = error * longest * longest / (h * h * h * allowed);
    const bool is_line = TreeStepper<T>::is_line(group.state, Gradient::old);
    const bool is_dear = stepper_.pieces(group.state, longest) >= (is_line ? dear_on_lines : dear_on_trees);
    group.calm_steps = is_dear && rate < calm_rate ? group.calm_steps + 1 : 0;
    if (group.calm_steps < calm_after) return;
    group.is_calm = true;
    TreeState<T>& state = group.state;
    stepper_.find_velocities(state, crew.work);
    for (std::uint32_t lane = 0; lane < state.lanes; ++lane) state.set_velocities(lane, crew.work.velocity);
    std::fill(state.known.begin(), state.known.end(), std::uint8_t{0});
    std::fill(state.smooth.begin(), state.smooth.end(), std::uint8_t{0});
  }

  void advance_loops(std::uint32_t island, double dt, DirectCounters& counters) {
    if (is_controlled())
      loops_.advance(island, dt, accuracy_control(most_substeps<double>), counters);
    else
      loops_.advance(island, dt / settings_.substeps, settings_.substeps, counters);
  }

  /// Steppers estimate the errors of second order by themselves; others show when steps are compared.
  bool estimates() const {
    return settings_.accuracy && settings_.time_order == 2 && gradient_of(settings_) != Gradient::new_;
  }
  /// One particle alone has no length for an error to be relative to.
  bool is_controlled() const { return settings_.accuracy && diagonal_ > 0; }
  AccuracyControl accuracy_control(std::uint32_t most) const {
    const std::uint32_t order = gradient_of(settings_) == Gradient::new_ ? 1 : settings_.time_order;
    return {*settings_.accuracy * diagonal_, settings_.substeps, most, order, !estimates()};
  }

  AccuracyControl::Attempt advance_and_compare(Group& group, Crew& crew, double h,
                                               const AccuracyControl& control, std::uint32_t substeps,
                                               DirectCounters& counters) {
    const std::vector<double>& steps = group.state.u_step;
    const bool starts_anew = group.anchors_changed || std::any_of(steps.begin(), steps.begin() + group.trees,
                                                                  [](double step) { return step == 0; });
    return control.compare(
        h, substeps, starts_anew, counters,
        [&](double length, std::uint32_t count, DirectCounters& counted) {
          advance(group, crew, length, count, counted);
        },
        [&] { group.stretch->copy_motion(group.state); },
        [&] {
          std::copy_n(group.state.x.data(), group.coarse.size(), group.coarse.data());
          group.state.copy_motion(*group.stretch);
        },
        [&] {
          const auto& x = group.state.x;
          return largest_distance({x.data(), x.size()}, {group.coarse.data(), group.coarse.size()},
                                  group.state.topology->nodes, group.state.lanes);
        });
  }
  /// One substep; its error estimate.
  double advance(Group& group, Crew& crew, double h, DirectCounters& counters) {
    if (group.line)
      return stepper_.advance(group.line->segments, group.state, h, group.line->work, group.line->whole,
                              crew.alone_work, counters);
    const TreeStepper<T>& stepper = group.is_calm ? *calm_stepper_ : stepper_;
    return stepper.advance(group.state, group.trees, h, crew.work, crew.alone, crew.alone_work, counters);
  }
  /// The largest error estimate of the substeps.
  double advance(Group& group, Crew& crew, double h, std::uint32_t substeps, DirectCounters& counters) {
    double error = 0;
    for (std::uint32_t i = 0; i < substeps; ++i) error = std::max(error, advance(group, crew, h, counters));
    return error;
  }

  /// Gives fixed ends the velocity that takes them to their targets in `dt`.
  void start_anchors(double dt) {
    for (Group& group : groups_) group.anchors_changed = false;
    for (const Anchor& anchor : anchors_) {
      const Vec3 velocity = (1 / dt) * (anchor.target - fixed_position_[anchor.particle]);
      loops_.set_anchor_velocity(anchor.particle, velocity);
      for (const Place& place : pins_of_[anchor.particle]) {
        Group& group = groups_[place.group];
        group.state.pin_velocity[group.state.at(place.node, place.lane)] = velocity;
        group.state.pins_move = true;
      }
    }
    loops_.start_anchors();
    for (Group& group : groups_) {
      if (!group.state.pins_move) continue;
      const TreeState<T>& state = group.state;
      group.anchors_changed =
          !std::equal(state.pin_velocity.begin(), state.pin_velocity.end(), state.pin_last_velocity.begin(),
                      [](Vec3 a, Vec3 b) { return norm(a - b) <= unchanged * norm(a); });
    }
  }

  void finish_anchors() {
    loops_.finish_anchors();
    for (Group& group : groups_) {
      TreeState<T>& state = group.state;
      if (!state.pins_move) continue;
      state.pins_move = std::any_of(state.pin_velocity.begin(), state.pin_velocity.end(),
                                    [](Vec3 v) { return v != Vec3{}; });
      state.pin_last_velocity = state.pin_velocity;
      std::fill(state.pin_velocity.begin(), state.pin_velocity.end(), Vec3{});
      std::fill_n(state.pin_delta.data(), state.pin_delta.size(), T(0));
      std::fill_n(state.pin_u.data(), state.pin_u.size(), T(0));
    }
    for (const Anchor& anchor : anchors_) {
      fixed_position_[anchor.particle] = anchor.target;
      loops_.set_anchor_position(anchor.particle, anchor.target);
      for (const Place& place : pins_of_[anchor.particle]) {
        TreeState<T>& state = groups_[place.group].state;
        const double at[3] = {anchor.target.x, anchor.target.y, anchor.target.z};
        for (std::uint32_t c = 0; c < 3; ++c) state.pin_x[state.at(3 * place.node + c, place.lane)] = at[c];
      }
    }
    for (const Anchor& anchor : anchors_) anchor_of_[anchor.particle] = no_anchor;
    anchors_.clear();
  }

  /// A displacement stands for the velocity of now under the force that made it. Before that force changes it
  /// gives way to the velocity, in all lanes of a line in segments.
  void keep_velocities(Group& group, std::uint32_t lane) {
    TreeState<T>& state = group.state;
    if (state.u_step[lane] == 0) return;
    find_velocities();
    for (std::uint32_t l = group.line ? 0 : lane; l < (group.line ? state.lanes : lane + 1); ++l)
      state.set_velocities(l, group.velocity);
  }

  void find_velocities() const {
    if (velocities_known_) return;
    for (Group& group : groups_) {
      TreeWorkspace<T>& work = crews_[group.kind][0].work;
      if (group.line) {
        group.line->segments.gather(group.state, group.line->whole);
        stepper_.find_velocities(group.line->whole, work);
        group.line->segments.scatter_nodes(work.velocity, group.velocity);
        continue;
      }
      stepper_.find_velocities(group.state, work);
      std::copy_n(work.velocity.data(), group.velocity.size(), group.velocity.data());
    }
    velocities_known_ = true;
  }

  Settings settings_;
  Isa isa_;
  Workers workers_;
  std::vector<DirectCounters> counters_;  ///< of every thread
  TreeStepper<T> stepper_;
  std::optional<TreeStepper<T>> calm_stepper_;  ///< gradient mid, if the gradient may change
  LoopGroup loops_;
  double diagonal_;
  mutable std::vector<Group> groups_;
  mutable std::vector<std::vector<Crew>> crews_;  ///< per topology and thread
  mutable bool velocities_known_ = false;
  std::vector<Place> places_;                ///< of movable particles
  std::vector<std::vector<Place>> pins_of_;  ///< of fixed ones; node is the pin
  std::vector<std::uint8_t> fixed_;
  std::vector<Vec3> fixed_position_;
  static constexpr std::uint32_t no_anchor = 0xffffffff;
  std::vector<std::uint32_t> anchor_of_;  ///< per particle, into anchors_
  std::vector<Anchor> anchors_;
  WorldInfo info_;
};

}  // namespace

std::unique_ptr<Simulation> make_direct_simulation(const Scene& scene, const Settings& settings,
                                                   bool changes_gradient) {
  if (settings.precision == Precision::single)
    return std::make_unique<DirectSimulation<float>>(scene, settings, changes_gradient);
  return std::make_unique<DirectSimulation<double>>(scene, settings, changes_gradient);
}

}  // namespace plumb::detail
