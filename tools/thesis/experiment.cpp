#include "thesis/experiment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scenes/files/trajectory.hpp"
#include "scenes/runs/run.hpp"

namespace plumb::tools {
namespace {

std::vector<Frame> frames_at(const Scene& scene, const Settings& settings, std::vector<double> times) {
  std::vector<Frame> out;
  scenes::RunObserver observer;
  observer.save = [&](const Frame& frame) { out.push_back(frame); };
  observer.save_at = std::move(times);
  scenes::run_scene(scene, {.settings = settings, .duration = 1, .dt = frame_length}, {}, observer);
  return out;
}

}  // namespace

std::vector<Variant> all_variants() {
  std::vector<Variant> out;
  for (const Weights weights : {Weights::mass, Weights::equal}) {
    for (const Gradient gradient : {Gradient::new_, Gradient::old, Gradient::mid})
      out.push_back({weights, gradient});
  }
  return out;
}

std::string name_of(const Variant& variant) {
  return std::string(to_string(variant.weights)) + ", " + std::string(to_string(variant.gradient));
}

Truth converge(const Scene& scene, std::uint32_t substeps) {
  Settings settings{.method = Method::relax};
  settings.gradient = Gradient::mid;
  settings.threads = 1;
  settings.stop = {.sweeps = 100000, .tolerance = 1e-10, .budget_us = {}};
  settings.substeps = substeps / 2;
  const std::vector<double> times = {0.5, 1};
  const std::vector<Frame> coarse = frames_at(scene, settings, times);
  settings.substeps = substeps;
  Truth truth{.frames = frames_at(scene, settings, times)};
  for (std::size_t i = 0; i < coarse.size(); ++i) {
    truth.uncertainty =
        std::max(truth.uncertainty,
                 rms_distance(truth.frames[i].positions, coarse[i].positions) / bounding_diagonal(scene));
  }
  return truth;
}

Measured measure(const Scene& scene, const Truth& truth, const Settings& settings) {
  Measured out{.settings = settings, .us_per_frame = std::numeric_limits<double>::infinity()};
  const scenes::RunPlan plan{.settings = settings, .duration = 1, .dt = frame_length};
  // Short runs are repeated, so that the least time is not one that the system interrupted.
  double spent = 0;
  for (int repetition = 0; repetition < 20 && (repetition == 0 || spent < 0.03); ++repetition) {
    const scenes::RunResult run = scenes::run_scene(scene, plan, truth.frames);
    out.us_per_frame = std::min(out.us_per_frame, 1e6 * run.wall_s / static_cast<double>(run.frames));
    out.error = run.position_error.back().relative;
    out.stretch_rms = run.stretch.rms;
    out.stretch_max = run.stretch.max;
    // A chain that keeps its length lies within one length of its root, so two of them are within two.
    out.stable = run.sound() && out.error <= 2;
    spent += run.wall_s;
  }
  return out;
}

double distance_of_motions(const Scene& one, const Scene& other, const Settings& settings) {
  const std::vector<Frame> a = frames_at(one, settings, {1});
  const std::vector<Frame> b = frames_at(other, settings, {1});
  return rms_distance(a.back().positions, b.back().positions) / bounding_diagonal(one);
}

double time_to_rest(const Scene& scene, const Settings& settings, double limit) {
  double moving_until = 0;
  std::vector<Vec3> before;
  scenes::RunObserver observer;
  // The speed over a frame comes from positions. It is the same measure whatever a method takes for its
  // velocity.
  observer.save = [&](const Frame& frame) {
    for (std::size_t i = 0; i < before.size(); ++i) {
      if (!(norm(frame.positions[i] - before[i]) <= 0.01 * frame_length)) moving_until = frame.t;
    }
    before = frame.positions;
  };
  scenes::run_scene(scene, {.settings = settings, .duration = limit, .dt = frame_length}, {}, observer);
  return moving_until + frame_length > limit ? -1 : moving_until;
}

}  // namespace plumb::tools
