#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "plumb/measures.hpp"
#include "plumb/scene.hpp"
#include "scenes/runs/run.hpp"

namespace plumb::tools {

/// Returns one instant as VTK's XML PolyData, in base64. Each particle is a point with `velocity` (m/s),
/// `mass` (kg) and `fixed`. Its mass includes its share of its rods, and is 0 if it is fixed. Particles
/// without rods are vertices, and rods are lines. Both have `rod` (its number, or -1), `stretch` (strain) and
/// `radius` (m, of the capsule or ball around it, or 0).
///
/// Where tensions are asked for, rods have `tension` and points `reaction` (N, of anchors). By their numbers
/// in the scene there are `pin`, `spring` and `capsule` (N), `angle` and `torsion` (N m) as field data.
std::string vtp_text(const Scene& scene, const scenes::RunFrame& frame);

/// A series is a folder that ParaView opens as one animation: frame_000000.vtp and so on, and run.pvd with
/// their times.
class VtkSeries {
 public:
  /// Makes the folder if it is not there. It keeps a reference to the scene. Throws InputError if the folder
  /// cannot be written.
  VtkSeries(std::filesystem::path folder, const Scene& scene);
  VtkSeries(std::filesystem::path, Scene&&) = delete;
  void add(const scenes::RunFrame& frame);
  /// Writes run.pvd, which is not there before.
  void finish();

 private:
  std::filesystem::path folder_;
  const Scene& scene_;
  std::vector<double> times_;
};

}  // namespace plumb::tools
