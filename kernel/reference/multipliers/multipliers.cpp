#include "reference/multipliers/multipliers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "reference/multipliers/past_folds.hpp"
#include "reference/multipliers/rod_equations.hpp"
#include "reference/multipliers/small_matrices.hpp"

namespace plumb::detail {
namespace {

using Eigen::VectorXd;

class Multipliers final : public MechanicalSystem {
 public:
  Multipliers(const Scene& island, const Settings& settings)
      : MechanicalSystem(integrator_of(settings)),
        settings_(settings.multipliers),
        gravity_(island.gravity),
        drag_(island.drag),
        solver_(island, mass_model_of(settings)),
        node_(island.particles.size(), RodEquations::none),
        anchor_velocities_(island.particles.size()) {
    const RodEquations& equations = solver_.equations();
    start_.q.resize(equations.unknowns());
    start_.v.resize(equations.unknowns());
    for (std::uint32_t i = 0; i < equations.particle.size(); ++i) {
      const std::uint32_t particle = equations.particle[i];
      node_[particle] = i;
      store3(&start_.q[3 * i], island.particles[particle].position);
      store3(&start_.v[3 * i], island.particles[particle].velocity);
    }
    // The weight of a node is the row sum of the mass matrix, because accelerating everything by g alike
    // takes that force.
    weight_ = equations.mass;
    for (const RodEquations::Row& row : equations.rows) {
      weight_[row.a] += row.coupling;
      if (row.b != RodEquations::none) weight_[row.b] += row.coupling;
    }
    Drive rest{{}, {}, Array<Vec3>(island.particles.size())};
    for (const Particle& particle : island.particles) rest.anchors.push_back(particle.position);
    project_velocities(start_, rest, 0, rest.anchor_velocities);
  }

  MechanicalState initial_state(const Drive&) const override { return start_; }

  void accelerations(const MechanicalState& state, const Drive& drive, double t, VectorXd& out) override {
    const RodEquations& equations = solver_.equations();
    const bool feeds_back = settings_.stabilization == Stabilization::baumgarte;
    const double rate = feeds_back ? settings_.baumgarte_rate : 0;
    for (std::size_t i = 0; i < weight_.size(); ++i)
      store3(&solver_.f[3 * i], weight_[i] * gravity_ + drive.forces[equations.particle[i]]);
    for_rows(state, drive, t, [&](std::size_t r, const RodEquations::Row& row, Vec3 d, Vec3 w) {
      const double speed = dot(d, w), off = 0.5 * (dot(d, d) - row.length2);
      solver_.c[r] = -dot(w, w) - rate * (2 * speed + rate * off);
      if (drag_ == 0) return;
      // The force -drag M v needs no product with the matrix if the unknown is a + drag v.
      const bool hangs = row.b == RodEquations::none;
      const Vec3 fixed = hangs ? drive.anchor_velocities[row.fixed] : Vec3{};
      solver_.c[r] += drag_ * dot(d, w + fixed);
      if (hangs) store3(&solver_.f[3 * row.a], load3(&solver_.f[3 * row.a]) - (drag_ * row.coupling) * fixed);
    });
    out = solver_.solve();
    if (drag_ != 0) out -= drag_ * state.v;
  }

  void settle(MechanicalState& state, const Drive& drive, double t) override {
    if (settings_.stabilization != Stabilization::projection) return;
    project_positions(state, drive, t);
    project_velocities(state, drive, t, drive.anchor_velocities);
  }

  void advance(MechanicalState& state, const Drive& drive, double h) override {
    if (anchor_velocities_ != drive.anchor_velocities) {
      project_velocities(state, drive, 0, anchor_velocities_);
      anchor_velocities_ = drive.anchor_velocities;
    }
    const auto advance = [this](MechanicalState& of, const Drive& by, double step) {
      MechanicalSystem::advance(of, by, step);
    };
    if (solver_.equations().softened)
      past_folds_.step(state, drive, h, advance, [this] { return solver_.take_largest_miss(); });
    else
      advance(state, drive, h);
  }

