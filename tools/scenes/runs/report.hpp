#pragma once

#include <string>
#include <string_view>

#include "scenes/basics/json.hpp"
#include "scenes/runs/machine.hpp"
#include "scenes/runs/run.hpp"

/// These functions record a run as JSON. All values are in SI units but where a name says otherwise. A number
/// that is not finite or has no meaning for the scene is null.
namespace plumb::scenes {

Json machine_json(const Machine& machine);

/// Returns settings as the command spells them. What is left to plumb is "auto", 0 threads or null.
Json settings_json(const RunPlan& plan);

/// Returns all that tools/README.md lists for reports. It takes the counters from counters.hpp. Energy is
/// relative to energy_range(), and null without gravity.
Json report_json(std::string_view scene, const RunPlan& plan, const RunResult& result,
                 const Machine& machine);

/// Describes how a world laid out a scene.
Json world_json(const WorldInfo& info);

}  // namespace plumb::scenes
