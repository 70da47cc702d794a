#pragma once

#include <string>
#include <string_view>

#include "scenes/basics/json.hpp"
#include "scenes/runs/machine.hpp"
#include "scenes/runs/run.hpp"

/// The record of a run as JSON. All in SI units but where a name says otherwise; a number that is not finite
/// or has no meaning for the scene is null.
namespace plumb::scenes {

Json machine_json(const Machine& machine);

/// Settings as the command spells them; what is left to plumb is "auto", 0 threads or null.
Json settings_json(const RunPlan& plan);

/// scene, method, settings, machine, rods, particles, islands, frames, steps (substeps), sweeps (over
/// blocks), newton, rod_projections, wall_s, ns_per_rod_frame, stretch, energy (relative to energy_range();
/// null without gravity), position_error, stopped_by, skipped, mid_guarded, frozen_islands,
/// projected_position,
/// unprojected_islands, projected_velocity, state_hash.
Json report_json(std::string_view scene, const RunPlan& plan, const RunResult& result,
                 const Machine& machine);

/// How a world laid out a scene.
Json world_json(const WorldInfo& info);

/// "0x" and sixteen digits.
std::string hash_text(std::uint64_t hash);

/// The text of a JSON file.
std::string format_json(const Json& value);

}  // namespace plumb::scenes
