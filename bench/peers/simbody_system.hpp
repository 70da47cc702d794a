#pragma once

#include <array>
#include <memory>
#include <vector>

/// This file hides Simbody behind standard types. Its headers are C++17 and do not compile as C++20, where
/// its comparisons are ambiguous. The rest of this program does not compile as C++17.
namespace plumb::bench {

using Triple = std::array<double, 3>;

/// Describes a body whose origin is its centre of mass, on a ball joint.
struct SimbodyLink {
  int parent = -1;     ///< index of an earlier link; -1 is the ground
  Triple joint{};      ///< place in the parent's frame, m
  Triple offset{};     ///< from the joint to the centre of mass, m
  double mass = 0;     ///< mass, kg
  double inertia = 0;  ///< inertia about every axis through the centre of mass, kg·m²
};

enum class SimbodyMethod {
  semi_explicit_euler,
  semi_explicit_euler_2,
  verlet,
  runge_kutta_3,
  runge_kutta_merson
};

struct SimbodyPlan {
  SimbodyMethod method{};
  double accuracy = 0;  ///< accuracy of a step that chooses its length; semi_explicit_euler does not use it
  double step = 0;      ///< step, s; the other methods do not use it
  double duration = 1;  ///< s
};

class SimbodySystem {
 public:
  SimbodySystem(const std::vector<SimbodyLink>& links, const Triple& gravity, const SimbodyPlan& plan);
  ~SimbodySystem();

  /// Steps to a time in s. Before the end of the plan's duration the state is interpolated, as Simbody does
  /// by default. At the end a step ends.
  void step_to(double time);
  /// Copies positions (m) and velocities (m/s) of the links' centres of mass.
  void copy_state(std::vector<Triple>& positions, std::vector<Triple>& velocities) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace plumb::bench
