#pragma once

#include <string>
#include <vector>

#include "plumb/measures.hpp"
#include "plumb/scene.hpp"
#include "scenes/basics/length_rate.hpp"

/// These types measure run time against error, with every method on the same scenes.
namespace plumb::frontier {

/// A problem is a scene, how long it runs, and where everything should then be.
struct Problem {
  std::string name{};   ///< Name for tables and files.
  std::string spec{};   ///< Scene, as scenes::load_scene reads it.
  double duration = 1;  ///< Simulated time in s: a whole number of frames of 1/20 s and of 1/60 s.
  bool is_tree = true;
  bool is_net = false;  ///< Whether it is wide, so that method direct solves it by its lines.
  bool touches =
      false;  ///< Whether things touch, so that few methods move it and its truth is a converged run.
  double patience = 1;                      ///< Factor on Limits::path_s: large scenes take long for a point.
  std::vector<scenes::LengthRate> rates{};  ///< Rods whose length changes all the time.

  Scene scene{};
  std::vector<Frame> truth{};  ///< One frame, at the end.
  std::string truth_source{};
  double truth_error = 0;  ///< What the truth is known to, relative to the diagonal.
};

/// Returns the default grid of problems.
std::vector<Problem> all_problems();

/// Loads the scene and finds its truth by Taylor series (plumb truth). Where loops are too many for that, it
/// extrapolates relaxed runs with doubling substeps until `most_s` are spent. Where things touch, the truth
/// is the last of direct runs with doubling substeps; it counts as known to its distance from the run before.
void prepare(Problem& problem, double most_s);

}  // namespace plumb::frontier
