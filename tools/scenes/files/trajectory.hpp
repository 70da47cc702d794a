#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "plumb/measures.hpp"

/// Trajectory and truth files are CSV with the header `t,particle,x,y,z,vx,vy,vz`. A row is one particle at
/// one saved time, in s, m and m/s. Particles come in the scene's order, and numbers have 17 significant
/// digits.
namespace plumb::scenes {

inline constexpr std::string_view trajectory_header = "t,particle,x,y,z,vx,vy,vz\n";

/// Appends the rows of one frame. `frame.velocities` may be empty only if `frame.positions` is.
void append_frame(std::string& csv, const Frame& frame);
std::string format_trajectory(std::span<const Frame> frames);

/// Files of tensions have the header `t,rod,tension`. A row is one rod at one saved time, in s and N. What is
/// not known is left empty.
inline constexpr std::string_view tensions_header = "t,rod,tension\n";
void append_tensions(std::string& csv, const Frame& frame);
/// Reads tensions into the frames of the same times. What is empty becomes not a number. Throws InputError as
/// parse_trajectory() does, and on a time that no frame has.
void parse_tensions(std::string_view csv, std::string_view name, std::vector<Frame>& frames);
void read_tensions(const std::filesystem::path& path, std::vector<Frame>& frames);

/// Reads frames. `name` begins every message. Throws InputError with the line on a wrong header, no rows, or
/// a row that is not eight finite numbers. It also throws where times do not rise, particles are out of
/// order, or their number changes.
std::vector<Frame> parse_trajectory(std::string_view csv, std::string_view name);
std::vector<Frame> read_trajectory(const std::filesystem::path& path);

/// Says how far a frame lies from the truth at its time.
struct PositionError {
  double t = 0;         ///< Time, in s.
  double rms_m = 0;     ///< RMS distance to the truth over all particles, in m.
  double relative = 0;  ///< That distance divided by the diagonal of the scene's first bounding box.
};
PositionError position_error(const Frame& frame, const Frame& truth, double diagonal);

/// Says how far tensions are from the truth at a frame's time.
struct TensionError {
  double t = 0;         ///< Time, in s.
  double rms_n = 0;     ///< RMS difference over all rods that both know, in N.
  double relative = 0;  ///< That difference divided by the RMS tension of the truth.
};
TensionError tension_error(const Frame& frame, const Frame& truth);

}  // namespace plumb::scenes
