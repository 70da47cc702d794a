#include "step/step.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "scene/bends/twists.hpp"
#include "scene/reels/reels.hpp"
#include "scene/refuse.hpp"
#include "step/methods.hpp"

namespace plumb::detail {

// The list says what one step of the world does. Predicting, projecting or solving, and correcting velocities
// belong to the solvers, since each does them on its own numbers. They are part of `solve` here.
//
// - split: Islands that rods broke apart in the last step, or that were edited since, go on as they are now.
// - wake: Anchors that will move wake what hangs from them, and get their velocities.
// - collide: Islands that may touch within the step become clusters. The rest stay with their solvers.
// - solve: Every piece that is awake goes through the step by equal substeps, or by as many as its estimated
//   error asks for. Pieces share nothing and go to whichever thread is free.
// - sleep: Pieces that have only moved by rounding for long enough stand still from now on.
// - measure: What was done and what was skipped is added up. Anchors stand where they were sent.
// - events: What became of islands and rods is listed, if the settings ask for it.
const Step::Stage Step::all_stages[] = {
    {&Step::split, &Step::always, "split"},
    {&Step::wake, &Step::always, "wake"},
    {&Step::collide, &Step::has_contact, "collide"},
    {&Step::solve, &Step::always, "solve"},
    {&Step::sleep, &Step::always, "sleep"},
    {&Step::measure, &Step::always, "measure"},
    {&Step::list_events, &Step::has_events, "events"},
};

namespace {

constexpr double us_a_projection = 0.005, us_a_solved_rod = 1;  // in a first step, whose caches are cold

Settings with_threads(Settings settings, unsigned threads) {
  settings.threads = threads;
  return settings;
}

}  // namespace

Step::Step(std::shared_ptr<const Scene> shared, const Settings& settings)
    : settings_(settings),
      thresholds_(thresholds_of(settings.executor)),
      workers_(settings),
      compiled_(compile(shared, with_threads(settings, workers_.size()))),
      anchors_(*shared, compiled_.solvers.size()),
      lengths_(*shared),
      reeled_(reeled_rods(*shared)),
      twisted_(twisted_rods(*shared)),
      loads_(*shared),
      reactions_(*shared, settings),
      origin_{std::move(shared), settings},
      breaks_(first_scene(), settings),
      gravity_(first_scene().gravity),
      next_gravity_(gravity_),
      population_(population_of(first_scene())),
      rods_(first_scene()),
      reports_(workers_.size()) {
  const Scene& scene = first_scene();
  rules_.substeps = settings.substeps;
  rules_.most_work = settings.most_work;
  measure_size(scene);
  sleep_.start(compiled_.solvers, settings);
  for (const Stage& stage : all_stages)
    if ((this->*stage.is_needed)()) stages_.push_back(stage);
  seats_.assign(compiled_.solvers.size(), Seat::kept);
  is_loose_.assign(seats_.size(), 0);
  const bool moves_by_reference = settings.method == Method::springs ||
                                  settings.method == Method::multipliers ||
                                  settings.method == Method::featherstone;
  has_archive_ = !moves_by_reference && std::all_of(compiled_.solvers.begin(), compiled_.solvers.end(),
                                                    [](const auto& solver) { return solver->has_archive(); });
  reserve();
  compiled_.places.find_runs(compiled_.solvers);
  if (settings.events) {
    events_.grow(scene.particles.size(), scene.rods.size());
    Array<std::uint32_t> all(scene.particles.size());
    std::iota(all.begin(), all.end(), 0u);
    find_heads(all);
  }
  compiled_.info.parallel = uses_threads();
}

/// Finds how fast errors may grow, relative to the first scene or addition that has more than one place.
/// Until then there is no length to which errors could be relative, and no accuracy is kept.
void Step::measure_size(const Scene& scene) {
  if (size_ > 0) return;
  size_ = bounding_diagonal(scene);
  relate_errors();
}

void Step::relate_errors() {
  if (settings_.accuracy && size_ > 0) rules_.error_growth = *settings_.accuracy * size_;
}

/// Makes the space that steps need, so that they allocate nothing.
void Step::reserve() {
  const auto reserve_for = [](auto& list, std::size_t count) {
    if (count > list.capacity()) list.reserve(std::max(count, 2 * list.capacity()));
  };
  reserve_for(active_, sleep_.tasks().size());
  reserve_for(visited_, compiled_.solvers.size());
  reserve_for(last_dt_, compiled_.solvers.size());
  if (compiled_.contact) reserve_for(edits_.cut, breaks_.weak().size());
}

StepReport Step::run(double dt) {
  StepReport report;
  begin_budget();
  report.substeps = rules_.substeps;
  dt_ = dt;
  for (const Stage& stage : stages_) {
    if (zones_) zones_(stage.name, true);
    (this->*stage.run)(report);
    if (zones_) zones_(stage.name, false);
  }
  budget_.end_step(rules_.substeps, rules_.error_growth.has_value(), report);
  has_broken_ = report.broken_rods > 0;
  if (has_broken_) cut_broken();
  return report;
}

/// Finds how many substeps this step takes, and how long it may try for more.
void Step::begin_budget() {
  const bool is_controlled = rules_.error_growth.has_value();
  const double projections = double{1} * compiled_.info.relaxed_rods * settings_.stop.sweeps;
  const double guess = us_a_projection * projections + us_a_solved_rod * compiled_.info.direct_rods;
  const std::uint32_t fit = budget_.begin_step(settings_.substeps, guess);
  const std::uint32_t substeps = is_controlled ? settings_.substeps : fit;
  rules_.deadline = budget_.deadline(is_controlled);
  if (std::exchange(rules_.substeps, substeps) == substeps) return;
  for_solvers([&](Solver& solver) { solver.set_substeps(substeps); });
}

// --- Stages

void Step::wake(StepReport&) {
  // Velocities are those of the last step, with its lengths.
  reactions_.begin_step([&](std::uint32_t particle) { return position(particle); },
                        [&](std::uint32_t particle) { return velocity(particle); },
                        [&](std::uint32_t anchor) { return anchors_.velocity(anchor, dt_); });
  begin_lengths();
  if (compiled_.contact) {
    compiled_.contact->begin_ground(dt_, [&](std::uint32_t anchor) {
      return std::pair(anchors_.position(anchor), anchors_.velocity(anchor, dt_));
    });
    for (const auto& [home, slot] : compiled_.contact->woken()) sleep_.wake(compiled_.solvers, {home, slot});
  }
  begin_grabs();
  if (!anchors_.any_paths()) return;
  anchors_.for_moving_places(compiled_.places,
                             [&](const Place& place) { sleep_.wake(compiled_.solvers, place); });
  anchors_.begin_step(dt_, compiled_.places, compiled_.solvers);
}

void Step::collide(StepReport&) {
  ContactSolver& contact = *compiled_.contact;
  if (settings_.sleep)
    contact.see_rest([&](std::uint32_t home, Slot slot) {
      return sleep_.is_asleep(compiled_.solvers, {home, slot});
    });
  if (!contact.any_awake()) return contact.clear_pieces();
  workers_.lead(contact.is_worth_threads() && workers_.size() > 1,
                [&] { contact.begin_step(dt_, workers_.team()); });
  for (const auto& [home, slot] : contact.returned()) sleep_.wake(compiled_.solvers, {home, slot});
}

void Step::solve(StepReport& report) {
  active_.clear();
  visited_.clear();
  for (Task& task : sleep_.tasks())
    if (task.asleep) task.troubles &= lasting;
  if (!sleep_.all_asleep()) {
    const std::span<Task> tasks = sleep_.tasks();
    for (std::uint32_t t = 0; t < tasks.size(); ++t) {
      if (tasks[t].asleep) continue;
      if (visited_.empty() || visited_.back() != tasks[t].solver) visited_.push_back(tasks[t].solver);
      if (!compiled_.solvers[tasks[t].solver]->wants_team())
        active_.push_back(t);
      else
        tasks[t].dt = dt_;
    }
    // Not the same ones are last every time when time runs out. Their order changes no bits.
    if (rules_.deadline && !active_.empty())
      std::rotate(active_.begin(), active_.begin() + budget_.steps() % active_.size(), active_.end());
  }
  ContactSolver* const contact = compiled_.contact;
  const std::uint32_t clusters = contact ? contact->pieces() : 0;
  if (visited_.empty() && clusters == 0) return;
  for (StepReport& of_part : reports_) of_part = {};
  workers_.lead(uses_threads(), [&] {
    Team& team = workers_.team();
    for (const std::uint32_t s : visited_) compiled_.solvers[s]->begin_step(dt_, team);
    for (const std::uint32_t s : visited_)
      if (Solver& solver = *compiled_.solvers[s]; solver.wants_team()) advance_with_team(s, solver, team);
    const auto advance_cluster = [&](std::uint32_t piece, unsigned part) {
      const StepReport before = reports_[part];
      advance(*contact, piece, part);
      contact->tell(piece, troubles_between(before, reports_[part]));
    };
    if (contact) contact->for_team_pieces(team, [&](std::uint32_t piece) { advance_cluster(piece, 0); });
    const auto tasks = static_cast<std::uint32_t>(active_.size());
    team.for_each(tasks + clusters, [&](std::uint32_t i, unsigned part) {
      if (i < tasks) return advance(sleep_.tasks()[active_[i]], part);
      if (!contact->is_for_team(i - tasks, team.parts())) advance_cluster(i - tasks, part);
    });
  });
  for (const StepReport& of_part : reports_) report += of_part;
  for (const std::uint32_t s : visited_) compiled_.solvers[s]->end_step(report);
  if (contact && contact->any_awake()) contact->end_step(report);
}

/// Lets a task know what the report says of it.
void Step::tell(Task& task, const StepReport& before, const StepReport& after) {
  task.troubles = troubles_between(before, after);
  task.has_broken = after.broken_rods > before.broken_rods;
}

void Step::advance_with_team(std::uint32_t number, Solver& solver, Team& team) {
  const StepReport before = reports_[0];
  solver.advance_with_team(dt_ / rules_.substeps, rules_.substeps, team, reports_[0]);
  for (Task& task : sleep_.tasks())
    if (task.solver == number) tell(task, before, reports_[0]);
}

void Step::advance(Solver& solver, std::uint32_t piece, unsigned part) {
  advance_piece(solver, piece, dt_, rules_, part, reports_[part]);
  solver.end_piece(piece, dt_, part);
}

void Step::advance(Task& task, unsigned part) {
  Solver& solver = *compiled_.solvers[task.solver];
  task.troubles = 0;
  task.has_broken = false;
  if (solver.is_away(task.piece)) return;
  task.dt = dt_;
  const StepReport before = reports_[part];
  advance(solver, task.piece, part);
  tell(task, before, reports_[part]);
}

void Step::sleep(StepReport& report) {
  if (sleep_.all_asleep()) return;
  for (Task& task : sleep_.tasks()) {
    if (task.asleep) continue;
    const Solver& solver = *compiled_.solvers[task.solver];
    task.is_still = !task.has_broken && solver.can_rest() &&
                    solver.is_slower(task.piece, sleep_.rounding_speed(solver, task.piece));
  }
  report.fell_asleep += sleep_.settle(compiled_.solvers, dt_);
}

void Step::measure(StepReport& report) {
  for (const Task& task : sleep_.tasks()) {
    const Solver& solver = *compiled_.solvers[task.solver];
    if (!task.asleep && !solver.is_away(task.piece)) report.awake_islands += solver.islands(task.piece);
  }
  if (anchors_.any_paths()) anchors_.end_step(compiled_.places, compiled_.solvers);
  end_grabs();
  lengths_.end_step([this](auto... of) { tell_length(of...); });
  if (compiled_.contact) compiled_.contact->after_step();
}

bool Step::uses_threads() const {
  if (workers_.size() == 1) return false;
  std::uint32_t solved = 0;  // counts pieces that do not sweep
  for_solvers([&](const Solver& solver) {
    if (solver.takes_accuracy() && !solver.has_changing_pieces() && !solver.sweeps()) ++solved;
  });
  const double projections =
      double{1} * compiled_.info.relaxed_rods * settings_.stop.sweeps * settings_.substeps;
  return projections >= thresholds_.projections || solved > 1 ||
         (compiled_.contact && compiled_.contact->is_worth_threads());
}

// --- Changes

void Step::set_stop_rule(const StopRule& rule) {
  bool is_read = false;
  for_solvers([&](Solver& solver) { is_read = solver.set_stop_rule(rule) || is_read; });
  if (!is_read) refuse("no island of this world reads a stop rule: none is relaxed, nor solved by lines");
  settings_.stop = rule;
  sleep_.wake_all(compiled_.solvers);
  compiled_.info.parallel = uses_threads();
}

void Step::set_accuracy(double accuracy) {
  settings_.accuracy = accuracy;
  relate_errors();
}

void Step::set_weights(Weights weights) {
  bool is_read = false;
  for_solvers([&](Solver& solver) { is_read = solver.set_weights(weights) || is_read; });
  if (!is_read) refuse("no island of this world reads weights: none is relaxed");
  settings_.weights = weights;
  sleep_.wake_all(compiled_.solvers);
  describe();
}

void Step::describe() {
  WorldInfo& info = compiled_.info;
  info.relaxed_rods = info.direct_rods = info.linkages = 0;
  info.skipped_per_rod_weights = 0;
  info.changes_gradient = false;
  info.blocks.clear();
  for_solvers([&](const Solver& solver) { solver.describe(info); });
  info.parallel = uses_threads();
  is_described_ = true;
}

void Step::ask_load(double time, double dt) {
  if (loads_.any())
    loads_.ask(time, dt, [&](std::uint32_t particle) {
      if (!anchors_.is_fixed(particle)) return Loads::Motion{position(particle), velocity(particle), false};
      return Loads::Motion{position(particle), anchors_.velocity(particle, dt), true};
    });
  loads_.for_changed([&](std::uint32_t particle, Vec3 force) { put_force(particle, force); });
}

void Step::set_force(std::uint32_t particle, Vec3 force) {
  put_force(particle, loads_.set_force(particle, force));
}

void Step::put_force(std::uint32_t particle, Vec3 force) {
  if (anchors_.is_fixed(particle)) return;  // It is freed in the next step, and has its force then.
  for (const Place place : compiled_.places.of(particle)) {
    solver(place).set_force(place.slot, force);
    sleep_.wake(compiled_.solvers, place);
  }
}

void Step::move_anchor(std::uint32_t particle, Vec3 target) {
  anchors_.set_target(particle, target);
}

void Step::set_twist(std::uint32_t twist, double angle) {
  for (const Place place : compiled_.twists.of(twist)) {
    solver(place).set_twist(place.slot, angle);
    sleep_.wake(compiled_.solvers, place);
  }
}

// --- Reading

double Step::twist(std::uint32_t twist) const {
  const auto places = compiled_.twists.of(twist);
  return places.empty() ? 0 : solver(places.front()).twist(places.front().slot);
}

bool Step::is_broken(std::uint32_t rod) const {
  if (breaks_.is_out(rod)) return true;
  if (is_known_to_contact(rod) && compiled_.contact->has_broken(rod)) return true;
  const auto places = compiled_.cords.of(rod);
  return !places.empty() && solver(places.front()).is_broken(places.front().slot);
}

}  // namespace plumb::detail
