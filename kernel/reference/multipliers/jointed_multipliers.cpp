#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "reference/multipliers/joint_equations.hpp"
#include "reference/multipliers/joint_forces.hpp"
#include "reference/multipliers/multipliers.hpp"
#include "reference/multipliers/past_folds.hpp"
#include "reference/multipliers/small_matrices.hpp"

namespace plumb::detail {
namespace {

class JointedMultipliers final : public MechanicalSystem {
 public:
  JointedMultipliers(const Scene& island, const Settings& settings)
      : MechanicalSystem(integrator_of(settings)),
        settings_(settings.multipliers),
        gravity_(island.gravity),
        drag_(island.drag),
        extent_(bounding_diagonal(island)),
        equations_(island, mass_model_of(settings)),
        forces_(island, equations_.movable()) {
    Drive rest{{}, {}, Array<Vec3>(island.particles.size())};
    for (const Particle& particle : island.particles) {
      rest.anchors.push_back(particle.position);
      extent_ = std::max(extent_, norm(particle.position));
    }
    start_.q.resize(equations_.f.size());
    start_.v.resize(equations_.f.size());
    for (std::uint32_t i = 0; i < equations_.movable(); ++i) {
      store3(&start_.q[3 * i], island.particles[i].position);
      store3(&start_.v[3 * i], island.particles[i].velocity);
    }
    x_.resize(island.particles.size());
    v_.resize(island.particles.size());
    anchor_velocities_ = rest.anchor_velocities;
    project_velocities(start_, rest, 0, rest.anchor_velocities);
  }

  MechanicalState initial_state(const Drive&) const override { return start_; }

  void accelerations(const MechanicalState& state, const Drive& drive, double t,
                     Eigen::VectorXd& out) override {
    put(state, drive, t);
    equations_.set_positions(x_);
    equations_.f.setZero();
    equations_.add_weights(gravity_, equations_.f);
    for (std::uint32_t i = 0; i < equations_.movable(); ++i)
      store3(&equations_.f[3 * i], load3(&equations_.f[3 * i]) + drive.forces[i]);
    forces_.add(x_, v_, equations_.f);
    if (drag_ != 0) equations_.add_momenta(v_, -drag_, equations_.f);
    const bool feeds_back = settings_.stabilization == Stabilization::baumgarte;
    const double rate = feeds_back ? settings_.baumgarte_rate : 0;
    equations_.violations(x_, equations_.c);
    equations_.c *= -rate * rate;
    equations_.add_rates(x_, v_, -2 * rate, equations_.c);
    equations_.add_bends(v_, -1, equations_.c);
    out = equations_.solve();
  }

  void settle(MechanicalState& state, const Drive& drive, double t) override {
    if (settings_.stabilization == Stabilization::projection) {
      project_positions(state, drive, t);
      project_velocities(state, drive, t, drive.anchor_velocities);
    }
    put(state, drive, t);
    forces_.follow(x_);
  }

  void advance(MechanicalState& state, const Drive& drive, double h) override {
    if (anchor_velocities_ != drive.anchor_velocities) {
      project_velocities(state, drive, 0, anchor_velocities_);
      anchor_velocities_ = drive.anchor_velocities;
    }
    past_folds_.step(
        state, drive, h,
        [this](MechanicalState& of, const Drive& by, double step) {
          MechanicalSystem::advance(of, by, step);
        },
        [this] { return equations_.take_largest_miss(); });
  }

  Vec3 position(const MechanicalState& state, std::uint32_t particle) const override {
    return load3(&state.q[3 * particle]);
  }
  Vec3 velocity(const MechanicalState& state, std::uint32_t particle) const override {
    return load3(&state.v[3 * particle]);
  }

  void report(const MechanicalState&, const Drive&, StepReport& out) override {
    out.unsolved += std::exchange(unsolved_, 0);
  }

 private:
  /// Writes where all particles are, and how they move, into x_ and v_.
  void put(const MechanicalState& state, const Drive& drive, double t) {
    for (std::uint32_t i = 0; i < x_.size(); ++i) {
      const bool moves = i < equations_.movable();
      x_[i] = moves ? load3(&state.q[3 * i]) : drive.anchor(i, t);
      v_[i] = moves ? load3(&state.v[3 * i]) : drive.anchor_velocities[i];
    }
  }

  /// Makes the least change, weighted by mass, after which velocities keep constraints. Anchors had the
  /// velocities `before` until now, and mass that is coupled to them feels the blow.
  void project_velocities(MechanicalState& state, const Drive& drive, double t, const Array<Vec3>& before) {
    put(state, drive, t);
    equations_.set_positions(x_);
    equations_.c.setZero();
    equations_.add_rates(x_, v_, -1, equations_.c);
    for (std::uint32_t i = 0; i < x_.size(); ++i)
      v_[i] = i < equations_.movable() ? Vec3{} : drive.anchor_velocities[i] - before[i];
    equations_.f.setZero();
    equations_.add_momenta(v_, -1, equations_.f);
    if (!equations_.c.isZero(0) || !equations_.f.isZero(0)) state.v += equations_.solve();
  }

  /// Brings positions back onto the constraints by Newton's method.
  void project_positions(MechanicalState& state, const Drive& drive, double t) {
    constexpr int most_rounds = 30;
    constexpr double rounding = 4 * std::numeric_limits<double>::epsilon();
    // What is left here is rounding, and tells nothing about the equations.
    const double missed = equations_.take_largest_miss();
    double before = std::numeric_limits<double>::infinity();
    for (int round = 0;; ++round) {
      put(state, drive, t);
      const double largest = equations_.violations(x_, equations_.c) / extent_;
      if (largest <= rounding || (largest > 0.5 * before && largest < 1e-10)) break;
      if (round == most_rounds) {
        ++unsolved_;
        break;
      }
      before = largest;
      equations_.set_positions(x_);
      equations_.f.setZero();
      equations_.c *= -1;
      state.q += equations_.solve();
    }
    equations_.forget_misses(missed);
  }

  std::uint64_t unsolved_ = 0;  ///< projections that did not converge since the last report

  MultiplierSettings settings_;
  Vec3 gravity_;
  double drag_;
  double extent_;  ///< m, what rounding of coordinates is relative to
  JointEquations equations_;
  JointForces forces_;
  Array<Vec3> x_, v_;              ///< by particle, the fixed ones too
  Array<Vec3> anchor_velocities_;  ///< in the last substep
  MechanicalState start_;
  PastFolds past_folds_;
};

}  // namespace

std::unique_ptr<MechanicalSystem> make_jointed_multipliers(const Scene& island, const Settings& settings) {
  return std::make_unique<JointedMultipliers>(island, settings);
}

}  // namespace plumb::detail
