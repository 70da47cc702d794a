#pragma once

#include <cstdint>
#include <span>

#include "interface/grab.hpp"
#include "relax/block.hpp"

namespace plumb::detail {

/// Holds a grab of a particle that is relaxed. Rods see a heavier particle, and its kick pulls.
struct BlockGrab : HeldGrab {
  std::uint32_t slot = 0;
  double mass = 0;        ///< kg, of the particle
  Vec3 kick{};            ///< m, of gravity and forces on the particle alone
  bool is_first = true;   ///< of those on its particle
  GrabSubstep substep{};  ///< the one under way
  Vec3 moved{};           ///< m, in that
};

/// Lists the grabs of a block, with how forces act in its substeps.
struct BlockGrabs {
  std::span<BlockGrab> all;
  double kick = 0;   ///< s²
  double h = 0;      ///< s
  double decay = 1;  ///< of displacements, or with gradient mid in either half

  /// Begins a substep of positions [q0, q1): writes kicks.
  template <class T>
  void begin(Block<T>& block, Gradient gradient, const T* last, std::uint32_t q0, std::uint32_t q1) const;
  /// Takes note of how far sweeps let particles go.
  template <class T>
  void see(const Block<T>& block, const T* own, std::uint32_t q0, std::uint32_t q1) const;
  /// Ends it, where displacements have become what they are for the next substep.
  template <class T>
  void end(Block<T>& block, Gradient gradient, bool is_guarded, T* own, std::uint32_t q0,
           std::uint32_t q1) const;
};

template <class Archive>
void visit_members(Archive& archive, BlockGrab& of) {
  archive(static_cast<HeldGrab&>(of), of.slot, of.mass, of.is_first);
}

}  // namespace plumb::detail
