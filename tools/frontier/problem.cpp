#include "frontier/problem.hpp"

#include <cmath>
#include <limits>

#include "plumb/error.hpp"
#include "plumb/world.hpp"
#include "scenes/basics/clock.hpp"
#include "scenes/spec.hpp"
#include "truth/truth.hpp"

namespace plumb::frontier {
namespace {

/// With more rods that close loops, Taylor series take too long.
constexpr std::size_t most_loops = 200;
/// Truths by extrapolation are refined until they are known to this, relative to the diagonal.
constexpr double wanted = 1e-8;
constexpr std::uint32_t most_converged = 1024;  // Substeps of a frame.

bool has_many_loops(const Scene& scene) {
  std::size_t movable = 0;
  for (const Particle& particle : scene.particles) movable += !particle.fixed;
  return scene.rods.size() > movable + most_loops;
}

void solve(Problem& problem) {
  const truth::Truth result =
      truth::solve(problem.scene, {.save_at = {problem.duration}, .tolerance = 1e-9, .rates = problem.rates});
  problem.truth = result.frames;
  problem.truth_source = "Taylor series";
  problem.truth_error = result.reached.worst();
}

std::vector<Vec3> relaxed_end(const Problem& problem, std::uint32_t substeps) {
  World world(
      problem.scene,
      {.method = Method::relax, .gradient = Gradient::old, .substeps = substeps, .stop = {.sweeps = 4}});
  for (double frame = 0; frame < std::round(60 * problem.duration); ++frame)
    if (world.step(1.0 / 60).frozen_islands > 0) throw InputError(problem.name + ": no truth by relaxation");
  std::vector<Vec3> positions(world.particle_count());
  world.copy_positions(positions);
  return positions;
}

/// Gradient old is of second order however far its sweeps go, as what is left of one substep is passed on to
/// the next.
void extrapolate(Problem& problem, double most_s) {
  const double diagonal = bounding_diagonal(problem.scene);
  std::vector<Vec3> coarse, last;
  problem.truth_error = std::numeric_limits<double>::infinity();
  for (std::uint32_t substeps = 16;; substeps *= 2) {
    const auto start = scenes::Clock::now();
    const std::vector<Vec3> fine = relaxed_end(problem, substeps);
    const double s = scenes::seconds_since(start);
    if (!coarse.empty()) {
      std::vector<Vec3> better(fine.size());
      for (std::size_t i = 0; i < fine.size(); ++i) better[i] = fine[i] + (1.0 / 3) * (fine[i] - coarse[i]);
      if (!last.empty()) problem.truth_error = rms_distance(better, last) / diagonal;
      last = std::move(better);
    }
    coarse = fine;
    if (problem.truth_error <= wanted || (std::isfinite(problem.truth_error) && 2 * s > most_s)) break;
  }
  problem.truth = {{.t = problem.duration, .positions = last, .velocities = std::vector<Vec3>(last.size())}};
  problem.truth_source = "extrapolated from relaxation";
}

std::vector<Vec3> direct_end(const Problem& problem, std::uint32_t substeps) {
  World world(problem.scene, {.method = Method::direct, .substeps = substeps, .threads = 1});
  for (double frame = 0; frame < std::round(60 * problem.duration); ++frame) {
    const StepReport report = world.step(1.0 / 60);
    if (report.frozen_islands + report.unsolved > 0) throw InputError(problem.name + ": no converged run");
  }
  std::vector<Vec3> positions(world.particle_count());
  world.copy_positions(positions);
  return positions;
}

/// Contact has no order: where something lands within a substep is chance. So nothing is extrapolated.
void converge(Problem& problem, double most_s) {
  const double diagonal = bounding_diagonal(problem.scene);
  std::vector<Vec3> last;
  problem.truth_error = std::numeric_limits<double>::infinity();
  std::uint32_t substeps = 16;
  for (;; substeps *= 2) {
    const auto start = scenes::Clock::now();
    std::vector<Vec3> fine = direct_end(problem, substeps);
    const double s = scenes::seconds_since(start);
    if (!last.empty()) problem.truth_error = rms_distance(fine, last) / diagonal;
    last = std::move(fine);
    if (problem.truth_error <= wanted || substeps >= most_converged ||
        (std::isfinite(problem.truth_error) && 2 * s > most_s))
      break;
  }
  problem.truth = {{.t = problem.duration, .positions = last, .velocities = std::vector<Vec3>(last.size())}};
  problem.truth_source = "direct with " + std::to_string(substeps) + " substeps against half as many";
}

}  // namespace

std::vector<Problem> all_problems() {
  std::vector<Problem> out;
  for (const int links : {5, 20, 100, 1000})
    for (const int mass : {1, 10, 1000})
      out.push_back({.name = "N" + std::to_string(links) + "_r" + std::to_string(mass),
                     .spec = "chain:links=" + std::to_string(links) + ",end_mass=" + std::to_string(mass)});
  out.push_back({.name = "elastic", .spec = "chain:links=20,end_mass=10,stiffness=1e4"});
  out.push_back({.name = "winch", .spec = "winch", .rates = {{.rod = 0, .rate = -0.5}}});
  out.push_back({.name = "wire", .spec = "wire", .patience = 4});
  out.push_back({.name = "rods5", .spec = "rods5"});
  out.push_back({.name = "tree", .spec = "tree"});
  out.push_back({.name = "humanoid", .spec = "humanoid"});
  out.push_back({.name = "ensemble", .spec = "ensemble:chains=64,links=32", .patience = 4});
  out.push_back({.name = "ring", .spec = "ring", .is_tree = false});
  out.push_back({.name = "truss", .spec = "truss:bays=20,fixed=2", .is_tree = false, .patience = 4});
  out.push_back({.name = "net32",
                 .spec = "net:width=32,height=32,level=1",
                 .duration = 0.5,
                 .is_tree = false,
                 .is_net = true,
                 .patience = 2});
  out.push_back({.name = "net128",
                 .spec = "net:width=128,height=128,level=1",
                 .duration = 0.5,
                 .is_tree = false,
                 .is_net = true,
                 .patience = 20});
  // They end before what touches in many places goes its own way, whatever the error.
  out.push_back({.name = "rope_lands",
                 .spec = "rope:links=20,coil=0.3,pitch=0.3,height=0.1",
                 .duration = 0.2,
                 .touches = true,
                 .patience = 4});
  out.push_back({.name = "net_on_sphere",
                 .spec = "drape:size=8,sphere=1",
                 .duration = 0.2,
                 .touches = true,
                 .patience = 10});
  out.push_back(
      {.name = "struck", .spec = "crowd:humanoids=1,hit=1", .duration = 0.4, .touches = true, .patience = 4});
  return out;
}

void prepare(Problem& problem, double most_s) {
  problem.scene = scenes::load_scene(problem.spec);
  if (problem.touches)
    converge(problem, most_s);
  else if (has_many_loops(problem.scene))
    extrapolate(problem, most_s);
  else
    solve(problem);
}

}  // namespace plumb::frontier
