#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "figure.hpp"

namespace plumb::bench {

inline constexpr double duration = 2;  ///< s, of all runs

/// What a run has come to.
struct Outcome {
  std::vector<Vec3> centers{};  ///< m, the limbs' centres of mass at the end
  double ms = 0;                ///< of stepping alone
};

/// One setting of one program.
struct Setting {
  std::string family{};            ///< without commas
  std::string name{};              ///< without commas
  std::function<Outcome()> run{};  ///< starts anew
};

/// MuJoCo, by `integrator` and equal steps.
Outcome run_mujoco(const std::vector<Limb>& limbs, const std::string& integrator, std::uint32_t steps);
/// MuJoCo's version.
std::string mujoco_version();

/// plumb, method direct with gradient old, by equal steps of a substep each. The scene's bodies are the
/// limbs.
Outcome run_plumb(const Scene& scene, std::uint32_t time_order, std::uint32_t steps);
/// plumb, method auto with an accuracy, by frames of 1/30 s.
Outcome run_plumb_to_accuracy(const Scene& scene, double accuracy);

}  // namespace plumb::bench
