// This file adds up what the constraints and elastics of a linkage pull with.

#include "contact/pulls/linkage_pulls.hpp"

#include <algorithm>
#include <cmath>

#include "contact/linkage/linkage.hpp"

namespace plumb::detail {

void LinkagePulls::begin_step() {
  for (Array<double>* const of : {&rods, &angles, &elastics}) std::fill(of->begin(), of->end(), 0.0);
  for (Array<Vec3>* const of : {&pins, &along_first, &shapes, &fixed})
    std::fill(of->begin(), of->end(), Vec3{});
  touched.begin_step();
}

LinkagePulls Linkage::make_pulls() const {
  return {.counts = true,
          .rods = Array<double>(rods()),
          .pins = Array<Vec3>(pins_.size()),
          .angles = Array<double>(angles_.size()),
          .elastics = Array<double>(elastics_.size()),
          .along_first = Array<Vec3>(elastics_.size()),
          .shapes = Array<Vec3>(shapes_.size() + hulls_.size()),
          .fixed = Array<Vec3>(particles_ - movable_),
          .touched = {}};
}

std::optional<std::size_t> Linkage::elastic_of_rod(std::uint32_t number) const {
  const auto at = std::lower_bound(giving_rods_.begin(), giving_rods_.end(), number,
                                   [](const RodRow& rod, std::uint32_t than) { return rod.number < than; });
  if (at == giving_rods_.end() || at->number != number) return std::nullopt;
  return static_cast<std::size_t>(at - giving_rods_.begin());
}

std::uint32_t Linkage::row_of_rod(std::uint32_t number) const {
  return std::lower_bound(rods_.begin(), rods_.end(), number,
                          [](const RodRow& rod, std::uint32_t than) { return rod.number < than; })
      ->row;
}

void Linkage::take_multipliers(std::span<const double> solved, double by, std::span<double> out) const {
  for (std::uint32_t c = 0; c < out.size(); ++c) out[c] += by * solved[plan_.position(3 * movable_ + c)];
}

void Linkage::push_fixed(Terms at, Vec3 impulse, LinkagePulls& pulls) const {
  for (const auto& [particle, weight] : at)
    if (particle >= movable_) pulls.fixed[particle - movable_] += weight * impulse;
}

void Linkage::count_pulls(std::span<const Vec3> x, std::span<const double> squares,
                          std::span<const double> multipliers, double by, LinkagePulls& pulls) const {
  const auto impulse = [&](std::uint32_t row) { return by * multipliers[row - 3 * movable_]; };
  for (const RodRow& rod : rods_) {
    const double over_length = impulse(rod.row) * rod.over2;
    pulls.rods[rod.number] +=
        over_length / std::sqrt(rod.over2) * (squares.empty() ? 1 : std::sqrt(squares[rod.number]));
    const Vec3 pulled = over_length * (x[rod.b] - x[rod.a]);
    if (rod.a >= movable_) pulls.fixed[rod.a - movable_] += pulled;
    if (rod.b >= movable_) pulls.fixed[rod.b - movable_] -= pulled;
  }
  for (const DotRow& each : dots_) {
    const double along = -each.over * impulse(each.row);
    push_fixed(each.u, along * each.v.of(x), pulls);
    push_fixed(each.v, along * each.u.of(x), pulls);
  }
  for (std::size_t i = 0; i < pins_.size(); ++i) {
    const auto& rows = pins_[i].rows;
    const Vec3 pushed{-impulse(rows[0]), -impulse(rows[1]), -impulse(rows[2])};
    pulls.pins[i] += pushed;
    push_fixed(pins_[i].sum, pushed, pulls);
  }
}

void Linkage::count_pull(std::size_t elastic, std::span<const Vec3> x, double pull,
                         LinkagePulls& pulls) const {
  if (pull == 0) return;
  const Elastic& each = elastics_[elastic];
  const ElasticSlope along = slope(each, x);
  if (elastic < giving_rods_.size()) pulls.rods[giving_rods_[elastic].number] += pull;
  if (is_of_bend(elastic))
    for (const AlongRod& part : along_rods(bend_of(bends_, elastic), each.sums[0], x, pull * along[0]))
      if (part.rod) pulls.rods[*part.rod] += part.pull;
  pulls.elastics[elastic] += pull;
  pulls.along_first[elastic] += pull * along[0];
  for (std::size_t s = 0; s < along.size(); ++s) push_fixed(each.sums[s], -pull * along[s], pulls);
}

}  // namespace plumb::detail
