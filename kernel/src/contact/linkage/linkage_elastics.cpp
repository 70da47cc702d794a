// This file makes the elastics of a linkage, and finds where they are and how they pull.

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "contact/linkage/linkage.hpp"
#include "scene/bends/bends.hpp"
#include "scene/bends/curvature.hpp"
#include "scene/springs/turn.hpp"

namespace plumb::detail {
namespace {

Across across_of(const Elastic& elastic, std::span<const Vec3> x) {
  return {elastic.sums[2].of(x), elastic.sums[0].of(x), elastic.sums[1].of(x)};
}

}  // namespace

Array<std::uint32_t> Linkage::movable_of(std::span<const Combination> sums) const {
  Array<std::uint32_t> out;
  for (const Combination& sum : sums)
    for (std::uint32_t i = 0; i < sum.count; ++i) {
      const std::uint32_t particle = sum.terms[i].particle;
      if (particle < movable_ && std::find(out.begin(), out.end(), particle) == out.end())
        out.push_back(particle);
    }
  return out;
}

void Linkage::add_elastic(Elastic elastic, const ElasticLaw& law) {
  elastic.touched = movable_of(elastic.sums);
  elastic.row = 3 * movable_ + constraints_ + static_cast<std::uint32_t>(elastics_.size());
  elastics_.push_back(std::move(elastic));
  elastic_laws_.push_back(law);
}

void Linkage::add_elastics(const Scene& part) {
  using Kind = Elastic::Kind;
  const auto count = [&] { return static_cast<std::uint32_t>(elastics_.size()); };
  const auto laws_from = [&](std::uint32_t first) { return std::span(elastic_laws_).subspan(first); };
  for (std::size_t i = 0; i < part.rods.size(); ++i) {
    const Rod& rod = part.rods[i];
    if (rod.law.is_rigid()) continue;
    const Combination apart = difference(Point{{rod.b}, {1}}, Point{{rod.a}, {1}});
    add_elastic(
        {.kind = Kind::distance, .sums = {apart}},
        {rod_length(part, i), rod.law.stiffness, rod.law.damping, 0, rod.law.one_sided, rod.law.strength});
    breaks_ = breaks_ || std::isfinite(rod.law.strength);
  }
  for (std::uint32_t i = 0; i < part.angles.size(); ++i) {
    const AngleControl& angle = part.angles[i];
    of_angles_.push_back({count(), 0});
    if (angle.stiffness == 0 && angle.damping == 0) continue;
    of_angles_.back().count = 1;
    add_elastic({.kind = Kind::angle, .sums = {angles_[i].u, angles_[i].v}, .angle = i}, {});
    set_laws(angle, laws_from(of_angles_.back().first));
  }
  for (const Spring& spring : part.springs) {
    of_springs_.push_back({count(), spring.length == 0 ? 4u : 1u});
    const Combination apart = difference(spring.b, spring.a);
    add_elastic({.kind = Kind::distance, .sums = {apart}}, {});
    if (spring.length == 0)
      for (const Vec3 axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}})
        add_elastic({.kind = Kind::along, .sums = {apart}, .axis = axis}, {});
    set_laws(spring, laws_from(of_springs_.back().first));
  }
  for (const Torsion& torsion : part.torsions) {
    of_torsions_.push_back({count(), 1});
    add_elastic({.kind = Kind::turn,
                 .sums = {difference(torsion.u.to, torsion.u.from), difference(torsion.v.to, torsion.v.from),
                          difference(torsion.axis.to, torsion.axis.from)}},
                {});
    set_laws(torsion, laws_from(of_torsions_.back().first));
  }
  add_bends(part);
}

