#pragma once

#include <array>
#include <memory>
#include <vector>

/// Simbody behind standard types alone: its headers are C++17 and do not compile as C++20, where its
/// comparisons are ambiguous, and the rest of this program does not compile as C++17.
namespace plumb::bench {

using Triple = std::array<double, 3>;

/// A body whose origin is its centre of mass, on a ball joint.
struct SimbodyLink {
  int parent = -1;     ///< index of an earlier link; -1: the ground
  Triple joint{};      ///< m, in the parent's frame
  Triple offset{};     ///< m, from the joint to the centre of mass
  double mass = 0;     ///< kg
  double inertia = 0;  ///< kg·m², about every axis through the centre of mass
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
  double accuracy = 0;  ///< of a step, that chooses its length; semi_explicit_euler: unused
  double step = 0;      ///< s; the other methods: unused
  double duration = 1;  ///< s
};

class SimbodySystem {
 public:
  SimbodySystem(const std::vector<SimbodyLink>& links, const Triple& gravity, const SimbodyPlan& plan);
  ~SimbodySystem();

  /// To a time in s. Before the end of the plan's duration the state is interpolated, as Simbody does by
  /// default; at the end a step ends.
  void step_to(double time);
  /// Of the links' centres of mass, in m and m/s.
  void copy_state(std::vector<Triple>& positions, std::vector<Triple>& velocities) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace plumb::bench
