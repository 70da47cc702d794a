#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "plumb/measures.hpp"
#include "plumb/settings.hpp"
#include "scale/fit.hpp"

/// Times of a frame against links, for every method (thesis figures 4.7 and 4.8).
namespace plumb::tools {

constexpr double scale_frame = 1.0 / 60;  ///< s
constexpr int scale_frames = 60;          ///< of a timed second

/// All methods, as the kernel's table lists them.
std::vector<Method> methods_of_table();

struct ScaleOptions {
  std::vector<Method> methods = methods_of_table();
  std::vector<std::uint32_t> links = {1,    2,    5,     10,    20,    50,     100,    200,    500,    1000,
                                      2000, 5000, 10000, 20000, 50000, 100000, 200000, 500000, 1000000};
  std::uint32_t sweeps = 5;  ///< of relaxation, a frame
  std::uint32_t repetitions = 5;
  double seconds = 0.02;  ///< of stepping, at least, in a repetition
  double cell_s = 0.6;    ///< of stepping a chain for the first time; what needs more ends a series
  std::vector<Precision> precisions = {Precision::single, Precision::double_};  ///< of relaxation
  std::vector<SweepOrder> orders = {SweepOrder::gauss_seidel, SweepOrder::jacobi};
  double target = 0.01;  ///< position error at equal error, relative to the scene's diagonal
  std::vector<std::uint32_t> error_links = {5, 20, 100, 1000};  ///< lengths at equal error
  std::uint32_t most_fine = 300;  ///< links of a chain of 1 m: the truth of shorter ones takes minutes
  double path_s = 0.25;           ///< of wall-clock time for each way to refine a method's settings
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

/// Settings that a series starts with: a step a frame. The springs are as stiff as semi-implicit
/// Euler bears with some room: their fastest vibration turns by half a radian in a step.
Settings settings_of(const ScaleSeries& series, const ScaleOptions& options);
/// Those, in a few words.
std::string describe(const Settings& settings);

enum class CellOutcome : std::uint8_t {
  measured,
  alike,     ///< all threads were asked for, and World takes one
  refused,   ///< the method cannot move the scene
  broke,     ///< an island frozen, a substep not solved, or more energy won than there is
  too_slow,  ///< would have taken longer than the cap, even for ten frames
  left_out   ///< not tried, since a shorter chain already was too slow or would have been
};

/// A chain stepped by a series for a simulated second from rest, again and again.
struct ScaleCell {
  ScaleSeries series{};
  std::uint32_t links = 0;
  std::uint32_t sweeps = 0;
  std::uint32_t substeps = 1;  ///< a frame: the fewest of 1, 2, 4 ... 64 with which this chain does not break
  CellOutcome outcome = CellOutcome::left_out;
  unsigned threads = 1;  ///< that stepped it
  int frames = 0;        ///< of the second, that the cap let it take; at least 10
  double least_s = 0;    ///< of a frame, mean over those, over the repetitions
  double median_s = 0;
  Stretch stretch{};             ///< after those frames
  std::uint64_t state_hash = 0;  ///< then

  bool measured() const { return outcome == CellOutcome::measured; }
  double frames_per_s() const { return 1 / least_s; }
  double ns_per_rod() const { return 1e9 * least_s / links; }
};

/// Throws nothing for what a method cannot do: the outcome says so. `first_s` is set to what
/// stepping took the first time.
ScaleCell measure_cell(const ScaleSeries& series, std::uint32_t links, const Settings& settings,
                       const ScaleOptions& options, double& first_s);

/// All series over all lengths, until the cap ends each.
std::vector<ScaleCell> measure_cells(const ScaleOptions& options, const std::function<void()>& tick);

/// Links of a chain that ended in another state on all threads than on one, after as many frames, if any did.
std::optional<std::uint32_t> find_differing(const std::vector<ScaleCell>& cells);

/// The measured lengths of a series with the least seconds of a frame, by ascending links.
std::vector<Timing> timings_of(const std::vector<ScaleCell>& cells, const ScaleSeries& series);

}  // namespace plumb::tools
