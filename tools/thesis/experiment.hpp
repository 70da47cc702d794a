#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "plumb/measures.hpp"
#include "plumb/scene.hpp"
#include "plumb/settings.hpp"

/// The experiment of the thesis's section 4.4, measured: a chain whose last link is heavy, solved with
/// corrections weighted by mass (eq. 4.7) and with equal ones (eq. 4.6).
namespace plumb::tools {

inline constexpr double frame_length = 1.0 / 60;  ///< s

/// One way to correct a rod.
struct Variant {
  Weights weights;
  Gradient gradient;
};
std::vector<Variant> all_variants();
std::string name_of(const Variant& variant);

/// Where a chain really is at some times, and how sure that is.
struct Truth {
  std::vector<Frame> frames;
  double uncertainty = 0;  ///< relative to the scene's diagonal
};

/// The truth of chain:links=20,end_mass=10 at 0.5 s and 1 s, from an independent high-order method, as CSV;
/// known to 1e-9.
std::string_view chain_truth_csv();

/// From plumb itself: gradient mid, double, rods kept to 1e-10, `substeps` a frame of 1/60 s; at 0.5 s and 1
/// s. The uncertainty is the distance to the same with half the substeps; for a second-order method that is
/// about three times the error of the finer one.
Truth converge(const Scene& scene, std::uint32_t substeps);

/// One run of a second in frames of 1/60 s.
struct Measured {
  Settings settings;
  double error = 0;         ///< position error at 1 s relative to the scene's diagonal
  double stretch_rms = 0;   ///< over rods and frames
  double stretch_max = 0;   ///< of any rod at any frame's end
  double us_per_frame = 0;  ///< least of several runs
  bool stable = true;  ///< no island was frozen, and no particle is where rods of fixed length cannot take it
};
Measured measure(const Scene& scene, const Truth& truth, const Settings& settings);

/// RMS distance at 1 s between what two scenes of the same particles do, relative to the diagonal.
double distance_of_motions(const Scene& one, const Scene& other, const Settings& settings);

/// Seconds until no particle moves faster than 1 cm/s any more; negative if that is not within `limit` s.
double time_to_rest(const Scene& scene, const Settings& settings, double limit);

}  // namespace plumb::tools
