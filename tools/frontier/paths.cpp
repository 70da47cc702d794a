#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <stdexcept>

#include "frontier/contest.hpp"
#include "plumb/reference/springs.hpp"
#include "plumb/world.hpp"
#include "scenes/basics/numbers.hpp"

namespace plumb::frontier {
namespace {

using scenes::short_number;

constexpr std::uint32_t most_substeps = 1u << 16;
constexpr double least_accuracy = 1e-10;
/// Scenes with loops and more rods than this are not moved as rigid bodies on springs, which have six
/// unknowns each. The factors of a 128 x 128 net take minutes, and neither a step nor the search for its
/// limit can be cut short.
constexpr std::size_t most_rigid_rods = 5000;

bool can_be_rigid(const Problem& problem) {
  return problem.is_tree || problem.scene.rods.size() <= most_rigid_rods;
}

bool double_substeps(Settings& settings) {
  settings.substeps *= 2;
  return settings.substeps <= most_substeps;
}

bool tighten(Settings& settings) {
  settings.accuracy = *settings.accuracy / 3;
  return *settings.accuracy >= least_accuracy;
}

/// Adds frames of 1/20 s for coarse answers, and of 1/60 s.
void add(std::vector<Path>& out, const std::string& family, const Settings& settings) {
  for (const std::uint32_t frames : {20u, 60u}) {
    Path path{.family = family, .settings = settings, .frames = frames, .refine = double_substeps};
    if (settings.accuracy) path.refine = tighten;
    out.push_back(path);
  }
}

std::vector<Path> relaxed(const std::string& family, bool over_relaxed,
                          SweepOrder order = SweepOrder::gauss_seidel) {
  std::vector<Path> out;
  for (const Precision precision : {Precision::double_, Precision::single})
    for (const Gradient gradient : {Gradient::new_, Gradient::old, Gradient::mid})
      for (const std::uint32_t sweeps : {1u, 4u, 16u, 64u}) {
        if (over_relaxed && (sweeps < 4 || gradient == Gradient::new_)) continue;
        if (precision == Precision::single && (sweeps > 4 || gradient == Gradient::new_)) continue;
        out.push_back({.family = family,
                       .settings = {.method = Method::relax,
                                    .precision = precision,
                                    .gradient = gradient,
                                    .order = order,
                                    .omega = over_relaxed ? (sweeps > 16 ? 1.9 : 1.7) : 1.0,
                                    .stop = {.sweeps = sweeps},
                                    .threads = 1},
                       .refine = double_substeps});
      }
  return out;
}

/// Returns whether a scene has bends or twists, which gradient old and other families do not move.
bool is_bent(const Scene& scene) {
  return !scene.bends.empty() || !scene.twists.empty();
}

std::vector<Path> direct(const std::string& family, const Problem& problem, Method method) {
  std::vector<Path> out;
  for (const Precision precision : {Precision::double_, Precision::single}) {
    const bool automatic = method == Method::automatic;
    for (const std::optional<Gradient> gradient :
         {std::optional<Gradient>{}, std::optional{Gradient::old}, std::optional{Gradient::mid}}) {
      if (gradient.has_value() == automatic) continue;
      if (gradient == Gradient::old && is_bent(problem.scene)) continue;
      Settings settings{.method = method, .precision = precision, .gradient = gradient, .threads = 1};
      add(out, family, settings);
      if (precision == Precision::double_ && gradient == Gradient::old) {
        for (const std::uint32_t order : {4u, 6u}) {
          Settings higher = settings;
          higher.time_order = order;
          add(out, family, higher);
        }
        if (problem.is_net) {
          Settings looser = settings;
          looser.stop.tolerance = 1e-6;
          add(out, family, looser);
        }
      }
      settings.accuracy = 0.3;
      add(out, family, settings);
    }
  }
  return out;
}

/// Returns the paths of what moves things that touch. Contact takes gradient old where it is solved, and new
/// where it is relaxed, so that none is set.
std::vector<Path> touching(const std::string& family) {
  std::vector<Path> out;
  if (family == "auto" || family == "direct") {
    Settings settings{.method = family == "auto" ? Method::automatic : Method::direct, .threads = 1};
    add(out, family, settings);
    settings.accuracy = 0.3;
    add(out, family, settings);
  }
  if (family == "relax")
    for (const std::uint32_t sweeps : {4u, 16u, 64u})
      add(out, family, {.method = Method::relax, .stop = {.sweeps = sweeps}, .threads = 1});
  return out;
}

/// Makes springs so stiff that the substep is a fixed share of what the integrators allow. The stiffer the
/// springs, the finer the substep.
std::vector<Path> sprung(const std::string& family, const Problem& problem, SpringModel model,
                         std::initializer_list<Integrator> integrators) {
  Settings settings{.method = Method::springs, .integrator = Integrator::implicit_euler, .threads = 1};
  settings.springs.model = model;
  if (model == SpringModel::particles) settings.mass = MassModel::lumped;
  settings.springs.stiffness = 1;
  const double unit = spring_stability(problem.scene, settings).frequency;  // Frequency in rad/s at 1 N/m.
  std::vector<Path> out;
  for (const Integrator integrator : integrators) {
    const bool implicit = integrator == Integrator::implicit_euler;
    // The share is of the time in which the stiffest oscillation turns by one radian.
    const double share = implicit ? 20 : 0.5;
    settings.integrator = integrator;
    settings.springs.damping_ratio = implicit ? 1 : 0.05;
    const auto fit = [share, unit](Settings& s) {
      s.springs.stiffness = std::pow(share * 60 * s.substeps / unit, 2);
    };
    fit(settings);
    out.push_back({.family = family, .settings = settings, .refine = [fit](Settings& s) {
                     const bool finer = double_substeps(s);
                     fit(s);
                     return finer;
                   }});
  }
  return out;
}

std::vector<Path> sprung(const std::string& family, const Problem& problem,
                         std::initializer_list<Integrator> integrators) {
  std::vector<Path> out = sprung(family, problem, SpringModel::particles, integrators);
  if (can_be_rigid(problem)) {
    const std::vector<Path> rigid = sprung(family, problem, SpringModel::rigid_rods, integrators);
    out.insert(out.end(), rigid.begin(), rigid.end());
  }
  return out;
}

std::vector<Path> multiplied(const std::string& family) {
  std::vector<Path> out;
  for (const Stabilization stabilization : {Stabilization::baumgarte, Stabilization::projection})
    for (const Integrator integrator : {Integrator::semi_implicit_euler, Integrator::rk4}) {
      Settings settings{.method = Method::multipliers, .integrator = integrator, .threads = 1};
      settings.multipliers.stabilization = stabilization;
      out.push_back({.family = family, .settings = settings, .refine = double_substeps});
    }
  return out;
}

std::vector<Path> reduced(const std::string& family) {
  std::vector<Path> out;
  for (const Integrator integrator : {Integrator::semi_implicit_euler, Integrator::rk2, Integrator::rk4})
    out.push_back({.family = family,
                   .settings = {.method = Method::featherstone, .integrator = integrator, .threads = 1},
                   .refine = double_substeps});
  return out;
}

/// Returns whether some rod is not rigid. Only families auto and direct move those, and change lengths.
bool has_laws(const Scene& scene) {
  return std::any_of(scene.rods.begin(), scene.rods.end(),
                     [](const Rod& rod) { return !rod.law.is_rigid(); });
}

/// Returns the path of a method about which only its row in the table is known.
std::vector<Path> plain(const std::string& family, Method method) {
  return {{.family = family, .settings = {.method = method, .threads = 1}, .refine = double_substeps}};
}

}  // namespace

std::vector<std::string> families_of(Method method) {
  if (method == Method::relax) return {"relax", "over-relaxed", "jacobi"};
  if (method == Method::springs) return {"springs", "implicit-springs"};
  return {std::string(to_string(method))};
}

std::vector<std::string> all_families() {
  std::vector<std::string> out;
  for (const MethodInfo& info : all_methods())
    for (const std::string& family : families_of(info.method)) out.push_back(family);
  return out;
}

std::vector<Path> paths_of(const std::string& family, const Problem& problem) {
  if (problem.touches) return touching(family);
  if (family == "auto") return direct(family, problem, Method::automatic);
  if (family == "direct") return direct(family, problem, Method::direct);
  if (has_laws(problem.scene) || is_bent(problem.scene) || !problem.rates.empty()) return {};
  if (family == "relax") return relaxed(family, false);
  if (family == "over-relaxed") return relaxed(family, true);
  if (family == "jacobi") return relaxed(family, false, SweepOrder::jacobi);
  if (family == "springs") return sprung(family, problem, {Integrator::semi_implicit_euler, Integrator::rk4});
  if (family == "implicit-springs") return sprung(family, problem, {Integrator::implicit_euler});
  if (family == "multipliers") return multiplied(family);
  if (family == "featherstone") return problem.is_tree ? reduced(family) : std::vector<Path>{};
  for (const MethodInfo& info : all_methods())
    if (info.name == family) return plain(family, info.method);
  throw std::logic_error("no family " + family);
}

std::string name_of(const Settings& s, std::uint32_t frames) {
  std::string out(to_string(s.method));
  const auto word = [&](std::string_view text) { out.append(1, ' ').append(text); };
  switch (s.method) {
    case Method::automatic:
      break;
    case Method::relax:
    case Method::direct:
      if (s.gradient || s.method == Method::relax) word(to_string(gradient_of(s)));
      if (s.method == Method::relax && s.order == SweepOrder::jacobi) word(to_string(s.order));
      if (s.method == Method::relax && s.omega != 1) word("w" + short_number(s.omega));
      if (s.time_order != 2) word("order " + std::to_string(s.time_order));
      break;
    case Method::springs:
      word(to_string(s.springs.model));
      word(to_string(integrator_of(s)));
      word(short_number(s.springs.stiffness, 2) + " N/m");
      break;
    case Method::multipliers:
      word(to_string(s.multipliers.stabilization));
      word(to_string(integrator_of(s)));
      break;
    case Method::featherstone:
      word(to_string(integrator_of(s)));
      break;
  }
  if (s.precision == Precision::single) word("float");
  word(std::to_string(frames) + " x");
  word(s.accuracy ? "a" + short_number(*s.accuracy, 1) : std::to_string(s.substeps));
  if (s.method == Method::relax) word("x " + std::to_string(s.stop.sweeps));
  if (s.method == Method::direct && s.stop.tolerance) word("to " + short_number(*s.stop.tolerance, 1));
  return out;
}

std::string picked_by(const WorldInfo& info) {
  std::string direct = "direct " + std::string(to_string(info.direct_gradient));
  if (info.changes_gradient) direct += "/mid";
  if (info.direct_time_order != 2) direct += " order " + std::to_string(info.direct_time_order);
  if (info.relaxed_rods == 0) return direct;
  return info.direct_rods == 0 ? "relax" : "relax and " + direct;
}

}  // namespace plumb::frontier
