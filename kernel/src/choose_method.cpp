#include "choose_method.hpp"

#include <algorithm>

#include "plumb/layouts/trees.hpp"

namespace plumb::detail {
namespace {

/// Rods of an island with loops up to which the sparse factorisation pays; see choose_method().
constexpr std::size_t most_factored_rods = 20000;

}  // namespace

Method choose_method(const Scene& scene, const layouts::LocalGraph& island,
                     std::span<const std::uint32_t> rods, const Settings& settings) {
  if (layouts::find_tree(island.view())) return Method::direct;
  const bool carries_mass =
      mass_model_of(settings) == MassModel::consistent &&
      std::any_of(rods.begin(), rods.end(), [&](std::uint32_t rod) { return scene.rods[rod].mass > 0; });
  return carries_mass || rods.size() <= most_factored_rods ? Method::direct : Method::relax;
}

}  // namespace plumb::detail
