#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "plumb/measures.hpp"
#include "plumb/settings.hpp"
#include "scenes/humanoid/humanoid.hpp"

/// A ball hits a standing humanoid (thesis section 4.5.4). The run measures how far the body goes, how long
/// it moves and what energy it receives.
namespace plumb::tools {

/// A run says what is thrown at whom, and how long it is followed.
struct HumanoidRun {
  scenes::HumanoidShape figure{.body = scenes::BodyType::medium};
  scenes::Ball ball;
  double dt = 1.0 / 60;  ///< Length of a frame, in s.
  std::uint32_t substeps = 8;
  double most = 10;  ///< Longest simulated time, in s. The run ends then though the body may still move.
  std::uint64_t seed = 0;  ///< Seed of the aim, which is up to 1 cm off, up and sideways. 0 aims exactly.
};

/// Makes the scene of a run. The ball is its last particle and its last capsule.
Scene make_scene(const HumanoidRun& run);

/// An instant keeps what is measured at the end of a frame, or at the start.
struct Instant {
  double t = 0;             ///< Time, in s.
  Vec3 center{};            ///< Centre of mass of the body, in m.
  double body_energy = 0;   ///< Kinetic and potential energy of the body without the ball, in J.
  double body_fastest = 0;  ///< Speed of the body's fastest particle, in m/s.
  Vec3 ball_velocity{};     ///< Velocity of the ball, in m/s.
  bool asleep = false;      ///< Whether the body slept all through the frame that ends here.
};

/// The impact begins in the first frame in which the ball's velocity changed by more than gravity explains,
/// and the body moves at its end. It lasts through the frames without a pause in which that velocity changed.
struct Impact {
  std::size_t first = 0, last = 0;  ///< Numbers of instants, each of which ends a frame of the impact.
};

/// World lets a body sleep that is slower than this speed for this duration.
inline constexpr double rest_speed = 0.02;    ///< Speed in m/s.
inline constexpr double rest_duration = 0.5;  ///< Duration in s.

std::optional<Impact> find_impact(std::span<const Instant> track, Vec3 gravity);
/// Returns the energy that the body gained by the impact, in J.
double energy_received(std::span<const Instant> track, const Impact& impact);
/// Returns the seconds from the impact until the body rests: it is slower than rest_speed until it sleeps.
/// There is none if it never rests.
std::optional<double> time_to_rest(std::span<const Instant> track, const Impact& impact);
/// Returns the distance along the ground between the body's centres of mass at the first and the last
/// instant, in m.
double distance_over_ground(std::span<const Instant> track);
/// Whether the body sleeps again after the impact. The ball may roll on, or lie far off.
bool body_rests(std::span<const Instant> track, const std::optional<Impact>& impact);

struct HumanoidResult {
  bool hit = false;
  double distance = 0;  ///< Distance that the body went, in m.
  std::optional<double> time_to_rest{};
  double energy_received = 0;  ///< Energy that the body received, in J.
  double max_stretch = 0;      ///< Largest strain of any rod at any frame's end.
  /// Deepest penetration of limbs and ball into the ground and of the ball into limbs, in m.
  double penetration = 0;
  double energy_before = 0;    ///< Energy of body and ball before the impact, in J.
  double energy_after = 0;     ///< Energy of body and ball after the impact, in J.
  double simulated = 0;        ///< Simulated time, in s.
  double wall_s = 0;           ///< Time in World::step alone, in s.
  std::uint64_t unsolved = 0;  ///< Substeps not solved, as StepReport counts them.
  std::uint64_t frozen = 0;    ///< Islands that went non-finite.
  bool finite = true;
  std::vector<Instant> track{};
  /// `poses_shown` frames from before the impact to the end, if they were asked for.
  std::vector<Frame> poses{};
  std::vector<Frame> motion{};  ///< All frames, if poses were asked for.
};
inline constexpr std::size_t poses_shown = 6;

HumanoidResult run_humanoid(const HumanoidRun& run, bool with_poses = false);

/// Returns the deepest penetration at this instant, in m. It looks at every capsule and every plane, and at
/// the ball, the last capsule, and all others.
double deepest_penetration(const Scene& scene, std::span<const Vec3> positions);

/// A case is one of the two runs of a figure of the thesis.
struct HumanoidCase {
  std::string figure;  ///< Number of the figure, such as "4.11".
  std::string name;    ///< Name of the case, such as "small velocity".
  HumanoidRun run;
};
/// Returns two cases for each figure from 4.11 to 4.14. The thesis says that the second goes farther, and
/// in 4.14 the first.
std::vector<HumanoidCase> thesis_cases(const HumanoidRun& usual);

/// A measure holds medians over three seeds, and the same in steps an eighth as long.
struct HumanoidMeasure {
  double distance = 0;
  /// Time from the impact to rest, in s; none if most are not at rest in time.
  std::optional<double> time_to_rest{};
  double energy_received = 0;
};
struct HumanoidComparison {
  HumanoidCase which;
  HumanoidMeasure usual{}, fine{};
  HumanoidResult shown{};                   ///< Run of the first seed, with its poses.
  double max_stretch = 0, penetration = 0;  ///< The worst of the three runs: strain, and penetration in m.
  bool sound = true;                        ///< Whether all runs were finite and solved, and the ball hit.
};
HumanoidMeasure median_of(std::span<const HumanoidResult> results);
/// Measures a case. It calls `tick` after each of its runs_of_a_case runs.
HumanoidComparison compare(const HumanoidCase& which, const std::function<void()>& tick);
inline constexpr std::uint32_t seeds_of_a_case = 3, finer = 8;
inline constexpr std::uint64_t runs_of_a_case = 2 * seeds_of_a_case;

}  // namespace plumb::tools
