#include "humanoid/experiment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "plumb/world.hpp"
#include "scenes/basics/clock.hpp"
#include "scenes/basics/require.hpp"
#include "scenes/basics/seeded.hpp"
#include "scenes/humanoid/limbs.hpp"
#include "scenes/runs/depth.hpp"

namespace plumb::tools {
namespace {

using scenes::BodyType;
using scenes::inch;

/// A change of velocity in a frame that is larger counts as an impact, in m/s. Rounding is far below it, and
/// any real impact is far above.
constexpr double least_kick = 1e-6;

double kick(const Instant& before, const Instant& after, Vec3 gravity) {
  const Vec3 change = after.ball_velocity - before.ball_velocity;
  return norm(change - (after.t - before.t) * gravity);
}

/// These facts of a scene do not change: the ball's number and the masses.
struct Parts {
  explicit Parts(const Scene& scene) : ball(static_cast<std::uint32_t>(scene.particles.size()) - 1) {
    for (const double m : lumped_masses(scene)) mass += m;
  }
  std::uint32_t ball;
  double mass = 0;  ///< Mass of body and ball, in kg.
};

/// This holds the energies of body and ball apart, in J. `total` is their energy together.
Instant instant_of(const Scene& scene, const Parts& parts, const Frame& frame, double total) {
  const double ball_mass = scene.particles[parts.ball].mass;
  const Vec3 ball = frame.positions[parts.ball], velocity = frame.velocities[parts.ball];
  const Vec3 center = measure_momentum(scene, frame.positions, frame.velocities).center_of_mass;
  Instant now{.t = frame.t, .ball_velocity = velocity};
  now.center = (1 / (parts.mass - ball_mass)) * (parts.mass * center - ball_mass * ball);
  now.body_energy = total - (ball_mass / 2 * dot(velocity, velocity) - ball_mass * dot(scene.gravity, ball));
  for (std::uint32_t i = 0; i < parts.ball; ++i)
    now.body_fastest = std::max(now.body_fastest, norm(frame.velocities[i]));
  return now;
}

/// Whether the body sleeps. StepReport says that one of two islands sleeps, and it is the one that did not
/// move by a bit.
bool body_sleeps(const StepReport& step, const Parts& parts, std::span<const Vec3> before,
                 std::span<const Vec3> after) {
  return step.awake_islands < 2 && std::equal(after.begin(), after.begin() + parts.ball, before.begin());
}

double distance_to_segment(Vec3 point, Vec3 a, Vec3 b) {
  const Vec3 along = b - a;
  const double squared = dot(along, along);
  const double t = squared > 0 ? std::clamp(dot(point - a, along) / squared, 0.0, 1.0) : 0;
  return norm(a + t * along - point);
}

/// Returns the numbers of the frames to show. The first is the last one before the impact. The others lie
/// ever farther apart, since the fall is quick and coming to rest is slow.
std::vector<std::size_t> frames_to_show(std::size_t before, std::size_t last) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < poses_shown; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(poses_shown - 1);
    out.push_back(before +
                  static_cast<std::size_t>(std::lround(share * share * static_cast<double>(last - before))));
  }
  return out;
}

/// Returns the median. A value that is missing or not finite counts as the largest.
double median(std::vector<double> values) {
  for (double& value : values)
    if (!std::isfinite(value)) value = std::numeric_limits<double>::infinity();
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

}  // namespace

Scene make_scene(const HumanoidRun& run) {
  Scene scene = scenes::make_humanoid(run.figure);
  Vec3 target = scenes::torso_center(run.figure);
  if (run.seed != 0) {
    constexpr double most_off = 0.01;  // Farthest that the aim may be off, in m.
    std::mt19937_64 random(run.seed);
    target.y += most_off * (2 * scenes::unit_double(random) - 1);
    target.z += most_off * (2 * scenes::unit_double(random) - 1);
  }
  scenes::Ball ball = run.ball;
  ball.friction = run.figure.friction;
  scenes::throw_ball(scene, ball, target);
  return scene;
}

