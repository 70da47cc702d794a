#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "plumb/measures.hpp"
#include "plumb/scene.hpp"

namespace plumb::tools {

/// One instant as VTK's XML PolyData, in base64: a point for each particle with `velocity` (m/s), `mass` (kg,
/// with its share of its rods; 0 if fixed) and `fixed`; a vertex for each particle without rods, then a line
/// for each rod, with `rod` (its number; -1 for vertices), `stretch` (relative) and `radius` (m, of the
/// capsule or ball around it; 0 without).
std::string vtp_text(const Scene& scene, const Frame& frame);

/// A folder that ParaView opens as one animation: frame_000000.vtp and so on, and run.pvd with their times.
class VtkSeries {
 public:
  /// Makes the folder if need be. Keeps a reference to the scene. Throws InputError if the folder cannot be
  /// written.
  VtkSeries(std::filesystem::path folder, const Scene& scene);
  VtkSeries(std::filesystem::path, Scene&&) = delete;
  void add(const Frame& frame);
  /// Writes run.pvd; before that there is none.
  void finish();

 private:
  std::filesystem::path folder_;
  const Scene& scene_;
  std::vector<double> times_;
};

}  // namespace plumb::tools
