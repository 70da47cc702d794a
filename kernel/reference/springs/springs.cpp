#include "reference/springs/springs.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace plumb::detail {
namespace {

/// Steps of adaptive_implicit_euler are never shorter than this share of a substep, which bounds the
/// attempts at one substep.
constexpr double shortest_share = 1.0 / 4096;
/// An adaptive step uses up this share of the accuracy. What is wrong early grows with the motion, about
/// twofold in half a second of a swinging chain. A larger share takes fewer steps and may exceed the
/// accuracy.
constexpr double margin = 1.0 / 3;

}  // namespace

SpringSystem::SpringSystem(const Scene& island, const Settings& settings)
    : MechanicalSystem(integrator_of(settings)), scene_(island), settings_(settings) {
  for (std::uint32_t i = 0; i < scene_.particles.size(); ++i)
    if (!scene_.particles[i].fixed) movable_.push_back(i);
}

void SpringSystem::accelerations(const MechanicalState& state, const Drive& drive, double t,
                                 Eigen::VectorXd& out) {
  find_forces(state, drive, t, out);
  out.array() /= masses_.array();
}

void SpringSystem::advance(MechanicalState& state, const Drive& drive, double h) {
  switch (integrator()) {
    case Integrator::implicit_euler:
      return implicit_.step(*this, state, drive, h);
    case Integrator::adaptive_implicit_euler:
      return advance_adaptively(state, drive, h);
    default:
      return integrate(integrator(), *this, state, drive, h);
  }
}

/// Doubles steps: a whole step is compared with two halves, which are kept. Backward Euler's error in one
/// step is C h², so the halves have C h²/2. That is also how far the two results lie apart.
void SpringSystem::advance_adaptively(MechanicalState& state, const Drive& drive, double h) {
  // A point without rods has no length to be accurate to, and nothing to hold.
  if (drive.scene_diagonal == 0) return implicit_.step(*this, state, drive, h);
  const double allowed =
      margin * *settings_.accuracy * drive.scene_diagonal;  // error that may grow in a second, m/s
  const double shortest = shortest_share * h;
  trial_drive_ = drive;
  double done = 0;
  while (done < h) {
    const double left = h - done;
    double step = std::max(std::min(next_step_, left), shortest);
    // What is left after the step is nothing, or long enough for a step of its own.
    if (step < left && left - step < shortest) step = left < 2 * shortest ? left : left - shortest;
    for (std::size_t i = 0; i < drive.anchors.size(); ++i)
      trial_drive_.anchors[i] = drive.anchor(static_cast<std::uint32_t>(i), done);
    whole_ = halves_ = state;
    implicit_.step(*this, whole_, trial_drive_, step);
    implicit_.step(*this, halves_, trial_drive_, step / 2);
    for (std::size_t i = 0; i < drive.anchors.size(); ++i)
      trial_drive_.anchors[i] = drive.anchor(static_cast<std::uint32_t>(i), done + step / 2);
    implicit_.step(*this, halves_, trial_drive_, step / 2);

    const double ratio = rms_difference(whole_, halves_) / (allowed * step);
    const bool accurate = ratio <= 1;  // it is false for a ratio that is not a number
    const double factor = std::isfinite(ratio) ? std::clamp(0.9 / ratio, 0.2, 2.0) : 0.2;
    // Every refusal makes the step at least a tenth shorter, and those below twice the shortest are taken.
    if (!accurate && step >= 2 * shortest) {
      ++repeated_;
      next_step_ = factor * step;
      continue;
    }
    if (!accurate) ++inaccurate_;
    // The last step of a substep may have been cut short. It then says little about the next.
    if (step < left || factor < 1 || next_step_ <= step) next_step_ = factor * step;
    state = halves_;
    if (!state.finite()) return;
    done = step == left ? h : done + step;
  }
}

double SpringSystem::rms_difference(const MechanicalState& a, const MechanicalState& b) const {
  double squares = 0;
  for (const std::uint32_t i : movable_) {
    const Vec3 d = position(a, i) - position(b, i);
    squares += dot(d, d);
  }
  return std::sqrt(squares / static_cast<double>(std::max<std::size_t>(1, movable_.size())));
}

void SpringSystem::report(const MechanicalState&, const Drive&, StepReport& out) {
  out.repeated_steps += std::exchange(repeated_, 0);
  out.inaccurate_steps += std::exchange(inaccurate_, 0);
}

double spring_damping(const SpringSettings& springs, double mass_a, double mass_b) {
  const double reduced = 1 / (1 / mass_a + 1 / mass_b);
  return 2 * springs.damping_ratio * std::sqrt(springs.stiffness * reduced);
}

std::unique_ptr<SpringSystem> make_springs(const Scene& island, const Settings& settings) {
  return settings.springs.model == SpringModel::particles ? make_spring_particles(island, settings)
                                                          : make_spring_rods(island, settings);
}

}  // namespace plumb::detail
