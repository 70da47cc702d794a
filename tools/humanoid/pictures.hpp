#pragma once

#include <span>
#include <string>
#include <vector>

#include "plot/replay.hpp"
#include "plumb/measures.hpp"
#include "plumb/scene.hpp"

namespace plumb::tools {

/// A row shows one run as a series of drawn instants.
struct PoseRow {
  std::string title;
  Scene scene;  ///< Scene whose capsules are drawn. The last capsule is the ball.
  std::vector<Frame> poses;
  std::vector<Frame> motion{};  ///< All that was between, for a replay.
};

/// Draws runs as seen from the side, +x to the right and +y up. Limbs are rounded lines as thick as the
/// limbs, and nearer ones lie over farther ones. Every run has a row with its instants and times from left to
/// right, all at one scale. Returns an SVG file's text.
std::string draw_poses(std::span<const PoseRow> rows);

/// Returns the motions of runs as seen from the same side, with all that draw_poses() shows of them. Frames
/// are `frame_length` s apart.
Replay replay_poses(std::span<const PoseRow> rows, double frame_length);

}  // namespace plumb::tools
