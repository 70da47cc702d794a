#include "contest/contest.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "contest/baseline.hpp"
#include "contest/world_stepper.hpp"
#include "support/check.hpp"
#include "support/statistics.hpp"

namespace plumb::bench {
namespace {

/// A sample lasts at least this long, and its warming half of it. That is longer than a processor takes to
/// change its clock from one instruction set to another. A longer one makes runs longer and samples quieter.
constexpr double sample_s = 3e-3;

/// Returns how many steps come before the first sample: a second of motion where that is cheap.
std::uint32_t run_up_steps(Level level) {
  switch (level) {
    case Level::l1:
    case Level::l2:
      return 60;
    case Level::l3:
      return 6;
    case Level::dram:
      break;
  }
  return 1;
}

/// This is a contender made ready to step.
struct Entrant {
  std::unique_ptr<Stepper> stepper;
  const WorldStepper* world = nullptr;  ///< null for a baseline
  std::uint32_t steps = 1;              ///< steps in a sample
  std::uint32_t warming = 0;
  Outcome* outcome = nullptr;
};

Entrant make_entrant(Contender& contender, const Case& c, const Scene& scene) {
  Entrant entrant;
  entrant.outcome = &contender.outcome;
  entrant.outcome->rods = static_cast<std::uint32_t>(scene.rods.size());
  if (contender.is_baseline) {
    const auto order = contender.arrangement == "natural" ? natural_order(scene) : colored_order(scene);
    entrant.stepper = make_baseline(scene, c.precision, order);
    return entrant;
  }
  Settings settings;
  settings.precision = c.precision;
  settings.layout = contender.layout;
  settings.isa = contender.isa;
  settings.threads = contender.threads;
  settings.stop.sweeps = sweeps;
  auto world = std::make_unique<WorldStepper>(scene, settings);
  const WorldInfo& info = world->world().info();
  for (const BlockInfo& block : info.blocks) entrant.outcome->bytes += block.bytes;
  entrant.outcome->bytes_per_sweep = sweep_bytes_per_rod(info, c.precision);
  entrant.outcome->threads = info.parallel ? info.threads : 1;
  entrant.world = world.get();
  entrant.stepper = std::move(world);
  return entrant;
}

double finite_stretch(const Entrant& entrant, const Scene& scene) {
  const double max = entrant.stepper->stretch(scene).max;
  if (!std::isfinite(max)) throw CheckFailed("stretch is not finite");
  return max;
}

/// Steps everyone to the same time, and sets how many steps a sample has. Worlds take as many as the fastest
/// needs.
void run_up(std::vector<Entrant>& entrants, const Scene& scene, Level level) {
  double fastest = 1e9;
  for (Entrant& entrant : entrants) {
    Outcome& outcome = *entrant.outcome;
    outcome.run_up_steps = run_up_steps(level);
    double step_s = entrant.stepper->run(outcome.run_up_steps, sweeps);
    outcome.run_up_stretch = finite_stretch(entrant, scene);
    outcome.steps = outcome.run_up_steps;
    if (level != Level::dram) {  // the very first step was slower, so that it does not count
      step_s = std::min(step_s, entrant.stepper->run(2, sweeps));
      outcome.steps += 2;
    }
    entrant.steps = static_cast<std::uint32_t>(std::ceil(sample_s / step_s));
    if (entrant.world) fastest = std::min(fastest, step_s);
  }
  for (Entrant& entrant : entrants) {
    if (entrant.world) entrant.steps = static_cast<std::uint32_t>(std::ceil(sample_s / fastest));
    entrant.warming = level == Level::dram ? 0 : (entrant.steps + 1) / 2;
  }
}

void take_sample(Entrant& entrant, bool with_long_step) {
  Outcome& outcome = *entrant.outcome;
  if (entrant.warming > 0) entrant.stepper->run(entrant.warming, sweeps);
  const double step_s = entrant.stepper->run(entrant.steps, sweeps);
  outcome.step_s.push_back(step_s);
  outcome.steps += entrant.warming + entrant.steps;
  if (!entrant.world || !with_long_step) return;
  const std::uint32_t long_steps = (entrant.steps + 1) / 2;
  outcome.sweep_s.push_back((entrant.stepper->run(long_steps, long_sweeps) - step_s) /
                            (long_sweeps - sweeps));
  outcome.steps += long_steps;
}

double ns_per_rod(const Outcome& outcome, double seconds_per_step) {
  return 1e9 * seconds_per_step / (double{1} * outcome.rods * sweeps);
}

}  // namespace

double Outcome::ns_per_projection(std::size_t round) const {
  return ns_per_rod(*this, step_s[round]);
}

double Outcome::least_ns() const {
  return ns_per_rod(*this, least(step_s));
}

double Outcome::median_ns() const {
  return ns_per_rod(*this, median(step_s));
}

double Outcome::median_sweep_ns() const {
  return sweep_s.empty() ? 0 : ns_per_rod(*this, sweeps * median(sweep_s));
}

std::string Contender::name(const Case& c) const {
  std::string name = is_baseline ? "baseline" : "relax";
  const auto append = [&name](std::string_view part) { name.append("/").append(part); };
  append(to_string(c.shape));
  append(number_name(c.precision));
  append(arrangement);
  if (!is_baseline) append(to_string(isa));
  append("threads:" + std::to_string(threads));
  append(size_name(c));
  return name;
}

void Contest::measure() {
  if (measured_) return;
  std::fprintf(stderr, "%s %s %s: %zu contenders\n", to_string(case_.shape).data(),
               number_name(case_.precision).data(), size_name(case_).c_str(), contenders_.size());
  const std::shared_ptr<const Scene> scene = scene_of(case_);
  std::vector<Entrant> entrants;
  for (Contender& contender : contenders_) entrants.push_back(make_entrant(contender, case_, *scene));
  run_up(entrants, *scene, case_.level);
  if (case_.level >= Level::l3)
    for (Entrant& entrant : entrants) entrant.stepper->extrapolate_beyond(4);
  for (std::uint32_t round = 0; round < rounds_; ++round)
    for (std::size_t i = 0; i < entrants.size(); ++i)
      take_sample(entrants[(round + i) % entrants.size()], case_.level != Level::dram || round % 4 == 0);

  const Entrant* first = nullptr;
  for (std::size_t i = 0; i < entrants.size(); ++i) {
    const Entrant& entrant = entrants[i];
    entrant.outcome->max_stretch = finite_stretch(entrant, *scene);
    if (!entrant.world) continue;
    entrant.outcome->state_hash = entrant.world->world().state_hash();
    if (!first) first = &entrant;
    if (entrant.outcome->state_hash != first->outcome->state_hash)
      throw CheckFailed(contenders_[i].name(case_) + " ended in other bits than " +
                        contenders_[static_cast<std::size_t>(first - entrants.data())].name(case_));
  }
  measured_ = true;
}

const Contender* Contest::baseline(const std::string& order) const {
  const auto found = std::find_if(contenders_.begin(), contenders_.end(), [&](const Contender& contender) {
    return contender.is_baseline && contender.arrangement == order;
  });
  return found == contenders_.end() ? nullptr : &*found;
}

double Contest::speedup(std::size_t i, const std::string& order, std::size_t round) const {
  const Contender* base = baseline(order);
  return base ? base->outcome.step_s[round] / contenders_[i].outcome.step_s[round] : 0;
}

double Contest::median_speedup(std::size_t i, const std::string& order) const {
  std::vector<double> ratios;
  for (std::size_t round = 0; round < rounds_; ++round) ratios.push_back(speedup(i, order, round));
  return median(ratios);
}

}  // namespace plumb::bench