std::optional<Impact> find_impact(std::span<const Instant> track, Vec3 gravity) {
  std::optional<Impact> impact;
  for (std::size_t i = 1; i < track.size(); ++i) {
    // A ball that misses is kicked by the ground, and the body sleeps on.
    const bool touched = kick(track[i - 1], track[i], gravity) >= least_kick && track[i].body_fastest > 0;
    if (!touched) {
      if (impact) break;
    } else if (impact) {
      impact->last = i;
    } else {
      impact = Impact{.first = i, .last = i};
    }
  }
  return impact;
}

double energy_received(std::span<const Instant> track, const Impact& impact) {
  return track[impact.last].body_energy - track[impact.first - 1].body_energy;
}

std::optional<double> time_to_rest(std::span<const Instant> track, const Impact& impact) {
  for (std::size_t i = impact.first; i < track.size(); ++i) {
    if (!track[i].asleep) continue;
    std::size_t since = i;
    while (since > impact.first && track[since - 1].body_fastest < rest_speed) --since;
    return track[since].t - track[impact.first - 1].t;
  }
  return {};
}

double distance_over_ground(std::span<const Instant> track) {
  if (track.empty()) return 0;
  const Vec3 way = track.back().center - track.front().center;
  return std::hypot(way.x, way.z);
}

bool body_rests(std::span<const Instant> track, const std::optional<Impact>& impact) {
  return impact && track.back().asleep;
}

double deepest_penetration(const Scene& scene, std::span<const Vec3> positions) {
  double deepest = scenes::depth_in_ground(scene, positions);
  if (scene.capsules.empty()) return deepest;
  const Capsule& ball = scene.capsules.back();
  const Vec3 center = scenes::place_of(ball.a, positions);
  for (const Capsule& limb : scene.capsules) {
    if (&limb == &ball) continue;
    const double apart =
        distance_to_segment(center, scenes::place_of(limb.a, positions), scenes::place_of(limb.b, positions));
    deepest = std::max(deepest, ball.radius + limb.radius - apart);
  }
  return deepest;
}

HumanoidResult run_humanoid(const HumanoidRun& run, bool with_poses) {
  scenes::require_positive(run.dt, "dt");
  scenes::require_positive(run.most, "the duration");
  const Scene scene = make_scene(run);
  const Parts parts(scene);
  Settings settings;
  settings.method = Method::automatic;
  settings.substeps = run.substeps;
  settings.threads = 1;
  const MassModel mass = mass_model_of(settings);
  World world(scene, settings);

  HumanoidResult result;
  Frame now{.t = 0,
            .positions = std::vector<Vec3>(world.particle_count()),
            .velocities = std::vector<Vec3>(world.particle_count())};
  const auto visit = [&] {
    world.copy_positions(now.positions);
    world.copy_velocities(now.velocities);
    result.energy_after = measure_energy(scene, now.positions, now.velocities, mass).total();
    result.track.push_back(instant_of(scene, parts, now, result.energy_after));
    result.finite = result.finite && std::isfinite(result.energy_after);
    result.max_stretch = std::max(result.max_stretch, measure_stretch(scene, now.positions).max);
    result.penetration = std::max(result.penetration, deepest_penetration(scene, now.positions));
    if (with_poses) result.motion.push_back({.t = now.t, .positions = now.positions, .velocities = {}});
  };
  visit();
  result.energy_before = result.energy_after;
  std::vector<Vec3> before;
  const auto frames = static_cast<std::uint64_t>(std::ceil(run.most / run.dt * (1 - 1e-9)));
  std::optional<Impact> impact;
  for (std::uint64_t number = 1; number <= frames && result.finite; ++number) {
    before = now.positions;
    const auto start = scenes::Clock::now();
    const StepReport step = world.step(run.dt);
    result.wall_s += scenes::seconds_since(start);
    result.unsolved += step.unsolved;
    result.frozen += step.frozen_islands;
    now.t = static_cast<double>(number) * run.dt;
    visit();
    result.track.back().asleep = body_sleeps(step, parts, before, now.positions);
    if (!impact) impact = find_impact(result.track, scene.gravity);
    if (body_rests(result.track, impact)) break;
  }
  impact = find_impact(result.track, scene.gravity);
  result.hit = impact.has_value();
  result.simulated = now.t;
  result.distance = distance_over_ground(result.track);
  if (impact) {
    result.energy_received = energy_received(result.track, *impact);
    result.time_to_rest = time_to_rest(result.track, *impact);
  }
  if (!with_poses) return result;
  for (const std::size_t i : frames_to_show(impact ? impact->first - 1 : 0, result.motion.size() - 1))
    result.poses.push_back(result.motion[i]);
  return result;
}

