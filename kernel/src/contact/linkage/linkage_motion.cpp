// This file evaluates the constraints, masses and forces of a linkage where it is and as it moves.

#include <algorithm>
#include <cmath>

#include "contact/linkage/linkage.hpp"
#include "math/elementary.hpp"
#include "reference/multipliers/small_matrices.hpp"

namespace plumb::detail {
namespace {

/// The sine of an angle counts as at least this. Nearer to 0 or pi its slope would grow without bound.
constexpr double least_sine = 1e-3;

inline void write(std::span<double> values, const std::uint32_t* places, Vec3 v) {
  values[places[0]] = v.x;
  values[places[1]] = v.y;
  values[places[2]] = v.z;
}
inline void add_to(std::span<double> values, const std::uint32_t* places, Vec3 v) {
  values[places[0]] += v.x;
  values[places[1]] += v.y;
  values[places[2]] += v.z;
}

}  // namespace

void Linkage::assemble(std::span<const Vec3> x, Array<simd::Block>& matrix) const {
  plan_.clear(matrix);
  const std::span<double> values = numbers(matrix);
  // Unknowns of a particle follow each other in a block.
  const auto put = [&](std::uint32_t place, double mass) {
    for (std::uint32_t axis = 0; axis < 3; ++axis) values[place + 5 * axis] = mass;
  };
  for (std::uint32_t i = 0; i < movable_; ++i) put(KktPlan::own_place(slots_[i]), masses_[i]);
  for (const Coupling& c : couplings_) put(c.place, c.mass);
  for (std::uint32_t c = 0; c < constraints_; ++c)
    values[KktPlan::own_place(plan_.position(3 * movable_ + c))] = -softs_[c];
  for (const Elastic& each : elastics_) values[KktPlan::own_place(plan_.position(each.row))] = -1;
  for (const RodRow& rod : rods_) {
    const Vec3 along = rod.over2 * (x[rod.b] - x[rod.a]);
    if (rod.places[0] != none) write(values, &rod.places[0], -1.0 * along);
    if (rod.places[3] != none) write(values, &rod.places[3], along);
  }
  for (const DotRow& each : dots_) {
    const Vec3 u = each.over * each.u.of(x), v = each.over * each.v.of(x);
    add_gradient(each.u, v, each.touched, each.places, values);
    add_gradient(each.v, u, each.touched, each.places, values);
  }
  for (const PinRow& pin : pins_)
    for (std::uint32_t i = 0; i < pin.sum.count; ++i) {
      const double w = pin.sum.terms[i].weight;
      if (pin.places[3 * i] != none) write(values, &pin.places[3 * i], {w, w, w});
    }
  stiffen_flat(x, matrix);
}

void Linkage::add_gradient(const Combination& sum, Vec3 along, std::span<const std::uint32_t> touched,
                           std::span<const std::uint32_t> places, std::span<double> values) {
  for (std::uint32_t i = 0; i < sum.count; ++i) {
    const auto at = std::find(touched.begin(), touched.end(), sum.terms[i].particle);
    if (at == touched.end()) continue;
    add_to(values, &places[3 * static_cast<std::size_t>(at - touched.begin())], sum.terms[i].weight * along);
  }
}

void Linkage::put(std::span<const Vec3> vectors, std::span<double> solved) const {
  for (std::uint32_t i = 0; i < movable_; ++i) {
    double* const at = &solved[slots_[i]];
    at[0] = vectors[i].x;
    at[1] = vectors[i].y;
    at[2] = vectors[i].z;
  }
}

void Linkage::add(Terms at, Vec3 vector, std::span<double> solved) const {
  for (const auto& [particle, weight] : at) {
    if (particle >= movable_) continue;
    double* const to = &solved[slots_[particle]];
    to[0] += weight * vector.x;
    to[1] += weight * vector.y;
    to[2] += weight * vector.z;
  }
}

Vec3 Linkage::of_fixed(Terms at, std::span<const Vec3> motion) const {
  Vec3 out{};
  for (const auto& [particle, weight] : at)
    if (particle >= movable_) out += weight * motion[particle];
  return out;
}

double Linkage::heaviest(Terms at) const {
  double out = 0;
  for (const auto& [particle, weight] : at)
    if (particle < movable_) out = std::max(out, nominal_masses_[particle]);
  return out;
}

void Linkage::stiffen(Terms at, const Sym3& by, std::span<simd::Block> matrix) const {
  for (std::size_t i = 0; i < at.size(); ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      const auto [a, weight_a] = at[i];
      const auto [b, weight_b] = at[j];
      if (a >= movable_ || b >= movable_) continue;
      // Three unknowns of one particle are neighbours in their block.
      const std::uint32_t place = plan_.place(3 * a, 3 * b);
      double* const to = matrix[place / 16].of + place % 16;
      const double weight = weight_a * weight_b;
      const double rows[3][3] = {{by.xx, by.xy, by.xz}, {by.xy, by.yy, by.yz}, {by.xz, by.yz, by.zz}};
      for (std::uint32_t k = 0; k < 3; ++k)
        for (std::uint32_t l = 0; l < 3; ++l) to[4 * k + l] += weight * rows[k][l];
    }
}

double Linkage::violations(std::span<const Vec3> x, std::span<const double> squares,
                           std::span<double> right) const {
  double worst = 0;
  const auto set = [&](std::uint32_t row, double value, double scale = 1) {
    right[plan_.position(row)] = -value;
    worst = std::max(worst, std::abs(value) / scale);
  };
  for (const RodRow& rod : rods_) {
    const Vec3 d = x[rod.b] - x[rod.a];
    // Rounding of what was paid out grows with the square, and so does what counts as solved.
    const double square = squares.empty() ? 1 : squares[rod.number];
    set(rod.row, 0.5 * (rod.over2 * dot(d, d) - square), std::max(square, 1.0));
  }
  for (const DotRow& each : dots_) set(each.row, each.over * (dot(each.u.of(x), each.v.of(x)) - each.value));
  for (const PinRow& pin : pins_) {
    const Vec3 apart = pin.sum.of(x);
    set(pin.rows[0], apart.x);
    set(pin.rows[1], apart.y);
    set(pin.rows[2], apart.z);
  }
  return std::isfinite(worst) ? worst : INFINITY;
}

void Linkage::targets(std::span<const Vec3> x, std::span<const Vec3> d, std::span<const Vec3> there,
                      std::span<const double> squares, std::span<double> right) const {
  // J acts on movable particles alone; fixed ones have gone where they go in `there`.
  const auto moved = [&](std::uint32_t particle) { return particle < movable_ ? d[particle] : Vec3{}; };
  const auto sum_moved = [&](const Combination& sum) {
    Vec3 out{};
    for (std::uint32_t i = 0; i < sum.count; ++i) out += sum.terms[i].weight * moved(sum.terms[i].particle);
    return out;
  };
  violations(there, squares, right);
  for (const RodRow& rod : rods_)
    right[plan_.position(rod.row)] += rod.over2 * dot(x[rod.b] - x[rod.a], moved(rod.b) - moved(rod.a));
  for (const DotRow& each : dots_)
    right[plan_.position(each.row)] +=
        each.over * (dot(each.u.of(x), sum_moved(each.v)) + dot(each.v.of(x), sum_moved(each.u)));
  for (const PinRow& pin : pins_) {
    const Vec3 by = sum_moved(pin.sum);
    right[plan_.position(pin.rows[0])] += by.x;
    right[plan_.position(pin.rows[1])] += by.y;
    right[plan_.position(pin.rows[2])] += by.z;
  }
}

void Linkage::add_pulls(std::span<const Vec3> x, std::span<const double> multipliers,
                        std::span<Vec3> out) const {
  const auto add = [&](std::uint32_t particle, Vec3 by) {
    if (particle < movable_) out[particle] += by;
  };
  for (const RodRow& rod : rods_) {
    const Vec3 by = (multipliers[rod.row - 3 * movable_] * rod.over2) * (x[rod.b] - x[rod.a]);
    add(rod.a, by);
    add(rod.b, -1.0 * by);
  }
  for (const DotRow& each : dots_) {
    const double by = -multipliers[each.row - 3 * movable_] * each.over;
    const Vec3 u = by * each.u.of(x), v = by * each.v.of(x);
    for (std::uint32_t i = 0; i < each.u.count; ++i)
      add(each.u.terms[i].particle, each.u.terms[i].weight * v);
    for (std::uint32_t i = 0; i < each.v.count; ++i)
      add(each.v.terms[i].particle, each.v.terms[i].weight * u);
  }
}

double Linkage::largest_move(std::span<const Vec3> momenta) const {
  double square = 0;
  for (std::uint32_t i = 0; i < movable_; ++i) {
    const Vec3 by = (1 / nominal_masses_[i]) * momenta[i];
    square = std::max(square, dot(by, by));
  }
  return std::sqrt(square);
}

void Linkage::rates(std::span<const Vec3> x, std::span<const Vec3> v, Range of,
                    std::span<double> right) const {
  for (const Elastic& each : elastics_) right[plan_.position(each.row)] = 0;
  if (of.first == of.end) {  // nothing is given
    for (std::uint32_t c = 0; c < constraints_; ++c) right[plan_.position(3 * movable_ + c)] = 0;
    return;
  }
  const auto given = [&](std::uint32_t particle) {
    return particle >= of.first && particle < of.end ? v[particle] : Vec3{};
  };
  const auto sum_given = [&](const Combination& sum) {
    Vec3 out{};
    for (std::uint32_t i = 0; i < sum.count; ++i) out += sum.terms[i].weight * given(sum.terms[i].particle);
    return out;
  };
  for (const RodRow& rod : rods_)
    right[plan_.position(rod.row)] = -rod.over2 * dot(x[rod.b] - x[rod.a], given(rod.b) - given(rod.a));
  for (const DotRow& each : dots_)
    right[plan_.position(each.row)] =
        -each.over * (dot(each.u.of(x), sum_given(each.v)) + dot(each.v.of(x), sum_given(each.u)));
  for (const PinRow& pin : pins_) {
    const Vec3 by = sum_given(pin.sum);
    right[plan_.position(pin.rows[0])] = -by.x;
    right[plan_.position(pin.rows[1])] = -by.y;
    right[plan_.position(pin.rows[2])] = -by.z;
  }
}

void Linkage::bends(std::span<const Vec3> v, std::span<double> right) const {
  for (const Elastic& each : elastics_) right[plan_.position(each.row)] = 0;
  for (const RodRow& rod : rods_) {
    const Vec3 d = v[rod.b] - v[rod.a];
    right[plan_.position(rod.row)] = -rod.over2 * dot(d, d);
  }
  for (const DotRow& each : dots_)
    right[plan_.position(each.row)] = -2 * each.over * dot(each.u.of(v), each.v.of(v));
  for (const PinRow& pin : pins_)
    for (const std::uint32_t row : pin.rows) right[plan_.position(row)] = 0;
}

void Linkage::momenta(std::span<const Vec3> v, std::span<Vec3> out) const {
  for (std::uint32_t i = 0; i < movable_; ++i) out[i] = masses_[i] * v[i];
  for (const Coupling& c : couplings_) {
    out[c.a] += c.mass * v[c.b];
    out[c.b] += c.mass * v[c.a];
  }
}

/// A direction without length has no angle, and nothing pushes along it.
Linkage::AngleSlope Linkage::slope(Vec3 along_u, Vec3 along_v) {
  const auto over = [](double length) { return length > 0 ? 1 / length : 0; };
  const double over_u = over(norm(along_u)), over_v = over(norm(along_v));
  const Vec3 u = over_u * along_u, v = over_v * along_v;
  const double cosine = std::clamp(dot(u, v), -1.0, 1.0);
  const double over_sine = 1 / std::max(std::sqrt(1 - cosine * cosine), least_sine);
  return {detail::acos(cosine), (-over_sine * over_u) * (v - cosine * u),
          (-over_sine * over_v) * (u - cosine * v)};
}

void Linkage::forces(std::span<const Vec3> x, std::span<const Vec3> v, std::span<const Vec3> constant,
                     std::span<Vec3> out) const {
  for (std::uint32_t i = 0; i < movable_; ++i) out[i] = weights_[i] * gravity_ + constant[i];
  for (const Air& air : airs_) {
    const Vec3 axis = air.over * (x[air.b] - x[air.a]);
    const auto pull = [&](double own, double other, std::uint32_t i, std::uint32_t j) {
      if (i >= movable_) return;
      const Vec3 p = own * v[i] + other * v[j];
      const Vec3 along = dot(p, axis) * axis;
      out[i] -= air.linear * along + air.orthogonal * (p - along);
    };
    pull(air.mass.aa, air.mass.ab, air.a, air.b);
    pull(air.mass.bb, air.mass.ab, air.b, air.a);
  }
}

double Linkage::kinetic(std::span<const Vec3> v) const {
  double sum = 0;
  for (std::uint32_t i = 0; i < movable_; ++i) sum += 0.5 * masses_[i] * dot(v[i], v[i]);
  for (const Coupling& c : couplings_) sum += c.mass * dot(v[c.a], v[c.b]);
  return sum;
}

double Linkage::potential(std::span<const Vec3> x, std::span<const Vec3> constant) const {
  double sum = 0;
  for (std::uint32_t i = 0; i < movable_; ++i) sum -= dot(weights_[i] * gravity_ + constant[i], x[i]);
  return sum;
}

double Linkage::turning(std::span<const Vec3> v, std::span<const double> squares,
                        std::span<const std::uint8_t> broken) const {
  double square = 0;
  const auto see = [&](const RodRow& rod) {
    const Vec3 d = v[rod.b] - v[rod.a];
    square = std::max(square, rod.over2 * dot(d, d) / (squares.empty() ? 1 : squares[rod.number]));
  };
  for (const RodRow& rod : rods_) see(rod);
  for (std::size_t i = 0; i < giving_rods_.size(); ++i)
    if (broken.empty() || broken[i] == 0) see(giving_rods_[i]);
  return std::sqrt(square);
}

/// A linkage without fixed particles, taken as a rigid body.
struct Linkage::Whole {
  Vec3 center{}, velocity{}, angular{};
  Sym3 inertia{};
};

Linkage::Whole Linkage::whole(std::span<const Vec3> x, std::span<const Vec3> v) const {
  Vec3 linear{}, moment{};
  for (std::uint32_t i = 0; i < movable_; ++i) {
    linear += weights_[i] * v[i];
    moment += weights_[i] * x[i];
  }
  Whole out{.center = (1 / mass_) * moment, .velocity = (1 / mass_) * linear};
  for (std::uint32_t i = 0; i < movable_; ++i) {
    const Vec3 a = x[i] - out.center;
    out.angular += masses_[i] * cross(a, v[i] - out.velocity);
    out.inertia += Sym3::diagonal(masses_[i] * dot(a, a)) - outer_both((0.5 * masses_[i]) * a, a);
  }
  for (const Coupling& c : couplings_) {
    const Vec3 a = x[c.a] - out.center, b = x[c.b] - out.center;
    out.angular += c.mass * (cross(a, v[c.b] - out.velocity) + cross(b, v[c.a] - out.velocity));
    out.inertia += Sym3::diagonal(2 * c.mass * dot(a, b)) - outer_both(c.mass * a, b);
  }
  return out;
}

Vec3 Linkage::angular_momentum(std::span<const Vec3> x, std::span<const Vec3> v) const {
  return whole(x, v).angular;
}

void Linkage::turn_to(Vec3 angular, std::span<const Vec3> x, std::span<Vec3> v) const {
  const Whole now = whole(x, v);
  const Vec3 turn = spin_of(now.inertia, angular - now.angular);
  for (std::uint32_t i = 0; i < movable_; ++i) v[i] += cross(turn, x[i] - now.center);
}

double Linkage::split(std::span<const Vec3> x, std::span<const Vec3> v, std::span<Vec3> rigid) const {
  const Whole now = whole(x, v);
  const Vec3 turn = spin_of(now.inertia, now.angular), center = now.center, velocity = now.velocity;
  double energy = 0;
  for (std::uint32_t i = 0; i < movable_; ++i) {
    rigid[i] = velocity + cross(turn, x[i] - center);
    const Vec3 loose = v[i] - rigid[i];
    energy += 0.5 * masses_[i] * dot(loose, loose);
  }
  for (const Coupling& c : couplings_) energy += c.mass * dot(v[c.a] - rigid[c.a], v[c.b] - rigid[c.b]);
  return energy;
}

void Linkage::brake_joints(double h, std::span<const Vec3> x, std::span<Vec3> v, Array<Vec3>& rigid) const {
  if (joint_drag_ == 0 || (movable_ == 1 && !is_grounded())) return;
  const double kept = detail::exp(-h * joint_drag_);
  rigid.assign(movable_, Vec3{});
  if (!is_grounded()) split(x, v, rigid);
  for (std::uint32_t k = 0; k < movable_; ++k) v[k] = rigid[k] + kept * (v[k] - rigid[k]);
}

}  // namespace plumb::detail
