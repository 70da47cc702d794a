#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "frontier/contest.hpp"

/// These functions keep points in a file, so that what other programs measure can stand on the same page.
namespace plumb::frontier {

inline constexpr std::string_view csv_header =
    "scene,family,setting,ms_per_s,median_ms_per_s,repetitions,position_error,stretch_max,energy_drift,on_"
    "front\n";

std::string csv_row(const std::string& scene, const Point& point);

/// It has a point and the name of its scene.
struct PeerPoint {
  std::string scene{};
  Point point{};
};

/// Reads points. Throws InputError with the line if a row is not as csv_header says.
std::vector<PeerPoint> read_points(const std::filesystem::path& file);

/// Adds the points of the problem's scene, and finds the front anew.
void add_peers(const std::vector<PeerPoint>& peers, const Problem& problem, std::vector<Point>& points);

}  // namespace plumb::frontier
