#pragma once

#include <string>
#include <string_view>

#include "plumb/world.hpp"
#include "scenes/runs/run.hpp"

/// A file with a snapshot of a run holds the bytes of World::save(), which say how many they are. Behind them
/// stands what was run, as JSON with a line for each setting, so that people read it, too.
namespace plumb::scenes {

/// Returns what stands behind a snapshot of a run.
std::string run_text(std::string_view scene, const RunPlan& plan);

/// Takes a world to the snapshot in the file `plan.resume`. Throws InputError with the file and the reason if
/// it cannot be read, is cut off, damaged or none, or if it is of another scene, or of a run with another
/// setting. Those that change no bits may differ: duration, threads, isa and the budget of steps. A snapshot
/// that a program saved may have nothing behind it.
void restore_run(World& world, const RunPlan& plan);

}  // namespace plumb::scenes
