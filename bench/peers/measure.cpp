#include "measure.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <limits>
#include <string>

namespace plumb::bench {
namespace {

using Clock = std::chrono::steady_clock;
using frontier::Point;
using frontier::Problem;

/// Rods with a larger strain than this count as torn.
constexpr double most_stretch = 1;
/// A path ends after this many levels without a smaller error. It does not end at the first, because chaotic
/// chains come near the truth by chance.
constexpr int most_vain_levels = 3;
/// A setting is timed again if it would be on its family's front were it this many times as fast. A larger
/// value times more settings.
constexpr double nearly = 1.5;
constexpr std::uint32_t most_repetitions = 20;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

bool all_finite(const Frame& frame) {
  return std::all_of(frame.positions.begin(), frame.positions.end(), is_finite) &&
         std::all_of(frame.velocities.begin(), frame.velocities.end(), is_finite);
}

/// Names one level of a path.
struct Setting {
  const PeerPath* path;
  std::uint32_t level;
};

struct Outcome {
  enum class End { sound, failed, late } end = End::failed;
  Point point{};
  std::string reason{};
};

/// Holds a problem and how another library is to see it.
class Course {
 public:
  explicit Course(const Problem& problem)
      : problem_(problem), links_(find_links(problem.scene)), start_(start_of(problem.scene)) {
    frames_ = std::lround(problem.duration * frames_per_second);
    energy_range_ = energy_range(problem.scene);
  }

  std::size_t links() const { return links_.size(); }

  /// Runs a setting. The run is late after `most_s` (s), set-up included.
  Outcome run(const Setting& setting, double most_s) const {
    const auto begin = Clock::now();
    const auto peer = make(setting);
    Frame now = start_;
    const double initial = energy_of(now);
    Outcome out;
    double wall = 0;
    for (long frame = 0; frame < frames_; ++frame) {
      const auto before = Clock::now();
      peer->step_frame();
      wall += seconds_since(before);
      peer->copy_state(now);
      if (!all_finite(now)) return out;
      out.point.stretch = std::max(out.point.stretch, measure_stretch(problem_.scene, now.positions).max);
      if (!(out.point.stretch <= most_stretch)) return out;
      out.point.energy_drift =
          std::max(out.point.energy_drift, std::abs(energy_of(now) - initial) / energy_range_);
      if (seconds_since(begin) > most_s) return {.end = Outcome::End::late};
    }
    out.point.position_error =
        rms_distance(now.positions, problem_.truth.back().positions) / bounding_diagonal(problem_.scene);
    out.point.ms = out.point.median_ms = 1e3 * wall / problem_.duration;
    out.point.setting = setting.path->name(setting.level);
    out.end = Outcome::End::sound;
    return out;
  }

  /// Returns ms per simulated second, of stepping alone.
  double time(const Setting& setting) const {
    const auto peer = make(setting);
    const auto before = Clock::now();
    for (long frame = 0; frame < frames_; ++frame) peer->step_frame();
    return 1e3 * seconds_since(before) / problem_.duration;
  }

 private:
  static Frame start_of(const Scene& scene) {
    Frame frame;
    for (const Particle& particle : scene.particles) frame.positions.push_back(particle.position);
    frame.velocities.resize(scene.particles.size());
    return frame;
  }
  std::unique_ptr<Peer> make(const Setting& setting) const {
    return setting.path->make({.scene = problem_.scene, .links = links_, .duration = problem_.duration},
                              setting.level);
  }
  double energy_of(const Frame& frame) const {
    return measure_energy(problem_.scene, frame.positions, frame.velocities).total();
  }

  const Problem& problem_;
  std::vector<Link> links_;
  Frame start_;
  long frames_ = 0;
  double energy_range_ = 0;
};

/// Holds settings beside the points that came of them.
struct Measured {
  std::vector<Setting> settings{};
  PeerResult result{};
};

Outcome try_run(const Course& course, const Setting& setting, double most_s) {
  try {
    return course.run(setting, most_s);
  } catch (const std::exception& error) {
    const std::string text = error.what();
    return {.end = Outcome::End::failed, .reason = text.substr(0, text.find('\n'))};
  }
}

void follow(const Course& course, const Problem& problem, const PeerPath& path, double most_s,
            Measured& out) {
  const auto start = Clock::now();
  double least = std::numeric_limits<double>::infinity();
  int vain = 0;
  for (std::uint32_t level = 0; level < path.levels; ++level) {
    const double before = seconds_since(start);
    if (before > most_s) return;
    Outcome outcome = try_run(course, {&path, level}, 2 * most_s);
    if (outcome.end == Outcome::End::late) return;
    if (outcome.end == Outcome::End::failed) {
      ++out.result.failed;
      if (!outcome.reason.empty()) out.result.reason = outcome.reason;
      continue;
    }
    // A level that is twice as fine takes about twice as long.
    const double took = seconds_since(start) - before;
    const double error = outcome.point.position_error;
    out.settings.push_back({&path, level});
    out.result.points.push_back(std::move(outcome.point));
    vain = error < least ? 0 : vain + 1;
    least = std::min(least, error);
    if (vain == most_vain_levels || error <= 2 * problem.truth_error) return;
    if (before + 3 * took > 2 * most_s) return;
  }
}

bool may_be_on_front(const std::vector<Point>& points, const Point& point) {
  return std::none_of(points.begin(), points.end(), [&](const Point& other) {
    return other.ms * nearly < point.ms && other.position_error <= point.position_error;
  });
}

void time_again(const Course& course, double most_s, Measured& measured) {
  std::vector<Point>& points = measured.result.points;
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (may_be_on_front(points, points[i])) chosen.push_back(i);
  if (chosen.empty()) return;
  std::vector<std::vector<double>> times(chosen.size());
  const auto start = Clock::now();
  double longest = 0;
  for (std::uint32_t round = 0; round < most_repetitions; ++round) {
    const double before = seconds_since(start);
    if (before + longest > most_s && round > 0) break;
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      const std::size_t i = (k + round) % chosen.size();
      times[i].push_back(course.time(measured.settings[chosen[i]]));
    }
    longest = std::max(longest, seconds_since(start) - before);
  }
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    Point& point = points[chosen[i]];
    // The run that was watched counts too.
    times[i].push_back(point.ms);
    std::sort(times[i].begin(), times[i].end());
    point.ms = times[i].front();
    point.median_ms = times[i][times[i].size() / 2];
    point.repetitions = static_cast<std::uint32_t>(times[i].size());
  }
}

}  // namespace

PeerResult measure(const Problem& problem, const PeerFamily& family, const PeerLimits& limits) {
  const Course course(problem);
  if (course.links() > family.most_links) return {};
  Measured measured;
  for (const PeerPath& path : family.paths) follow(course, problem, path, limits.path_s, measured);
  for (Point& point : measured.result.points) point.family = family.name;
  time_again(course, limits.repeat_s, measured);
  return std::move(measured.result);
}

}  // namespace plumb::bench
