#include "scenes/runs/report.hpp"

#include "scenes/basics/lists.hpp"
#include "scenes/runs/counters.hpp"

namespace plumb::scenes {
namespace {

/// Returns null where nothing can touch.
Json contact_json(const RunResult& result) {
  if (result.info.linkages == 0) return nullptr;
  Json json;
  add_counters(json, "contact", result.total);
  return json;
}

Json budget_json(const RunPlan& plan, const RunResult& result) {
  if (!plan.step_budget_us) return nullptr;
  Json json{{"late_frames", result.late_frames}, {"longest_step_us", result.longest_step_us}};
  add_counters(json, "budget", result.total);
  return json;
}

Json skipped_json(const RunResult& result) {
  Json json;
  add_counters(json, "skipped", result.total);
  json["per_rod_weights"] = result.info.skipped_per_rod_weights;
  json["drag"] = result.info.skipped_drag;
  return json;
}

/// Returns the method that was asked for, or what `auto` picked, if it picked the same for all.
Method method_of(const RunPlan& plan, const RunResult& result) {
  const Method asked = plan.settings.method;
  const bool relaxes_crowds = result.info.relaxed_rods == 0 && result.total.rod_projections > 0;
  return asked != Method::automatic || relaxes_crowds ? asked
         : result.info.linkages > 0                   ? Method::direct
         : result.info.direct_rods == 0               ? Method::relax
         : result.info.relaxed_rods == 0              ? Method::direct
                                                      : asked;
}

Json problems_json(const RunResult& result) {
  Json out = Json::array();
  for (const Problem& problem : result.problems) {
    Json item{{"kind", to_string(problem.kind)}, {"particle", problem.particle}};
    if (problem.kind == Problem::Kind::stretched)
      item.update({{"rod", problem.rod}, {"strain", problem.strain}});
    out.push_back(item);
  }
  return out;
}

Json errors_json(const RunResult& result) {
  Json errors = Json::array();
  for (const PositionError& e : result.position_error) {
    errors.push_back({{"t", e.t}, {"rms_m", e.rms_m}, {"relative", e.relative}});
  }
  return errors;
}

Json tension_errors_json(const RunResult& result) {
  Json errors = Json::array();
  for (const TensionError& e : result.tension_error)
    errors.push_back({{"t", e.t}, {"rms_n", e.rms_n}, {"relative", e.relative}});
  return errors;
}

Json tension_json(const RunPlan& plan, const RunResult& result) {
  if (!plan.settings.tensions) return nullptr;
  return {{"max", result.largest_tension}, {"max_rod", result.most_tense_rod}};
}

}  // namespace

Json machine_json(const Machine& machine) {
  return {{"cpu", machine.cpu},           {"isa", machine.isa},     {"threads", machine.threads},
          {"compiler", machine.compiler}, {"flags", machine.flags}, {"commit", machine.commit}};
}

Json settings_json(const RunPlan& plan) {
  const Settings& s = plan.settings;
  std::string winches;
  for (const auto& [rod, rate] : plan.rates)
    append_item(winches, Json(rod).dump() + ":" + Json(rate).dump(), ",");
  return {{"method", to_string(s.method)},
          {"duration", plan.duration},
          {"dt", plan.dt},
          {"winch", winches},
          {"substeps", s.substeps},
          {"time_order", s.time_order},
          {"accuracy", s.accuracy},
          {"most_work", s.most_work},
          {"sleep_time", s.sleep_time},
          {"length_scale", s.contact.length_scale},
          {"sweeps", s.stop.sweeps},
          {"tolerance", s.stop.tolerance},
          {"budget_us", s.stop.budget_us},
          {"step_budget_us", plan.step_budget_us},
          {"order", to_string(s.order)},
          {"omega", s.omega},
          {"weights", to_string(s.weights)},
          {"gradient", to_string(gradient_of(s))},
          {"mass", to_string(mass_model_of(s))},
          {"integrator", to_string(integrator_of(s))},
          {"springs", to_string(s.springs.model)},
          {"stiffness", s.springs.stiffness},
          {"damping_ratio", s.springs.damping_ratio},
          {"stabilization", to_string(s.multipliers.stabilization)},
          {"baumgarte_rate", s.multipliers.baumgarte_rate},
          {"tensions", s.tensions},
          {"contacts", s.contacts},
          {"layout", to_string(s.layout)},
          {"precision", to_string(s.precision)},
          {"threads", s.threads},
          {"isa", s.isa ? to_string(*s.isa) : Json("auto")}};
}

Json report_json(std::string_view scene, const RunPlan& plan, const RunResult& result,
                 const Machine& machine) {
  Json json{
      {"scene", scene},
      {"method", to_string(method_of(plan, result))},
      {"settings", settings_json(plan)},
      {"machine", machine_json(machine)},
      {"relaxed_rods", result.info.relaxed_rods},
      {"direct_rods", result.info.direct_rods},
      {"direct_gradient",
       result.info.direct_rods > 0 ? Json(to_string(result.info.direct_gradient)) : nullptr},
      {"changes_gradient", result.info.changes_gradient},
      {"direct_time_order", result.info.direct_rods > 0 ? Json(result.info.direct_time_order) : nullptr},
      {"rods", result.info.rods},
      {"particles", result.info.particles},
      {"islands", result.info.islands},
      {"start", result.start},
      {"frames", result.frames},
  };
  add_counters(json, "", result.total);
  const EnergyDrift& energy = result.energy;
  json.update({
      {"stopped_by", to_string(result.total.stopped_by)},
      {"skipped", skipped_json(result)},
      {"contact", contact_json(result)},
      {"budget", budget_json(plan, result)},
      {"wall_s", result.wall_s},
      {"ns_per_rod_frame", result.ns_per_rod_frame()},
      {"stretch",
       {{"rms", result.stretch.rms}, {"max", result.stretch.max}, {"max_rod", result.stretch.max_rod}}},
      {"energy",
       {{"initial", energy.initial / energy.range},
        {"final", energy.final / energy.range},
        {"drift_max", energy.drift_max / energy.range}}},
      {"position_error", errors_json(result)},
      {"tension", tension_json(plan, result)},
      {"tension_error", tension_errors_json(result)},
      {"problems", problems_json(result)},
      {"projected_position", result.info.projected_position},
      {"unprojected_islands", result.info.unprojected_islands},
      {"projected_velocity", result.info.projected_velocity},
      {"state_hash", hash_text(result.state_hash)},
  });
  return json;
}

Json world_json(const WorldInfo& info) {
  Json blocks = Json::array();
  for (const BlockInfo& b : info.blocks) {
    blocks.push_back({{"shape", b.shape},
                      {"layout", b.layout},
                      {"islands", b.islands},
                      {"particles", b.particles},
                      {"rods", b.rods},
                      {"colors", b.colors},
                      {"bytes", b.bytes},
                      {"bytes_per_projection", b.bytes_per_projection},
                      {"uniform_fraction", b.uniform_fraction}});
  }
  return {{"particles", info.particles},
          {"rods", info.rods},
          {"islands", info.islands},
          {"isa", to_string(info.isa)},
          {"threads", info.threads},
          {"parallel", info.parallel},
          {"skipped", {{"per_rod_weights", info.skipped_per_rod_weights}, {"drag", info.skipped_drag}}},
          {"projected_position", info.projected_position},
          {"projected_velocity", info.projected_velocity},
          {"memory", info.memory},
          {"blocks", blocks}};
}

}  // namespace plumb::scenes