void Linkage::add_bends(const Scene& part) {
  using Kind = Elastic::Kind;
  const Array<std::array<double, 2>> lengths = bend_lengths(part);
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> giving, rods;
  for (std::uint32_t i = 0; i < part.rods.size() && !part.bends.empty(); ++i)
    rods[std::minmax(part.rods[i].a, part.rods[i].b)] = i;
  for (std::uint32_t i = 0; i < giving_rods_.size() && !part.bends.empty(); ++i)
    giving[std::minmax(giving_rods_[i].a, giving_rods_[i].b)] = i;
  for (std::size_t i = 0; i < part.bends.size(); ++i) {
    const Bend& bend = part.bends[i];
    BendElastics& made =
        bends_.emplace_back(BendElastics{bend.stiffness, bend.damping, curvature_of_angle(bend.angle),
                                         static_cast<std::uint32_t>(elastics_.size())});
    for (const std::uint32_t end : {bend.a, bend.c})
      if (const auto rod = giving.find(std::minmax(bend.b, end)); rod != giving.end())
        made.rods.push_back(rod->second);
    for (std::size_t side = 0; side < 2; ++side)
      if (const auto rod = rods.find(std::minmax(bend.b, side == 0 ? bend.a : bend.c)); rod != rods.end())
        made.sides[side] = rod->second;
    const Combination w = bend_vector(bend, lengths[i]);
    if (made.is_straight())
      for (const Vec3 axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}})
        add_elastic({.kind = Kind::along, .sums = {w}, .axis = axis}, {});
    if (!made.is_straight() || bend.damping > 0) add_elastic({.kind = Kind::distance, .sums = {w}}, {});
    made.count = static_cast<std::uint32_t>(elastics_.size()) - made.first;
  }
}

bool Linkage::is_of_bend(std::size_t elastic) const {
  return !bends_.empty() && elastic >= bends_.front().first && elastic < first_grab_;
}

double Linkage::number(const Elastic& elastic, std::span<const Vec3> x, double near) const {
  switch (elastic.kind) {
    case Elastic::Kind::distance:
      return norm(elastic.sums[0].of(x));
    case Elastic::Kind::along:
      return dot(elastic.axis, elastic.sums[0].of(x));
    case Elastic::Kind::angle:
      return slope(angles_[elastic.angle], x).value;
    case Elastic::Kind::turn:
      break;
  }
  return across_of(elastic, x).turn_near(near);
}

ElasticSlope Linkage::slope(const Elastic& elastic, std::span<const Vec3> x) const {
  switch (elastic.kind) {
    case Elastic::Kind::distance: {
      const Vec3 apart = elastic.sums[0].of(x);
      const double length = norm(apart);
      return {length > 0 ? (1 / length) * apart : Vec3{}};
    }
    case Elastic::Kind::along:
      return {elastic.axis};
    case Elastic::Kind::angle: {
      const AngleSlope at = slope(angles_[elastic.angle], x);
      return {at.along_u, at.along_v};
    }
    case Elastic::Kind::turn:
      break;
  }
  const auto [axis, u, v, over_axis, u_along, v_along] = across_of(elastic, x);
  const double u_square = dot(u, u), v_square = dot(v, v);
  if (!(u_square > 0 && v_square > 0)) return {};
  const double over_u = 1 / u_square, over_v = 1 / v_square;
  // Nothing changes where all three turn together, which tells how the axis alone changes it.
  const Vec3 sideways = (u_along * over_u) * u - (v_along * over_v) * v;
  return {(-over_u) * cross(axis, u), over_v * cross(axis, v), over_axis * cross(axis, sideways)};
}

void Linkage::push_along(const Elastic& elastic, const ElasticSlope& slope, double by,
                         std::span<Vec3> out) const {
  for (std::size_t s = 0; s < slope.size(); ++s)
    for (std::uint32_t i = 0; i < elastic.sums[s].count; ++i) {
      const auto [particle, weight] = elastic.sums[s].terms[i];
      if (particle < movable_) out[particle] += (by * weight) * slope[s];
    }
}

double Linkage::rate(const Elastic& elastic, const ElasticSlope& slope, std::span<const Vec3> v, Range of) {
  double out = 0;
  for (std::size_t s = 0; s < slope.size(); ++s)
    for (std::uint32_t i = 0; i < elastic.sums[s].count; ++i) {
      const auto [particle, weight] = elastic.sums[s].terms[i];
      if (particle >= of.first && particle < of.end) out += weight * dot(slope[s], v[particle]);
    }
  return out;
}

void Linkage::couple(const Elastic& elastic, const ElasticSlope& slope, double soft,
                     std::span<simd::Block> matrix) const {
  const std::span<double> values{matrix.front().of, matrix.size() * (sizeof(simd::Block) / sizeof(double))};
  for (std::size_t s = 0; s < slope.size(); ++s)
    add_gradient(elastic.sums[s], slope[s], elastic.touched, elastic.places, values);
  values[plan_.place(elastic.row, elastic.row)] = -soft;
}

}  // namespace plumb::detail
