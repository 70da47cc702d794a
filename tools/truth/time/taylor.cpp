#include "truth/time/taylor.hpp"

#include <algorithm>
#include <limits>

namespace plumb::truth {

TaylorSeries::TaylorSeries(const Model& model, std::uint32_t order)
    : model_(model), powers_(order + 2), norm_(powers_) {
  for (auto* values : {&x_, &y_, &z_}) values->assign(model.particles() * powers_, 0);
  for (auto* values : {&dx_, &dy_, &dz_, &mu_}) values->assign(model.rods.size() * powers_, 0);
  f_.resize(model.particles());
  a_.resize(model.particles());
  c_.resize(model.rods.size());
  push_.resize(model.rods.size());
}

/// Adds what coefficients below k + 2 say for the coefficient k of the acceleration: pulls into f_, lengths
/// into c_.
void TaylorSeries::weigh_rods(std::size_t k) {
  const Real both = static_cast<Real>(k + 1) * static_cast<Real>(k + 2);
  for (std::size_t r = 0; r < model_.rods.size(); ++r) {
    const ModelRod& rod = model_.rods[r];
    const Real *dx = &dx_[r * powers_], *dy = &dy_[r * powers_], *dz = &dz_[r * powers_],
               *mu = &mu_[r * powers_];
    Point pull;
    for (std::size_t j = 0; j < k; ++j) {
      pull.x += mu[j] * dx[k - j], pull.y += mu[j] * dy[k - j], pull.z += mu[j] * dz[k - j];
    }
    f_[rod.b] += pull;
    f_[rod.a] -= pull;
    // The sum reads the same from both ends, so half of it is taken, and half of its middle if it has one.
    const std::size_t last = k + 2;
    Real sum = 0;
    for (std::size_t j = 1; 2 * j < last; ++j) {
      const std::size_t i = last - j;
      sum += dx[j] * dx[i] + dy[j] * dy[i] + dz[j] * dz[i];
    }
    if (last % 2 == 0) {
      const std::size_t m = last / 2;
      sum += (dx[m] * dx[m] + dy[m] * dy[m] + dz[m] * dz[m]) / 2;
    }
    // The drag is taken to the other side, see expand().
    const Real along = dx[0] * dx[k + 1] + dy[0] * dy[k + 1] + dz[0] * dz[k + 1];
    c_[r] = model_.drag * static_cast<Real>(k + 1) * along - both * sum;
  }
}

void TaylorSeries::expand(const State& state, ConstraintSolver& solver) {
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
    for (std::size_t r = 0; r < push_.size(); ++r) coefficient(mu_, r, k) = push_[r];
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
}

}  // namespace plumb::truth
