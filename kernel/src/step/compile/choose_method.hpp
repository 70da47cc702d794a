#pragma once

#include <cstdint>
#include <span>

#include "direct/direct_solvers.hpp"
#include "interface/island_shape.hpp"
#include "plumb/layouts/graph.hpp"
#include "plumb/scene.hpp"
#include "plumb/settings.hpp"

namespace plumb::detail {

/// Islands are trees, or have loops and are thin, wide or vast (see island_shape.hpp). A tied tree closes
/// loops through anchors, of which it hangs from two or more.
enum class IslandShape : std::uint8_t { tree, tied, thin, wide, vast };
inline bool is_tree(IslandShape shape) {
  return shape == IslandShape::tree || shape == IslandShape::tied;
}

/// Returns what method automatic takes for an island. Ten sweeps let a net of 64 x 64 particles stretch to
/// three times its size, so direct takes what it can. Relax takes vast islands, whose factorisation would
/// need more time and memory than there is, unless rods have mass or give, which relaxation cannot represent,
/// or there is an accuracy, which it cannot promise.
Method choose_method(const Scene& scene, IslandShape shape, std::span<const std::uint32_t> rods,
                     const Settings& settings);

/// Returns the gradient of an island's direct solve, which is the one that is set, or else mid, which keeps
/// energy at any step. Wide islands of rigid massless rods have new, as cloth is expected to come to rest:
/// with mid, the creases of a net that falls whip for ever, and are as dear to solve. A net of 32 x 32 with 5
/// % slack takes 43 Newton steps a frame with mid and 4 with new.
///
/// With an accuracy the gradient is old, but mid for loops of rods with mass. Trees may then change to mid
/// and back (DirectRules::changes_gradient). In tied trees with mass, old must pay by its order 4. In steps
/// that change it lets energy drift: 40 four-bars at an accuracy of 1e-4 are 400 times nearer to the truth
/// after 20 s with mid, by as many steps.
Gradient choose_gradient(const Scene& scene, IslandShape shape, std::span<const std::uint32_t> rods,
                         const Settings& settings);

/// Returns the time order of an island's direct solve: 4 where all rods are rigid and the accuracy is fine
/// enough for that to pay, else 2.
std::uint32_t choose_time_order(const Scene& scene, Gradient gradient, bool is_tree,
                                std::span<const std::uint32_t> rods, const Settings& settings);

/// Says how an island is moved.
struct Choice {
  Method method = Method::relax;
  DirectRules direct{};  ///< of method direct

  bool operator==(const Choice&) const = default;
};

/// Names an island of particles and rods: its graph, which method automatic needs, and the scene's numbers of
/// both.
struct IslandNumbers {
  const layouts::Graph& graph;
  std::span<const std::uint32_t> particles, rods;
};

/// Chooses for an island of particles and rods. `masses` (kg) are lumped_masses() of the scene, if the
/// precision is float.
Choice choose(const Scene& scene, const IslandNumbers& island, std::span<const double> masses,
              const Settings& settings);
/// Chooses for an island with elements. Method automatic solves it directly, with gradient mid if none is
/// set: gradient old knows no elements.
Choice choose_with_elements(const Settings& settings);

}  // namespace plumb::detail
