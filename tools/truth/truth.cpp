#include "truth/truth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
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

/// A mean is taken in so many equal parts. Tensions of a chain with a heavy end that falls were off by 2e-8
/// of the largest in one part of 1/60 s.
constexpr int parts = 4;

/// Gauss's five nodes on [0, 1] and their weights, whose error falls with the tenth power of the time.
constexpr struct {
  double at, weight;
} gauss[] = {{0.04691007703066800, 0.11846344252809454},
             {0.23076534494715845, 0.23931433524968324},
             {0.5, 0.28444444444444444},
             {0.76923465505284155, 0.23931433524968324},
             {0.95308992296933200, 0.11846344252809454}};

void require_sense(const Scene& scene, const Plan& plan) {
  if (plan.save_at.empty()) throw InputError("no times to save are given");
  double before = 0;
  for (const double t : plan.save_at) {
    if (!std::isfinite(t) || t < 0) throw InputError("times to save must be finite and not negative");
    if (t < before) throw InputError("times to save must rise");
    before = t;
  }
  before = 0;
  for (const double t : plan.save_at) {
    if (plan.mean_over > 0 && t > 0 && t - plan.mean_over < before * (1 - 1e-9))
      throw InputError("tensions are means over " + scenes::short_number(plan.mean_over) +
                       " s, so that times to save must lie as far apart");
    before = t;
  }
  for (const auto& [rod, rate] : plan.rates)
    if (rod < scene.rods.size() && !(rod_length(scene, rod) + rate * plan.save_at.back() > 0))
      throw InputError("rod " + std::to_string(rod) +
                       " is hauled in to nothing before the last time to save");
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

/// Takes both solutions through time and compares them.
class Pair {
 public:
  Pair(const Model& model, const State& start, const Plan& plan)
      : model_(model), plan_(plan), one_(model, start, check), two_(model, start, best) {}

  Integrator& better() { return two_; }

  /// Goes to a time of the plan. Throws Unreachable if the two are too far apart there or on the way.
  Accuracy go_to(double t) {
    const double end = plan_.save_at.back();
    Accuracy now;
    for (bool there = false; !there;) {
      const double look = end * next_look_ / looks;
      // Times that are meant to be the same are not worth a step of a rounding error.
      there = !(look < t * (1 - 1e-9));
      if (look < t * (1 + 1e-9)) ++next_look_;
      const double to = there ? t : look;
      one_.advance_to(to);
      two_.advance_to(to);
      now = compare(model_, to, one_.state(), two_.state());
      if (now.worst() <= plan_.tolerance) good_until_ = to;
      if (!(now.worst() <= hopeless * plan_.tolerance)) give_up(now, good_until_, plan_.tolerance);
      if (plan_.progress && end > 0) plan_.progress(to / end);
    }
    if (!(now.worst() <= plan_.tolerance)) give_up(now, good_until_, plan_.tolerance);
    return now;
  }

  /// Goes through the time before `t` and returns the mean tensions there. Adds to `apart` how far those of
  /// the two lie apart.
  std::vector<double> mean_tensions(double t, double& apart) {
    std::vector<Real> pulls(model_.rods.size()), others(pulls.size());
    for (int part = 0; part < parts; ++part)
      for (const auto& [at, weight] : gauss) {
        go_to(t - plan_.mean_over * (1 - (part + at) / parts));
        two_.add_pulls(weight / parts, pulls);
        one_.add_pulls(weight / parts, others);
      }
    Real most = 0, difference = 0;
    for (std::size_t rod = 0; rod < pulls.size(); ++rod) {
      most = std::max(most, std::abs(pulls[rod]));
      difference = std::max(difference, std::abs(pulls[rod] - others[rod]));
    }
    if (most > 0) apart = std::max(apart, static_cast<double>(difference / most));
    return {pulls.begin(), pulls.end()};
  }

 private:
  const Model& model_;
  const Plan& plan_;
  Integrator one_, two_;
  double good_until_ = 0;
  int next_look_ = 1;
};

}  // namespace

Truth solve(const Scene& scene, const Plan& plan) {
  require_sense(scene, plan);
  const Model model = make_model(scene, plan.mass, plan.rates);
  const State start = start_of(scene, model);
  Pair pair(model, start, plan);
  Integrator& two = pair.better();
  Truth truth{.diagonal = static_cast<double>(model.diagonal),
              .speed = static_cast<double>(model.speed),
              .velocity_change = static_cast<double>(two.velocity_change()),
              .rows = two.solver().rows()};
  const Instant first{frame_of(two.state(), 0), two.state().twisted};
  std::vector<Instant> instants;
  for (const double t : plan.save_at) {
    std::vector<double> tensions;
    if (plan.mean_over > 0)
      tensions = t > 0 ? pair.mean_tensions(t, truth.tension)
                       : std::vector<double>(model.rods.size(), std::numeric_limits<double>::quiet_NaN());
    const Accuracy now = pair.go_to(t);
    truth.frames.push_back(frame_of(two.state(), t));
    instants.push_back({truth.frames.back(), two.state().twisted});
    truth.frames.back().tensions = std::move(tensions);
    truth.accuracy.push_back(now);
    if (now.worst() >= truth.reached.worst()) truth.reached.t = t;
    truth.reached.position = std::max(truth.reached.position, now.position);
    truth.reached.velocity = std::max(truth.reached.velocity, now.velocity);
  }
  if (plan.rates.empty()) truth.energy_drift = energy_drift(scene, plan, first, instants);
  truth.steps = two.steps();
  truth.redundant = two.solver().redundant();
  if (plan.mean_over > 0 && truth.redundant > 0)
    throw InputError("tensions have no truth where rods are redundant: " + std::to_string(truth.redundant) +
                     " equations of loops are implied by the others");
  return truth;
}

}  // namespace plumb::truth
