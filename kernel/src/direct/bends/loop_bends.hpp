#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "direct/bends/bend_law.hpp"
#include "direct/bends/island_rods.hpp"
#include "direct/bends/loop_bend.hpp"
#include "direct/loops/loop_rod.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/scene.hpp"

namespace plumb::detail {

struct LoopState;
struct LoopWorkspace;
struct SubstepEnd;

/// An island has these numbers of a bend. Those of the law hold while its rods have the lengths of the scene.
struct LoopBendNumbers {
  BendNumbers law;
  std::array<std::uint32_t, 2> rods;  ///< The island's rods from a to b and from b to c, or IslandRods::none.
};

/// Returns the weights of a bend's particles in w (1/m), of rods of these lengths (m).
inline std::array<double, 3> bend_weights(double first, double second) {
  return {-1 / first, 1 / first + 1 / second, -1 / second};
}

/// A scene's bends and twists, as solvers of islands take them.
struct BendTable {
  explicit BendTable(const Scene& scene);
  const Scene& scene;
  Array<std::array<double, 2>> lengths;  ///< See bend_lengths().
  Array<double> twist_lengths;           ///< See twist_length().
};

/// Gives an island the numbers of its bends, in the order of its topology.
void load_bends(LoopState& state, const BendTable& table, const IslandRods& rods,
                std::span<const std::uint32_t> bends);

/// Measures w of every bend at the start of a substep. Rods that change their length change its numbers, and
/// a broken rod takes it out.
void measure_bends(const LoopState& state, LoopWorkspace& work);

/// Writes what bends add to Newton's matrix into `values` of the island's system, and adds what every node
/// resists by them to `resists`. `gives` asks for definite bends (definite_bend_pull()).
void write_bends(const LoopState& state, double theta, bool gives, const LoopWorkspace& work,
                 std::span<double> values, std::span<double> resists);

/// Adds what bends pull to the right-hand side, where node i is at positions[i].
void pull_by_bends(const LoopState& state, double theta, bool gives, const LoopWorkspace& work,
                   std::span<double> right);

/// Returns the work of bends in a substep of gradient mid. Directions turn by `least` at least for its scale.
LoopWork work_of_bends(const LoopState& state, const LoopWorkspace& work, double least);

/// Adds up what bends ask of fixed vertices in a substep, and finds what they pull with along rods
/// (LoopLaws::bent).
void hold_bends(LoopState& state, const SubstepEnd& end, const LoopWorkspace& work);

/// Returns the energy of all bends at the end of a substep, in the same units.
double energy_of_bends(const LoopState& state, const LoopWorkspace& work);

}  // namespace plumb::detail