  Vec3 position(const MechanicalState& state, std::uint32_t particle) const override {
    return load3(&state.q[3 * node_[particle]]);
  }
  Vec3 velocity(const MechanicalState& state, std::uint32_t particle) const override {
    return load3(&state.v[3 * node_[particle]]);
  }

  void report(const MechanicalState&, const Drive&, StepReport& out) override {
    out.unsolved += std::exchange(unsolved_, 0);
  }

 private:
  /// Calls f(row number, row, d, its rate) for every row, and sets the solver's directions.
  template <class F>
  void for_rows(const MechanicalState& state, const Drive& drive, double t, F&& f) {
    const Array<RodEquations::Row>& rows = solver_.equations().rows;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const RodEquations::Row& row = rows[r];
      Vec3 d = load3(&state.q[3 * row.a]), w = load3(&state.v[3 * row.a]);
      if (row.b != RodEquations::none) {
        d -= load3(&state.q[3 * row.b]);
        w -= load3(&state.v[3 * row.b]);
      } else {
        d -= drive.anchor(row.fixed, t);
        w -= drive.anchor_velocities[row.fixed];
      }
      solver_.directions[r] = d;
      f(r, row, d, w);
    }
  }

  /// Makes the least change, weighted by mass, after which velocities pull on no rod. Anchors had the
  /// velocities `before` until now. What of a rod's mass is coupled to its anchor feels the blow at once.
  void project_velocities(MechanicalState& state, const Drive& drive, double t, const Array<Vec3>& before) {
    solver_.f.setZero();
    bool changes = false;
    for_rows(state, drive, t, [&](std::size_t r, const RodEquations::Row& row, Vec3 d, Vec3 w) {
      solver_.c[r] = -dot(d, w);
      changes = changes || solver_.c[r] != 0;
      if (row.b != RodEquations::none || row.coupling == 0) return;
      const Vec3 blow = drive.anchor_velocities[row.fixed] - before[row.fixed];
      changes = changes || !(blow == Vec3{});
      store3(&solver_.f[3 * row.a], load3(&solver_.f[3 * row.a]) - row.coupling * blow);
    });
    if (changes) state.v += solver_.solve();
  }

  /// Solves for the lengths |d| = L by Newton's method, which takes a single rod back in one step from
  /// however far.
  void project_positions(MechanicalState& state, const Drive& drive, double t) {
    constexpr int most_rounds = 30;
    constexpr double rounding = 4 * std::numeric_limits<double>::epsilon();
    solver_.f.setZero();
    double before = std::numeric_limits<double>::infinity();
    for (int round = 0; round < most_rounds; ++round) {
      double largest = 0;
      for_rows(state, drive, t, [&](std::size_t r, const RodEquations::Row& row, Vec3 d, Vec3) {
        const double now = norm(d), length = std::sqrt(row.length2);
        const double off = (dot(d, d) - row.length2) / (now + length);
        solver_.c[r] = -now * off;
        // A violation is compared with what rounding of the coordinates alone makes of it.
        const double size = length + norm(load3(&state.q[3 * row.a]));
        largest = std::max(largest, std::abs(off) / size);
      });
      const bool stalls = largest > 0.5 * before && largest < 1e-10;
      if (largest <= rounding || stalls) return;
      before = largest;
      state.q += solver_.solve();
    }
    ++unsolved_;
  }

  std::uint64_t unsolved_ = 0;  ///< projections that did not converge since the last report

  MultiplierSettings settings_;
  Vec3 gravity_;
  double drag_;
  RodSolver solver_;
  Array<std::uint32_t> node_;      ///< by the island's particle
  Array<double> weight_;           ///< kg, by node: what gravity pulls on
  Array<Vec3> anchor_velocities_;  ///< velocities in the last substep
  MechanicalState start_;
  PastFolds past_folds_;
};

}  // namespace

std::unique_ptr<MechanicalSystem> make_multipliers(const Scene& island, const Settings& settings) {
  return std::make_unique<Multipliers>(island, settings);
}

}  // namespace plumb::detail
