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

/// A standing humanoid is hit by a ball (thesis section 4.5.4): how far it goes, until when it moves, what
/// energy it takes.
namespace plumb::tools {

/// What is thrown at whom, and how it is followed.
struct HumanoidRun {
  scenes::HumanoidShape figure{.body = scenes::BodyType::medium};
  scenes::Ball ball;
  double dt = 1.0 / 60;  ///< s, of a frame
  std::uint32_t substeps = 8;
  double most = 10;        ///< s, after which it ends though the body still moves
  std::uint64_t seed = 0;  ///< the ball is aimed up to 1 cm off, up and sideways; 0: not at all
};

/// The scene of a run. The ball is its last particle and its last capsule.
Scene make_scene(const HumanoidRun& run);

/// What is kept of every frame end, and of the start.
struct Instant {
  double t = 0;             ///< s
  Vec3 center{};            ///< m, the body's centre of mass
  double body_energy = 0;   ///< J, kinetic and potential, without the ball
  double body_fastest = 0;  ///< m/s, of its particles
  Vec3 ball_velocity{};     ///< m/s
  bool asleep = false;      ///< the body, all through the frame that ends here
};

/// From the frame in which the ball's velocity first changed by more than gravity has it, with the body
/// moving at its end, to the last one without a pause in which it did.
struct Impact {
  std::size_t first = 0, last = 0;  ///< numbers of instants: their frames are the ones that end there
};

/// Slower than this for this long is what World lets sleep.
inline constexpr double rest_speed = 0.02;    ///< m/s
inline constexpr double rest_duration = 0.5;  ///< s

std::optional<Impact> find_impact(std::span<const Instant> track, Vec3 gravity);
/// J: what the body has after the impact over what it had before.
double energy_received(std::span<const Instant> track, const Impact& impact);
/// Seconds from the impact until the body rests, that is, is slower than rest_speed until it sleeps; none if
/// it never does.
std::optional<double> time_to_rest(std::span<const Instant> track, const Impact& impact);
/// m, along the ground, between the body's centres of mass at the first and the last instant.
double distance_over_ground(std::span<const Instant> track);
/// Whether the body sleeps again after the impact. The ball may roll on, or lie far off.
bool body_rests(std::span<const Instant> track, const std::optional<Impact>& impact);

struct HumanoidResult {
  bool hit = false;
  double distance = 0;  ///< m
  std::optional<double> time_to_rest{};
  double energy_received = 0;  ///< J
  double max_stretch = 0;      ///< relative, of any rod at any frame end
  double penetration = 0;    ///< m, of limbs and ball into the ground and of the ball into limbs, the deepest
  double energy_before = 0;  ///< J, of body and ball
  double energy_after = 0;   ///< J
  double simulated = 0;      ///< s
  double wall_s = 0;         ///< in World::step alone
  std::uint64_t unsolved = 0;  ///< as StepReport has it
  std::uint64_t frozen = 0;    ///< islands that went non-finite
  bool finite = true;
  std::vector<Instant> track{};
  std::vector<Frame> poses{};  ///< `poses_shown` of them, from before the impact to the end, if asked for
};
inline constexpr std::size_t poses_shown = 6;

HumanoidResult run_humanoid(const HumanoidRun& run, bool with_poses = false);

/// m; the deepest, now, of every capsule into every plane and of the ball, the last capsule, into the others.
double deepest_penetration(const Scene& scene, std::span<const Vec3> positions);

/// One of the two runs of a figure of the thesis.
struct HumanoidCase {
  std::string figure;  ///< "4.11"
  std::string name;    ///< "small velocity"
  HumanoidRun run;
};
/// Two of each figure from 4.11 to 4.14; the second of each, but the first of 4.14, is the one that the
/// thesis says goes farther.
std::vector<HumanoidCase> thesis_cases(const HumanoidRun& usual);

/// Medians over three seeds, and the same in steps an eighth as long.
struct HumanoidMeasure {
  double distance = 0;
  std::optional<double> time_to_rest{};  ///< none if most are not at rest in time
  double energy_received = 0;
};
struct HumanoidComparison {
  HumanoidCase which;
  HumanoidMeasure usual{}, fine{};
  HumanoidResult shown{};                   ///< of the first seed, with poses
  double max_stretch = 0, penetration = 0;  ///< the worst of the three
  bool sound = true;                        ///< all finite, solved, and hit
};
HumanoidMeasure median_of(std::span<const HumanoidResult> results);
/// `tick` is called after each run; there are runs_of_a_case.
HumanoidComparison compare(const HumanoidCase& which, const std::function<void()>& tick);
inline constexpr std::uint32_t seeds_of_a_case = 3, finer = 8;
inline constexpr std::uint64_t runs_of_a_case = 2 * seeds_of_a_case;

}  // namespace plumb::tools
