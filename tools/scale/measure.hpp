#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "plumb/measures.hpp"
#include "plumb/settings.hpp"
#include "scale/fit.hpp"

/// These functions measure times of a frame against links, for every method (thesis figures 4.7 and 4.8).
namespace plumb::tools {

constexpr double scale_frame = 1.0 / 60;  ///< Length of a frame, in s.
constexpr int scale_frames = 60;          ///< Frames of a timed second.

/// Returns all methods, as the kernel's table lists them.
std::vector<Method> methods_of_table();

struct ScaleOptions {
  std::vector<Method> methods = methods_of_table();
  std::vector<std::uint32_t> links = {1,    2,    5,     10,    20,    50,     100,    200,    500,    1000,
                                      2000, 5000, 10000, 20000, 50000, 100000, 200000, 500000, 1000000};
  std::uint32_t sweeps = 5;  ///< Sweeps of relaxation in a frame.
  std::uint32_t repetitions = 5;
  double seconds = 0.02;  ///< Least time of stepping in a repetition, in s.
  /// Most time of stepping a chain for the first time, in s. A chain that needs more ends its series.
  double cell_s = 0.6;
  /// Precisions in which relaxation is measured.
  std::vector<Precision> precisions = {Precision::single, Precision::double_};
  std::vector<SweepOrder> orders = {SweepOrder::gauss_seidel, SweepOrder::jacobi};
  double target = 0.01;  ///< Position error at equal error, relative to the scene's diagonal.
  /// Links of the chains that are measured at equal error.
  std::vector<std::uint32_t> error_links = {5, 20, 100, 1000};
  std::uint32_t most_fine = 300;  ///< Most links of a chain of 1 m. The truth of longer ones takes minutes.
  double path_s = 0.25;           ///< Wall-clock time for each path that refines a method's settings, in s.
  std::string out;
  bool quiet = false;
};

/// A series is what is drawn as one line. Relaxation has one for each order of a sweep and each precision, on
/// one thread and on all. Every other method has one, in double on one thread.
struct ScaleSeries {
  Method method = Method::relax;
  SweepOrder order = SweepOrder::gauss_seidel;
  Precision precision = Precision::double_;
  bool all_threads = false;

  bool operator==(const ScaleSeries&) const = default;
};
std::vector<ScaleSeries> all_series(const ScaleOptions& options);
std::string name_of(const ScaleSeries& series);

/// Returns the settings that a series starts with, one step a frame. The springs are as stiff as
/// semi-implicit Euler bears with some room: their fastest vibration turns by half a radian in a step.
Settings settings_of(const ScaleSeries& series, const ScaleOptions& options);
/// Says in a few words what settings are.
std::string describe(const Settings& settings);

enum class CellOutcome : std::uint8_t {
  measured,
  alike,     ///< The series asks for all threads, but the world takes one.
  refused,   ///< The method cannot move the scene.
  broke,     ///< An island froze, a substep was not solved, or the chain gained more energy than there is.
  too_slow,  ///< Ten frames alone would have taken longer than the cap.
  left_out   ///< It was not tried, since a shorter chain was too slow or would have been.
};

/// A cell is a chain that a series steps for a simulated second from rest, again and again.
struct ScaleCell {
  ScaleSeries series{};
  std::uint32_t links = 0;
  std::uint32_t sweeps = 0;
  /// Substeps a frame: the fewest of 1, 2, 4 ... 64 with which this chain does not break.
  std::uint32_t substeps = 1;
  CellOutcome outcome = CellOutcome::left_out;
  unsigned threads = 1;  ///< Threads that stepped it.
  int frames = 0;        ///< Frames of the second that the cap allowed, at least 10.
  double least_s = 0;    ///< Time of a frame in s, mean over those frames: the least over the repetitions.
  double median_s = 0;
  Stretch stretch{};             ///< Strain after those frames.
  std::uint64_t state_hash = 0;  ///< Hash of the state after those frames.

  bool measured() const { return outcome == CellOutcome::measured; }
  double frames_per_s() const { return 1 / least_s; }
  double ns_per_rod() const { return 1e9 * least_s / links; }
};

/// Measures a cell. What a method cannot do throws nothing, since the outcome says so. `first_s` becomes the
/// time, in s, that stepping took the first time.
ScaleCell measure_cell(const ScaleSeries& series, std::uint32_t links, const Settings& settings,
                       const ScaleOptions& options, double& first_s);

/// Measures all series over all lengths, until the cap ends each.
std::vector<ScaleCell> measure_cells(const ScaleOptions& options, const std::function<void()>& tick);

/// Returns the links of a chain that ended in different states on all threads and on one, after as many
/// frames. There is none if all agree.
std::optional<std::uint32_t> find_differing(const std::vector<ScaleCell>& cells);

/// Returns the measured lengths of a series with the least time of a frame in s, sorted by links.
std::vector<Timing> timings_of(const std::vector<ScaleCell>& cells, const ScaleSeries& series);

}  // namespace plumb::tools
