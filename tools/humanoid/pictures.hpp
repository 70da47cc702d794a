#pragma once

#include <span>
#include <string>
#include <vector>

#include "plumb/measures.hpp"
#include "plumb/scene.hpp"

namespace plumb::tools {

/// One run, as a row of drawn instants.
struct PoseRow {
  std::string title;
  Scene scene;  ///< what is drawn are its capsules; the last one is the ball
  std::vector<Frame> poses;
};

/// Seen from the side, +x to the right and +y up: limbs as rounded lines as thick as they are, the nearer
/// ones over the farther ones, the ball, the ground, and where the figure stood. A row for each run, instants
/// from left to right with their times; all rows to one scale. An SVG file's text.
std::string draw_poses(std::span<const PoseRow> rows);

}  // namespace plumb::tools
