#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "plumb/vec3.hpp"

namespace plumb::tools {

/// A thick line with round ends, or a ball if its ends are one place.
struct ReplayLine {
  double radius = 0;           ///< Radius in m.
  std::string_view look = "";  ///< Name of its colour: near, far or ball.
};

/// A run is told frame after frame from its start on, as it is seen from the side.
struct ReplayRun {
  std::string title;
  std::vector<ReplayLine> lines{};
  /// Places of each line's two ends in m: x to the right, y up, z towards the reader. A frame holds those of
  /// all lines.
  std::vector<std::vector<Vec3>> frames{};
};

/// Some runs that a page plays side by side, at one clock and one scale.
struct Replay {
  double frame_length = 0;              ///< Length of a frame, in s.
  double left = 0, right = 0, top = 0;  ///< Window above the ground, which is at y = 0, in m.
  std::vector<ReplayRun> runs{};
};

/// Returns the element of a page that holds a replay's numbers. Nothing of it is seen without the player.
std::string replay_data(const Replay& replay);

/// Returns the script that plays every replay that comes before it on a page. It loads nothing.
std::string replay_player();

}  // namespace plumb::tools
