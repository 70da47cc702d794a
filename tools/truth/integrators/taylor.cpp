#include "truth/integrators/taylor.hpp"

#include <algorithm>
#include <limits>

namespace plumb::truth {
namespace {

/// Returns half the sum of c[j] c[last - j] for j from `first` to last - first. The sum reads the same from
/// both ends, so half of it is taken, and half of its middle if it has one.
Real half_square(const Real* c, std::size_t first, std::size_t last) {
  Real sum = 0;
  for (std::size_t j = first; 2 * j < last; ++j) sum += c[j] * c[last - j];
  if (last % 2 == 0 && last >= 2 * first) sum += c[last / 2] * c[last / 2] / 2;
  return sum;
}

/// Returns the value of a polynomial at t.
Real value_at(const Real* c, std::size_t powers, Real t) {
  Real sum = 0;
  for (std::size_t k = powers; k-- > 0;) sum = sum * t + c[k];
  return sum;
}

}  // namespace

TaylorSeries::TaylorSeries(const Model& model, std::uint32_t order)
    : model_(model), powers_(order + 2), bent_(model, powers_), norm_(powers_) {
  for (auto* values : {&x_, &y_, &z_}) values->assign(model.particles() * powers_, 0);
  for (auto* values : {&dx_, &dy_, &dz_, &mu_, &length_}) values->assign(model.rods.size() * powers_, 0);
  f_.resize(model.particles());
  a_.resize(model.particles());
  c_.resize(model.rods.size());
  push_.resize(model.rods.size());
}

/// Adds what coefficients below k + 2 say for the coefficient k of the acceleration: pulls into f_, lengths
/// into c_.
void TaylorSeries::weigh_rods(std::size_t k) {
  for (std::size_t r = 0; r < model_.rods.size(); ++r) {
    const ModelRod& rod = model_.rods[r];
    if (rod.elastic) {
      expand_pull(k, r);
    } else {
      constrain(k, r);
    }
    const Real *dx = &dx_[r * powers_], *dy = &dy_[r * powers_], *dz = &dz_[r * powers_],
               *mu = &mu_[r * powers_];
    const std::size_t known =
        rod.elastic ? k + 1 : k;  // The next multiplier of a rigid rod is yet to be found.
    Point pull;
    for (std::size_t j = 0; j < known; ++j) {
      pull.x += mu[j] * dx[k - j], pull.y += mu[j] * dy[k - j], pull.z += mu[j] * dz[k - j];
    }
    f_[rod.b] += pull;
    f_[rod.a] -= pull;
  }
}

/// Sets c_ of a rigid rod.
void TaylorSeries::constrain(std::size_t k, std::size_t r) {
  const Real both = static_cast<Real>(k + 1) * static_cast<Real>(k + 2);
  const Real *dx = &dx_[r * powers_], *dy = &dy_[r * powers_], *dz = &dz_[r * powers_];
  const Real sum = half_square(dx, 1, k + 2) + half_square(dy, 1, k + 2) + half_square(dz, 1, k + 2);
  // The drag is taken to the other side, see expand().
  const Real along = dx[0] * dx[k + 1] + dy[0] * dy[k + 1] + dz[0] * dz[k + 1];
  c_[r] = model_.drag * static_cast<Real>(k + 1) * along - both * sum;
  // Half the square of a length that changes has a coefficient of t² alone beyond those of 1 and t.
  if (k == 0) c_[r] += model_.rods[r].rate * model_.rods[r].rate;
}

/// Finds coefficient k of an elastic rod's length.
void TaylorSeries::expand_length(std::size_t k, std::size_t r) {
  const Real *dx = &dx_[r * powers_], *dy = &dy_[r * powers_], *dz = &dz_[r * powers_];
  Real* length = &length_[r * powers_];
  if (k == 0) {
    length[0] = norm({dx[0], dy[0], dz[0]});
    return;
  }
  const Real sum = half_square(dx, 0, k) + half_square(dy, 0, k) + half_square(dz, 0, k);
  length[k] = (sum - half_square(length, 1, k)) / length[0];
}

/// Finds coefficient k of an elastic rod's multiplier, and one more of its length, because the damping needs
/// it.
void TaylorSeries::expand_pull(std::size_t k, std::size_t r) {
  const ModelRod& rod = model_.rods[r];
  if (k == 0) expand_length(0, r);
  expand_length(k + 1, r);
  const Real* length = &length_[r * powers_];
  Real* mu = &mu_[r * powers_];
  Real excess = length[k];
  if (k == 0) excess -= rod.length_at(time_);
  if (k == 1) excess -= rod.rate;
  Real sum = -rod.stiffness * excess - rod.damping * static_cast<Real>(k + 1) * length[k + 1];
  for (std::size_t j = 0; j < k; ++j) sum -= mu[j] * length[k - j];
  mu[k] = sum / length[0];
}

void TaylorSeries::expand(const State& state, Real t, ConstraintSolver& solver) {
  time_ = t;
  const std::size_t n = model_.particles();
  std::fill(norm_.begin(), norm_.end(), Real{0});
  const auto set = [&](std::size_t power, std::size_t i, const Point& value) {
    coefficient(x_, i, power) = value.x;
    coefficient(y_, i, power) = value.y;
    coefficient(z_, i, power) = value.z;
    norm_[power] = std::max(norm_[power], norm(value));
  };
  const auto stretch_rods = [&](std::size_t power) {
    for (std::size_t r = 0; r < model_.rods.size(); ++r) {
      const ModelRod& rod = model_.rods[r];
      coefficient(dx_, r, power) = coefficient(x_, rod.b, power) - coefficient(x_, rod.a, power);
      coefficient(dy_, r, power) = coefficient(y_, rod.b, power) - coefficient(y_, rod.a, power);
      coefficient(dz_, r, power) = coefficient(z_, rod.b, power) - coefficient(z_, rod.a, power);
    }
  };
  for (std::size_t i = 0; i < n; ++i) {
    set(0, i, state.x[i]);
    set(1, i, state.v[i]);
  }
  stretch_rods(0);
  stretch_rods(1);
  for (std::size_t k = 0; k + 2 < powers_; ++k) {
    for (std::size_t i = 0; i < n; ++i) {
      f_[i] = k == 0 && !model_.fixed[i] ? model_.weight[i] * model_.gravity : Point{};
    }
    weigh_rods(k);
    bent_.add_forces(
        k,
        [&](std::size_t i, std::size_t power) {
          return Point{coefficient(x_, i, power), coefficient(y_, i, power), coefficient(z_, i, power)};
        },
        state, f_);
    // The system is solved for a + drag v, whose mass-weighted value needs no drag. So M need not be applied
    // to v.
    solver.solve(f_, c_, a_, push_);
    const Real both = static_cast<Real>(k + 1) * static_cast<Real>(k + 2);
    for (std::size_t i = 0; i < n; ++i) {
      if (model_.fixed[i]) continue;
      const Point before{coefficient(x_, i, k + 1), coefficient(y_, i, k + 1), coefficient(z_, i, k + 1)};
      set(k + 2, i, (1 / both) * (a_[i] - model_.drag * static_cast<Real>(k + 1) * before));
    }
    stretch_rods(k + 2);
    for (std::size_t r = 0; r < push_.size(); ++r) {
      if (!model_.rods[r].elastic) coefficient(mu_, r, k) = push_[r];
    }
  }
}

Real TaylorSeries::choose_step(Real tolerance) const {
  Real h = std::numeric_limits<Real>::infinity();
  const std::size_t first = std::max<std::size_t>(2, powers_ - 3);
  for (std::size_t k = first; k < powers_; ++k) {
    if (!(norm_[k] > 0)) continue;
    const Real power = static_cast<Real>(k);
    h = std::min(h, std::pow(tolerance * model_.diagonal / norm_[k], 1 / power));
    h = std::min(h, std::pow(tolerance * model_.speed / (power * norm_[k]), 1 / (power - 1)));
  }
  return h;
}

void TaylorSeries::evaluate(Real t, State& out) const {
  const auto sum = [&](const std::vector<Real>& of, std::size_t i, Real& x, Real& v) {
    const Real* c = &of[i * powers_];
    x = v = 0;
    for (std::size_t k = powers_; k-- > 1;) {
      x = x * t + c[k];
      v = v * t + static_cast<Real>(k) * c[k];
    }
    x = x * t + c[0];
  };
  for (std::size_t i = 0; i < model_.particles(); ++i) {
    sum(x_, i, out.x[i].x, out.v[i].x);
    sum(y_, i, out.x[i].y, out.v[i].y);
    sum(z_, i, out.x[i].z, out.v[i].z);
  }
  for (std::size_t i = 0; i < out.twisted.size(); ++i) out.twisted[i] = bent_.twist_at(i, t);
}

bool TaylorSeries::lengths_hold(Real t, const State& state, Real most) const {
  // A step may hold more than one swing of a rod, so that its length at the end does not tell all.
  constexpr int looks = 32;
  for (std::size_t r = 0; r < model_.rods.size(); ++r) {
    const ModelRod& rod = model_.rods[r];
    if (!rod.elastic) continue;
    // The last coefficient belongs to a power that expand() has no use for.
    const auto length_at = [&](Real when) { return value_at(&length_[r * powers_], powers_ - 1, when); };
    Real earlier = length_at(0), here = length_at(t / looks);
    for (int i = 2; i <= looks; ++i) {
      const Real later = length_at(t * i / looks);
      // Between two looks a length dips by an eighth of its second difference; twice that leaves room.
      const Real dip = std::abs(earlier - 2 * here + later) / 4;
      if (!(std::min({earlier, here, later}) > dip)) return false;
      earlier = here;
      here = later;
    }
    const Real length = norm(state.x[rod.b] - state.x[rod.a]);
    if (!(std::abs(length_at(t) - length) <= most * std::max(length, model_.diagonal))) return false;
  }
  return true;
}

}  // namespace plumb::truth