std::vector<HumanoidCase> thesis_cases(const HumanoidRun& usual) {
  const auto with = [&](const char* figure, const char* name, auto change) {
    HumanoidCase out{.figure = figure, .name = name, .run = usual};
    change(out.run);
    return out;
  };
  // The thesis shows the two sides of each slider, and says nothing of their values. These values topple the
  // figure for certain. How far it goes when a slow or light ball makes it collapse is a matter of chance.
  const auto ball = [](HumanoidRun& r, double speed, double mass) {
    r.ball.speed = speed;
    r.ball.mass = mass;
    r.ball.radius = 5 * inch * std::cbrt(mass / 5);  // All balls have the same density.
  };
  const auto speed = [&](double value) { return [&, value](HumanoidRun& r) { ball(r, value, 5); }; };
  const auto mass = [&](double value) { return [&, value](HumanoidRun& r) { ball(r, 15, value); }; };
  const auto elasticity = [&](double value) {
    return [&, value](HumanoidRun& r) {
      ball(r, 20, 5);
      r.ball.elasticity = value;
    };
  };
  const auto body = [&](BodyType value) {
    return [&, value](HumanoidRun& r) {
      ball(r, 20, 5);
      r.figure.body = value;
    };
  };
  return {
      with("4.11", "small velocity, 10 m/s", speed(10)),
      with("4.11", "large velocity, 30 m/s", speed(30)),
      with("4.12", "low elasticity, 0.1", elasticity(0.1)),
      with("4.12", "large elasticity, 0.9", elasticity(0.9)),
      with("4.13", "light ball, 2.5 kg", mass(2.5)),
      with("4.13", "heavy ball, 20 kg", mass(20)),
      with("4.14", "thin body", body(BodyType::thin)),
      with("4.14", "wide body", body(BodyType::wide)),
  };
}

HumanoidMeasure median_of(std::span<const HumanoidResult> results) {
  std::vector<double> distances, rests, energies;
  for (const HumanoidResult& r : results) {
    distances.push_back(r.distance);
    rests.push_back(r.time_to_rest.value_or(std::numeric_limits<double>::infinity()));
    energies.push_back(r.energy_received);
  }
  HumanoidMeasure out{.distance = median(distances), .energy_received = median(energies)};
  if (const double rest = median(rests); std::isfinite(rest)) out.time_to_rest = rest;
  return out;
}

HumanoidComparison compare(const HumanoidCase& which, const std::function<void()>& tick) {
  HumanoidComparison out{.which = which};
  for (const std::uint32_t factor : {std::uint32_t{1}, finer}) {
    std::vector<HumanoidResult> results;
    for (std::uint32_t seed = 1; seed <= seeds_of_a_case; ++seed) {
      HumanoidRun run = which.run;
      run.seed = seed;
      run.substeps *= factor;
      results.push_back(run_humanoid(run, factor == 1 && seed == 1));
      const HumanoidResult& r = results.back();
      out.sound = out.sound && r.finite && r.unsolved == 0 && r.frozen == 0 && r.hit;
      tick();
    }
    (factor == 1 ? out.usual : out.fine) = median_of(results);
    if (factor != 1) break;
    for (const HumanoidResult& r : results) {
      out.max_stretch = std::max(out.max_stretch, r.max_stretch);
      out.penetration = std::max(out.penetration, r.penetration);
    }
    out.shown = std::move(results.front());
  }
  return out;
}

}  // namespace plumb::tools
