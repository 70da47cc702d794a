#include "profile/work.hpp"

#include <algorithm>
#include <cmath>

#include "plumb/error.hpp"
#include "scenes/basics/json.hpp"
#include "scenes/basics/numbers.hpp"
#include "scenes/files/scene_json.hpp"
#include "scenes/spec.hpp"

namespace plumb::tools {
namespace {

/// Sweeps are pipelined eight at a time through chains and nets. A count that is no multiple of eight would
/// mix passes of different depth.
constexpr double sweeps_together = 8;
/// The shorter of two runs does at least so many units. Start-up differs by some hundred misses from run to
/// run, which then does not show in the third decimal.
constexpr double least_units = 2e5;

constexpr std::uint32_t links_of_ensemble = 32;
constexpr std::uint32_t links_in_first_cache = 8;
constexpr std::uint32_t lanes = 16;

/// A rod takes so many bytes in float.
struct RodBytes {
  double state;  ///< Bytes of state and rods in the largest layout.
  double swept;  ///< Bytes of these that a sweep touches in the smallest layout.
};
RodBytes bytes_of(const std::string& shape) {
  if (shape == "chain" || shape == "ensemble") return {106, 28};
  if (shape == "net") return {73, 22};
  return {73, 48};  // All other shapes are graphs.
}
constexpr double direct_bytes = 170;  ///< Bytes of a rod's state under method direct.

/// Returns how many rods a scene of that size has in float. Its state takes half of a cache, or a sweep
/// touches more than the last cache holds. That cache has then forgotten all of it before the next sweep.
double rods_of(const CaseChoice& choice, SceneSize size, const RodBytes& bytes) {
  const auto first = static_cast<double>(choice.caches.first.bytes);
  const auto last = static_cast<double>(choice.caches.last.bytes);
  switch (size) {
    case SceneSize::first_cache:
      return first / 2 / bytes.state;
    case SceneSize::last_cache:
      return last / 2 / bytes.state;
    case SceneSize::beyond:
      break;
  }
  return (choice.quick ? 1.4 : 2.5) * last / bytes.swept;
}

/// A spec names a scene by its parameters, and says how many rods it has.
struct Spec {
  std::string text;
  double rods = 0;
};

Spec ensemble_spec(double rods, std::uint32_t links) {
  const std::uint32_t groups = std::max(1u, static_cast<std::uint32_t>(rods / links / lanes));
  return {"ensemble:chains=" + std::to_string(groups * lanes) + ",links=" + std::to_string(links),
          double{1} * groups * lanes * links};
}

/// Returns a scene of about that many rods.
Spec spec_of(const std::string& shape, double rods, SceneSize size) {
  if (shape == "chain") {
    const auto links = static_cast<std::uint32_t>(rods);
    return {"chain:links=" + std::to_string(links), double{1} * links};
  }
  if (shape == "net") {
    const auto side = static_cast<std::uint32_t>(std::sqrt(rods / 2));
    return {"net:width=" + std::to_string(side) + ",height=" + std::to_string(side), 2.0 * side * (side - 1)};
  }
  if (shape == "ensemble")
    return ensemble_spec(rods, size == SceneSize::first_cache ? links_in_first_cache : links_of_ensemble);
  const auto particles = static_cast<std::uint32_t>(rods / 2);
  return {"graph:particles=" + std::to_string(particles), 2.0 * particles};
}

std::vector<SceneSize> sizes_of(const CaseChoice& choice) {
  if (choice.quick) return {SceneSize::first_cache, SceneSize::beyond};
  return {SceneSize::first_cache, SceneSize::last_cache, SceneSize::beyond};
}

std::vector<LayoutChoice> layouts_of(const CaseChoice& choice, const std::string& shape, SceneSize size) {
  // Nothing misses inside the first cache, whatever the layout.
  if (size == SceneSize::first_cache) return {LayoutChoice::automatic};
  if (!choice.quick) return {LayoutChoice::aos, LayoutChoice::soa, LayoutChoice::aosoa};
  // Graphs are aos by themselves.
  if (shape == "graph") return {LayoutChoice::automatic};
  return {LayoutChoice::aos, LayoutChoice::automatic};
}

void append_relaxed(std::vector<ProfileCase>& cases, const CaseChoice& choice) {
  const double share = choice.precision == Precision::single ? 1 : 0.5;
  for (const char* shape : {"chain", "net", "ensemble", "graph"}) {
    for (const SceneSize size : sizes_of(choice)) {
      const Spec spec = spec_of(shape, share * rods_of(choice, size, bytes_of(shape)), size);
      const double sweeps = std::ceil(least_units / sweeps_together / spec.rods) * sweeps_together;
      for (const SweepOrder order : choice.orders)
        for (const LayoutChoice layout : layouts_of(choice, shape, size)) {
          ProfileCase one{shape, size, {.scene = spec.text, .settings = {}}};
          Settings& s = one.plan.settings;
          s.method = Method::relax;
          s.precision = choice.precision;
          s.order = order;
          s.layout = layout;
          s.isa = choice.isa;
          s.threads = 1;
          s.stop.sweeps = static_cast<std::uint32_t>(sweeps);
          cases.push_back(one);
        }
    }
  }
}

void append_direct(std::vector<ProfileCase>& cases, const CaseChoice& choice) {
  // Positions and lengths are double whatever the precision.
  const double per_rod = choice.precision == Precision::single ? direct_bytes : 1.5 * direct_bytes;
  for (const SceneSize size : {SceneSize::last_cache, SceneSize::beyond}) {
    if (choice.quick && size == SceneSize::beyond) continue;
    const Spec spec =
        ensemble_spec(rods_of(choice, size, {.state = per_rod, .swept = per_rod}), links_of_ensemble);
    for (const Gradient gradient : {Gradient::old, Gradient::mid}) {
      if (choice.quick && gradient == Gradient::old) continue;
      ProfileCase one{"ensemble", size, {.scene = spec.text, .settings = {}}};
      one.plan.dt = 1.0 / 480;
      one.plan.frames = static_cast<std::uint32_t>(std::max(2.0, std::ceil(least_units / 2 / spec.rods)));
      Settings& s = one.plan.settings;
      s.method = Method::direct;
      s.gradient = gradient;
      s.precision = choice.precision;
      s.isa = choice.isa;
      s.threads = 1;
      cases.push_back(one);
    }
  }
}

}  // namespace

WorkDone do_work(World& world, std::uint32_t frames, double dt) {
  StepReport total;
  for (std::uint32_t i = 0; i < frames; ++i) total += world.step(dt);
  const WorldInfo& info = world.info();
  const std::uint64_t rods_of_island = info.islands > 0 ? info.rods / info.islands : 0;
  return {.projections = total.rod_projections, .rod_newtons = total.newton * rods_of_island};
}

WorkDone do_work(const WorkPlan& plan) {
  World world(scenes::load_scene(plan.scene), plan.settings);
  return do_work(world, plan.frames, plan.dt);
}

std::string to_json_line(const WorkDone& done) {
  return scenes::Json{{"projections", done.projections}, {"rod_newtons", done.rod_newtons}}.dump() + "\n";
}

WorkDone parse_work(const std::string& line) {
  WorkDone done;
  try {
    scenes::read_json(line, [&](const scenes::json& value) {
      const scenes::Object object(value, "", {"projections", "rod_newtons"});
      done = {scenes::count(object, "projections"), scenes::count(object, "rod_newtons")};
    });
  } catch (const InputError&) {
    throw InputError("'" + line + "' does not say what a run did");
  }
  return done;
}

WorkPlan repeated(WorkPlan plan, std::uint32_t times) {
  (plan.settings.method == Method::relax ? plan.settings.stop.sweeps : plan.frames) *= times;
  return plan;
}

std::vector<std::string> worker_arguments(const WorkPlan& plan) {
  const Settings& s = plan.settings;
  std::string dt;
  scenes::append_exact(dt, plan.dt);
  std::vector<std::string> out{"profile", "worker", plan.scene};
  const auto add = [&](const char* name, std::string value) {
    out.emplace_back(name);
    out.push_back(std::move(value));
  };
  add("--method", std::string(to_string(s.method)));
  add("--layout", std::string(to_string(s.layout)));
  add("--precision", std::string(to_string(s.precision)));
  add("--threads", std::to_string(s.threads));
  add("--frames", std::to_string(plan.frames));
  add("--dt", dt);
  if (s.method == Method::relax) {
    add("--sweeps", std::to_string(s.stop.sweeps));
    add("--order", std::string(to_string(s.order)));
  }
  if (s.isa) add("--isa", std::string(to_string(*s.isa)));
  if (s.gradient) add("--gradient", std::string(to_string(*s.gradient)));
  return out;
}

std::vector<ProfileCase> list_cases(const CaseChoice& choice) {
  std::vector<ProfileCase> cases;
  append_relaxed(cases, choice);
  append_direct(cases, choice);
  return cases;
}

double newton_bytes(Gradient gradient, Precision precision) {
  // Gradient old works with the multipliers alone. Forwards it reads rod 4, mu 1, load 3 and 1/mass 1, and
  // writes two numbers of the elimination. Back it reads these two, the rod's vector 3, mu 1, 1/mass 1, load
  // 3 and delta 3, and writes mu 1 and delta 3. Gradients mid and new read rod 4, mu 1, load 3, delta 3 and
  // mass 1 towards the root, and write 16 numbers. Back they read these 16, mu 1 and delta 3, and write mu 1,
  // delta 3 and the change of delta 3.
  const int numbers = gradient == Gradient::old ? 9 + 2 + 13 + 4 : 12 + 16 + 20 + 7;
  return numbers * (precision == Precision::single ? 4.0 : 8.0);
}

}  // namespace plumb::tools
