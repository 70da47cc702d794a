#include "step/choose_method.hpp"

#include <algorithm>
#include <cmath>

namespace plumb::detail {
namespace {

/// Particles in the widest layer up to which an island with loops is thin: rings, ladders and trusses are,
/// nets are not. Measured by bench_direct, to an error of 1e-4: a truss of 100 bays is solved 20 to some
/// hundred times faster than relaxed, a ring of 24 about as fast; nets of 32 x 32 and 128 x 128 two and
/// seven times as fast, but at errors of a hundredth relaxation is cheaper there.
constexpr std::size_t thin_layer = 12;

/// From this accuracy on composed substeps take less time. They cost five times as much and are bound to the
/// fastest wave like all others, which is the faster against the motion the longer a tree is. For trees
/// fitted to where plumb frontier has both orders at the same error in the same time: chains of 5 to 100
/// links with end masses of 1 to 1000, trees of rods with mass. For loops between its truss, where they pay
/// from 1e-6 on, and its nets, at 1e-7 still hardly.
double worth_order_4(bool is_tree, std::size_t rods) {
  const auto n = static_cast<double>(rods);
  return is_tree ? 4.5e-3 / (n * std::sqrt(n)) : 3e-5;
}

/// Particles of the widest layer, counted in rods from one end. Linear time.
std::size_t widest_layer(const layouts::Graph& island) {
  const layouts::Incidence incidence = layouts::edges_by_vertex(island);
  std::uint32_t start = 0;
  std::size_t widest = 0;
  for (int pass = 0; pass < 2; ++pass) {  // the second starts where the first ended, at one end
    std::vector<std::uint8_t> seen(island.vertices, 0);
    std::vector<std::uint32_t> layer{start}, next;
    seen[start] = 1;
    widest = 0;
    while (!layer.empty()) {
      widest = std::max(widest, layer.size());
      start = layer.front();
      next.clear();
      for (const std::uint32_t v : layer)
        for (const std::uint32_t e : incidence.edges(v)) {
          const std::uint32_t other = layouts::other_end(island.edges[e], v);
          if (seen[other] != 0 || island.movable[other] == 0) continue;
          seen[other] = 1;
          next.push_back(other);
        }
      layer.swap(next);
    }
  }
  return widest;
}

}  // namespace

bool is_thin(const layouts::Graph& island) {
  return widest_layer(island) <= thin_layer;
}

bool carries_mass(const Scene& scene, std::span<const std::uint32_t> rods, MassModel model) {
  return model == MassModel::consistent &&
         std::any_of(rods.begin(), rods.end(), [&](std::uint32_t rod) { return scene.rods[rod].mass > 0; });
}

Method choose_method(const Scene& scene, bool shape_is_for_direct, std::span<const std::uint32_t> rods,
                     const Settings& settings) {
  if (shape_is_for_direct || settings.accuracy) return Method::direct;
  return carries_mass(scene, rods, mass_model_of(settings)) ? Method::direct : Method::relax;
}

Gradient choose_gradient(const Scene& scene, bool is_tree, std::span<const std::uint32_t> rods,
                         const Settings& settings) {
  if (settings.gradient) return *settings.gradient;
  if (!settings.accuracy) return Gradient::mid;
  // Steps of old cost a fraction of mid's where multipliers alone are unknown, else as much; and nets of rods
  // with mass that are drawn straight between their corners take it 130 times as many.
  return is_tree || !carries_mass(scene, rods, mass_model_of(settings)) ? Gradient::old : Gradient::mid;
}

std::uint32_t choose_time_order(Gradient gradient, bool is_tree, std::size_t rods, const Settings& settings) {
  return settings.accuracy && *settings.accuracy <= worth_order_4(is_tree, rods) &&
                 settings.precision == Precision::double_ && gradient == Gradient::old
             ? 4
             : 2;
}

}  // namespace plumb::detail
