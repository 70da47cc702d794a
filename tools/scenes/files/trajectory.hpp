#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "plumb/measures.hpp"

/// Trajectory and truth files: CSV with the header `t,particle,x,y,z,vx,vy,vz`, one row per particle and
/// saved time, in s, m and m/s, in the scene's particle order, with 17 significant digits.
namespace plumb::scenes {

inline constexpr std::string_view trajectory_header = "t,particle,x,y,z,vx,vy,vz\n";

/// Appends the rows of one frame; `frame.velocities` may be empty only if `frame.positions` is.
void append_frame(std::string& csv, const Frame& frame);
std::string format_trajectory(std::span<const Frame> frames);

/// `name` begins every message. Throws InputError with the line: a wrong header, a row that is not eight
/// finite numbers, times that do not rise, particles out of order or not the same number at every time, no
/// rows.
std::vector<Frame> parse_trajectory(std::string_view csv, std::string_view name);
std::vector<Frame> read_trajectory(const std::filesystem::path& path);

/// How far a frame lies from the truth at its time.
struct PositionError {
  double t = 0;         ///< s
  double rms_m = 0;     ///< m, RMS over all particles of the distance to the truth
  double relative = 0;  ///< rms_m divided by the diagonal of the scene's first bounding box
};
PositionError position_error(const Frame& frame, const Frame& truth, double diagonal);

}  // namespace plumb::scenes
