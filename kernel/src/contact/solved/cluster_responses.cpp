// This file finds how islands answer to pushes.

#include <algorithm>
#include <tuple>

#include "contact/solved/cluster_limits.hpp"
#include "contact/solved/cluster_stepper.hpp"

namespace plumb::detail {
using namespace contact_limits;

namespace {

std::uint32_t padded(std::size_t batches) {
  return static_cast<std::uint32_t>(batches * simd::kkt_lanes);
}

}  // namespace

void ClusterStepper::find_responses(bool of_elastic_ones_alone) {
  if (is_wide_) return find_free_responses();
  for (std::uint32_t i = 0; i < count_; ++i)
    if (Island& each = islands_[i];
        !each.sides.empty() && !(of_elastic_ones_alone && each.state->laws.empty()))
      couple(each);
  for (std::size_t r = rows_.size(); r-- > 0;) {
    Row& row = rows_[r];
    double own = 0, heaviest = 0;
    row.across[0] = row.across[1] = 0;
    for (std::uint32_t i = 0; i < row.ends; ++i) {
      Island& island = islands_[row.island[i]];
      const std::uint32_t side = row.side[i];
      row.end[i] = {island.speed.front().of, island.push.front().of, island.row(side), side,
                    padded(island.batches())};
      own += row.end[i].coupling[side];
      heaviest = std::max(heaviest, island.state->linkage->mass());
      if (row.kind != Kind::normal) continue;
      for (std::uint32_t axis = 0; axis < 2; ++axis) row.across[axis] += row.end[i].coupling[side + 1 + axis];
    }
    if (row.ends == 2 && row.island[0] == row.island[1]) own += couple_ends(row);
    row.own = own;
    row.over = own * heaviest > held_response ? 1 / own : 0;
    if (row.kind != Kind::normal) continue;
    for (std::uint32_t axis = 0; axis < 2; ++axis) row.across[axis] *= rows_[r + 1 + axis].over;
  }
}

/// Returns by how much the ends of a row within one island answer to each other, and adds what a normal push
/// takes from the rows of sliding so.
double ClusterStepper::couple_ends(Row& row) {
  const auto [one, two] = row.side;
  for (std::uint32_t axis = 0; row.kind == Kind::normal && axis < 2; ++axis)
    row.across[axis] += row.end[0].coupling[two + 1 + axis] + row.end[1].coupling[one + 1 + axis];
  return 2 * row.end[0].coupling[two];
}

/// Finds what every side of the island moves by when one side gets a push of one. Eight sides are solved
/// at once.
void ClusterStepper::couple(Island& island) {
  constexpr std::size_t lanes = simd::kkt_lanes;
  const Linkage& linkage = *island.state->linkage;
  const std::uint32_t unknowns = linkage.plan().unknowns();
  const std::size_t batches = island.batches(), count = island.sides.size();
  island.response.assign(batches * unknowns, Lanes{});
  island.coupling.resize(count * batches);
  island.speed.resize(batches);
  island.push.assign(batches, Lanes{});

  // A side is a list of unknowns and of the weights that they have in it.
  constexpr std::size_t most = 2 * 3 * std::tuple_size_v<decltype(Combination::terms)>;
  std::uint32_t slots[most];
  double factors[most];
  const auto gather = [&](const Side& side) {
    std::uint32_t used = 0;
    const auto add = [&](Sum sum, Vec3 along) {
      for (std::uint32_t k = sum.first; k < sum.end; ++k) {
        const auto [particle, weight] = island.terms[k];
        if (particle >= linkage.movable()) continue;
        const std::uint32_t slot = linkage.slot(particle);
        const double by[3] = {weight * along.x, weight * along.y, weight * along.z};
        for (std::uint32_t axis = 0; axis < 3; ++axis) {
          slots[used] = slot + axis;
          factors[used++] = by[axis];
        }
      }
    };
    add(side.a, side.along_a);
    add(side.b, side.along_b);
    return used;
  };
  for (std::size_t s = 0; s < count; ++s) {
    const std::uint32_t used = gather(island.sides[s]);
    for (std::uint32_t k = 0; k < used; ++k)
      island.response[s / lanes * unknowns + slots[k]].of[s % lanes] += factors[k];
  }
  kernels_->solve_lanes(linkage.plan().pattern(), island.state->factors.data(), batches,
                        island.response.front().of);
  island.ground.keep_slopes();
  for (std::size_t s = 0; s < count; ++s) {
    const std::uint32_t used = gather(island.sides[s]);
    kernels_->combine(island.response.front().of, unknowns, batches, {slots, factors, used},
                      island.coupling[s * batches].of);
  }
}

}  // namespace plumb::detail
