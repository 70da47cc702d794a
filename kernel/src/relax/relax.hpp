#pragma once

#include <cstdint>

#include "plumb/settings.hpp"
#include "plumb/world.hpp"
#include "relax/block.hpp"
#include "relax/grabs/block_grabs.hpp"
#include "simd/relax/relax_kernels.hpp"
#include "threads/team.hpp"
#include "time/leftovers.hpp"

namespace plumb::detail {

/// A step needs to know this besides the block.
template <class T>
struct RelaxSettings {
  const simd::Kernels<T>* kernels;
  Gradient gradient;
  SweepOrder order;
  StopRule stop;
  std::uint32_t substeps;
  T decay;  ///< Drag multiplies displacements by it, per substep or, with gradient mid, per half.
  double budget_us = 0;  ///< It is for this block and one substep, if the stop rule has a budget.
  /// Rods that give need the first for the first substep, which may follow one of another length, and the
  /// second for the others.
  simd::LawTerms<T> first_terms{}, terms{};
  /// Make impulses of what sweeps moved rods by, in 1/s, see Block::count_moves(); 0 if nobody asks.
  double first_pull = 0, pull = 0;
  double h = 0;                          ///< substep, in s
  double start = 0;                      ///< when relax_alone() begins, in s after the step did
  Leftovers leftovers{};                 ///< as the first substep finds them
  const Constants* constants = nullptr;  ///< of the rods; needed where leftovers are kept
  BlockGrabs grabs{};                    ///< of particles that something grabs
};

/// Advances positions [q0, q1) of a block by all substeps on the calling thread. The positions must not
/// depend on others. Once all positions of the block are advanced, by whatever threads, the caller calls
/// Block::count_substeps().
template <class T>
void relax_alone(Block<T>& block, std::uint32_t q0, std::uint32_t q1, const RelaxSettings<T>& settings,
                 StepReport& report);

/// Advances a whole block by its substep number `substep` with all threads of the team, and counts it.
template <class T>
void relax_block(Block<T>& block, const RelaxSettings<T>& settings, std::uint32_t substep, StepReport& report,
                 Team& team);

}  // namespace plumb::detail
