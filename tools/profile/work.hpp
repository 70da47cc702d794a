#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "plumb/world.hpp"
#include "profile/caches.hpp"

/// These types say what plumb profile runs: scenes, settings, and how much of each.
namespace plumb::tools {

/// A scene's state fits the first cache, or the last one, or none.
enum class SceneSize : std::uint8_t { first_cache, last_cache, beyond };

/// A plan is a run whose counts are looked at.
struct WorkPlan {
  std::string scene;  ///< Scene, as load_scene() reads it.
  /// Settings of the world. Under method relax Settings::stop.sweeps is the number of sweeps in a step.
  Settings settings;
  std::uint32_t frames = 1;
  double dt = 1.0 / 60;  ///< Length of a frame, in s.
};

/// A run did so much, in the units that counts are divided by.
struct WorkDone {
  std::uint64_t projections = 0;  ///< Projections of rods, under method relax.
  std::uint64_t rod_newtons = 0;  ///< Newton steps of a tree times its rods, under method direct.
  std::uint64_t units() const { return projections + rod_newtons; }
};

/// Steps an existing world. The same method must solve all its rods, and its trees must be alike.
WorkDone do_work(World& world, std::uint32_t frames, double dt);

/// Does a plan from the start: it loads the scene, compiles it and steps it.
WorkDone do_work(const WorkPlan& plan);

/// Writes WorkDone as one line of JSON. Reading it back throws InputError if it is none.
std::string to_json_line(const WorkDone& done);
WorkDone parse_work(const std::string& line);

/// Returns the plan with `times` as many sweeps (relax) or frames (direct).
WorkPlan repeated(WorkPlan plan, std::uint32_t times);

/// Returns the arguments that make `plumb` do the plan as a program of its own.
std::vector<std::string> worker_arguments(const WorkPlan& plan);

/// A case is a shape of scene at one size, in one layout, solved by one method.
struct ProfileCase {
  std::string shape;  ///< Name of the shape: chain, net, ensemble or graph.
  SceneSize size = SceneSize::first_cache;
  WorkPlan plan;
};

struct CaseChoice {
  CachePair caches;
  Precision precision = Precision::single;
  Isa isa = Isa::scalar;
  /// Leaves out scenes between the two caches and some layouts, and makes scenes outside both smaller.
  bool quick = false;
  std::vector<SweepOrder> orders = {SweepOrder::gauss_seidel, SweepOrder::jacobi};
};

/// Lists every case, layouts innermost, so that cases of the same scene follow one another. Method direct
/// comes last.
std::vector<ProfileCase> list_cases(const CaseChoice& choice);

/// Returns the bytes that one Newton step of method direct reads and writes per rod before any cache. It is
/// for a tree of massless rods that hangs from one anchor. Numbers of the logical vectors of
/// kernel/simd/tree/tree_kernels.hpp count once towards the root and once on the way back.
double newton_bytes(Gradient gradient, Precision precision);

}  // namespace plumb::tools
