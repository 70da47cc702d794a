#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "plumb/measures.hpp"
#include "plumb/scene.hpp"
#include "plumb/settings.hpp"

/// These functions measure the experiment of the thesis's section 4.4. A chain whose last link is heavy is
/// solved with corrections weighted by mass (eq. 4.7) and with equal ones (eq. 4.6).
namespace plumb::tools {

inline constexpr double frame_length = 1.0 / 60;  ///< Length of a frame, in s.

/// A variant is one way to correct a rod.
struct Variant {
  Weights weights;
  Gradient gradient;
};
std::vector<Variant> all_variants();
std::string name_of(const Variant& variant);

/// A truth says where a chain really is at some times, and how sure that is.
struct Truth {
  std::vector<Frame> frames;
  double uncertainty = 0;  ///< Distance by which it may be wrong, relative to the scene's diagonal.
};

/// Returns the truth of chain:links=20,end_mass=10 at 0.5 s and 1 s, as CSV. It comes from an independent
/// method of high order and is known to 1e-9.
std::string_view chain_truth_csv();

/// Computes a truth by plumb itself at 0.5 s and 1 s. It uses gradient mid in double, rods kept to 1e-10, and
/// `substeps` a frame of 1/60 s. The uncertainty is the distance to the same with half the substeps. For a
/// method of second order that is about three times the error of the finer one.
Truth converge(const Scene& scene, std::uint32_t substeps);

/// Holds what came of one second in frames of 1/60 s.
struct Measured {
  Settings settings;
  double error = 0;         ///< Position error at 1 s, relative to the scene's diagonal.
  double stretch_rms = 0;   ///< RMS strain over rods and frames.
  double stretch_max = 0;   ///< Largest strain of any rod at any frame's end.
  double us_per_frame = 0;  ///< Time of a frame in µs, the least of several runs.
  /// Whether no island was frozen, and no particle is where rods of fixed length cannot take it.
  bool stable = true;
};
Measured measure(const Scene& scene, const Truth& truth, const Settings& settings);

/// Returns the RMS distance at 1 s between two scenes of the same particles, relative to the diagonal.
double distance_of_motions(const Scene& one, const Scene& other, const Settings& settings);

/// Returns the time in s from which no particle moves faster than 1 cm/s. It is negative if that is not
/// within `limit` s.
double time_to_rest(const Scene& scene, const Settings& settings, double limit);

}  // namespace plumb::tools
