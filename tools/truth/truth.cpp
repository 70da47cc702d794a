#include "truth/truth.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "plumb/error.hpp"
#include "scenes/basics/numbers.hpp"
#include "truth/integrators/integrator.hpp"

namespace plumb::truth {
namespace {

/// The two solutions have these orders and tolerances. Both are near what rounding allows, so that their
/// distance also holds what rounding was magnified to. They share neither order nor steps.
constexpr Integrator::Settings check{.order = 20, .tolerance = 1e-17L};
constexpr Integrator::Settings best{.order = 26, .tolerance = 1e-19L};

/// The two are compared at so many times between the start and the end, for saying until when they
/// agreed.
constexpr int looks = 50;
/// Solutions that differ by this many times the tolerance never come back together.
constexpr double hopeless = 1e4;

void require_sense(const Scene& scene, const Plan& plan) {
  if (plan.save_at.empty()) throw InputError("no times to save are given");
  double before = 0;
  for (const double t : plan.save_at) {
    if (!std::isfinite(t) || t < 0) throw InputError("times to save must be finite and not negative");
    if (t < before) throw InputError("times to save must rise");
    before = t;
  }
  for (const auto& [rod, rate] : plan.rates)
    if (rod < scene.rods.size() && !(rod_length(scene, rod) + rate * plan.save_at.back() > 0))
      throw InputError("rod " + std::to_string(rod) +
                       " is reeled in to nothing before the last time to save");
  if (!(plan.tolerance >= 1e-15) || !(plan.tolerance < 1)) {
    throw InputError("the tolerance must be at least 1e-15, what the digits of a file hold, and less than 1");
  }
}

Accuracy compare(const Model& model, Real t, const State& a, const State& b) {
  Real position = 0, velocity = 0;
  for (std::size_t i = 0; i < a.x.size(); ++i) {
    const Real dx = norm(a.x[i] - b.x[i]), dv = norm(a.v[i] - b.v[i]);
    // The comparison is written so that what is not a number wins and stays.
    if (!(dx <= position) && !std::isnan(position)) position = dx;
    if (!(dv <= velocity) && !std::isnan(velocity)) velocity = dv;
  }
  return {static_cast<double>(t), static_cast<double>(position / model.diagonal),
          static_cast<double>(velocity / model.speed)};
}

Frame frame_of(const State& state, double t) {
  Frame frame{.t = t, .positions = {}, .velocities = {}};
  const auto round = [](const Point& p) {
    return Vec3{static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)};
  };
  for (const Point& p : state.x) frame.positions.push_back(round(p));
  for (const Point& p : state.v) frame.velocities.push_back(round(p));
  return frame;
}

std::string number(double value, int digits = 2) {
  return scenes::short_number(value, digits);
}

[[noreturn]] void give_up(const Accuracy& now, double good_until, double tolerance) {
  throw Unreachable("no solution to " + number(tolerance) + " at t = " + number(now.t, 6) +
                    " s: there two solutions lie " + number(now.position) +
                    " of the scene's diagonal apart, their velocities " + number(now.velocity) +
                    " of its speed; the motion is chaotic, or magnifies rounding too much, beyond t = " +
                    number(good_until, 6) + " s");
}

/// A frame is measured together with how far chains are twisted there.
struct Instant {
  Frame frame;
  std::vector<Real> twisted;
};

double energy_drift(const Scene& scene, const Plan& plan, const Instant& start,
                    const std::vector<Instant>& instants) {
  const double range = energy_range(scene);
  if (!(range > 0)) return 0;
  const auto energy = [&](const Instant& now) {
    double sum = measure_energy(scene, now.frame.positions, now.frame.velocities, plan.mass).total();
    for (std::size_t i = 0; i < now.twisted.size(); ++i)
      sum += twist_energy(scene, i, static_cast<double>(now.twisted[i]));
    return sum;
  };
  double worst = 0;
  for (const Instant& now : instants) worst = std::max(worst, std::abs(energy(now) - energy(start)));
  return worst / range;
}

}  // namespace

Truth solve(const Scene& scene, const Plan& plan) {
  require_sense(scene, plan);
  const Model model = make_model(scene, plan.mass, plan.rates);
  const State start = start_of(scene, model);
  Integrator one(model, start, check), two(model, start, best);
  Truth truth{.diagonal = static_cast<double>(model.diagonal),
              .speed = static_cast<double>(model.speed),
              .velocity_change = static_cast<double>(two.velocity_change()),
              .rows = two.solver().rows()};
  const Instant first{frame_of(two.state(), 0), two.state().twisted};
  std::vector<Instant> instants;
  const double end = plan.save_at.back();
  double good_until = 0;
  int next_look = 1;
  for (const double t : plan.save_at) {
    Accuracy now;
    for (bool there = false; !there;) {
      const double look = end * next_look / looks;
      // Times that are meant to be the same are not worth a step of a rounding error.
      there = !(look < t * (1 - 1e-9));
      if (look < t * (1 + 1e-9)) ++next_look;
      const double to = there ? t : look;
      one.advance_to(to);
      two.advance_to(to);
      now = compare(model, to, one.state(), two.state());
      if (now.worst() <= plan.tolerance) good_until = to;
      if (!(now.worst() <= hopeless * plan.tolerance)) give_up(now, good_until, plan.tolerance);
      if (plan.progress && end > 0) plan.progress(to / end);
    }
    if (!(now.worst() <= plan.tolerance)) give_up(now, good_until, plan.tolerance);
    truth.frames.push_back(frame_of(two.state(), t));
    instants.push_back({truth.frames.back(), two.state().twisted});
    truth.accuracy.push_back(now);
    if (now.worst() >= truth.reached.worst()) truth.reached.t = t;
    truth.reached.position = std::max(truth.reached.position, now.position);
    truth.reached.velocity = std::max(truth.reached.velocity, now.velocity);
  }
  if (plan.rates.empty()) truth.energy_drift = energy_drift(scene, plan, first, instants);
  truth.steps = two.steps();
  truth.redundant = two.solver().redundant();
  return truth;
}

}  // namespace plumb::truth
