#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "plumb/world.hpp"
#include "profile/caches.hpp"

/// What plumb profile lets run: scenes, settings, and how much of each.
namespace plumb::tools {

/// How large a scene's state is.
enum class SceneSize : std::uint8_t { first_cache, last_cache, beyond };

/// A run whose counts are looked at.
struct WorkPlan {
  std::string scene;  ///< as load_scene() reads it
  Settings settings;  ///< Settings::stop.sweeps: sweeps a step of method relax
  std::uint32_t frames = 1;
  double dt = 1.0 / 60;  ///< s, of a frame
};

/// What a run did, in the units that counts are divided by.
struct WorkDone {
  std::uint64_t projections = 0;  ///< of method relax: times a rod was projected
  std::uint64_t rod_newtons = 0;  ///< of method direct: Newton steps of a tree times its rods
  std::uint64_t units() const { return projections + rod_newtons; }
};

/// Steps an existing world, whose rods must all be solved by the same method, its trees alike.
WorkDone do_work(World& world, std::uint32_t frames, double dt);

/// The plan from the start: loads the scene, compiles it and steps it.
WorkDone do_work(const WorkPlan& plan);

/// WorkDone as one line of JSON and back. Reading throws InputError if it is none.
std::string to_json_line(const WorkDone& done);
WorkDone parse_work(const std::string& line);

/// The same plan with `times` as many sweeps (relax) or frames (direct).
WorkPlan repeated(WorkPlan plan, std::uint32_t times);

/// The arguments that make `plumb` do the plan as a program of its own.
std::vector<std::string> worker_arguments(const WorkPlan& plan);

/// A shape of scene at one size, in one layout, solved by one method.
struct ProfileCase {
  std::string shape;  ///< chain, net, ensemble or graph
  SceneSize size = SceneSize::first_cache;
  WorkPlan plan;
};

struct CaseChoice {
  CachePair caches;
  Precision precision = Precision::single;
  Isa isa = Isa::scalar;
  bool quick = false;  ///< no scenes between the two caches, fewer layouts, smaller scenes outside both
  std::vector<SweepOrder> orders = {SweepOrder::gauss_seidel, SweepOrder::jacobi};
};

/// Every case, layouts innermost, so that cases of the same scene follow one another; method direct last.
std::vector<ProfileCase> list_cases(const CaseChoice& choice);

/// Bytes that one Newton step of method direct reads and writes per rod before any cache, on a tree of
/// massless rods that hangs from one fixed particle: numbers of the logical vectors of
/// kernel/simd/tree/tree_kernels.hpp, each counted once on the way from the tips to the root and once on the
/// way back.
double newton_bytes(Gradient gradient, Precision precision);

}  // namespace plumb::tools
