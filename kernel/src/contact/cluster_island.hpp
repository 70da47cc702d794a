#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "contact/cluster_rows.hpp"
#include "contact/elastics/elastic.hpp"
#include "contact/ground/ground_contacts.hpp"
#include "contact/ground/placed_hulls.hpp"
#include "contact/linkage/linkage_state.hpp"
#include "contact/shapes/bounds.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// This is what a substep knows of one island of a cluster.
struct ClusterIsland {
  using Lanes = simd::Lanes;
  using Side = ClusterRows::Side;

  LinkageState* state = nullptr;
  bool awake = false;
  Bounds bounds{};
  double moves = 0;  ///< m, the ends of its shapes in the substep, at most
  /// Boxes around its capsules, and around all of them. Contacts of capsules are in sight only where such
  /// boxes of two islands overlap.
  Array<Bounds> sights;
  Bounds sight{};
  Array<Vec3> d, there, v, momentum, force, impulse, rigid, step;
  /// Where on the way from the start of a substep (0) to its end (1) constraints' directions are taken.
  double theta = 0;
  double h = 0, kick = 0;      ///< s and s², by which forces count in that substep
  Array<Vec3> at;              ///< m, where directions of the factors are, if theta is not 0
  Array<Vec3> along;           ///< m, where they are to be
  Array<Vec3> bent;            ///< kg m, by how much they pull otherwise there, as far as d has it
  Array<Vec3> lag;             ///< kg m, what d lacks of that
  double last_violation = 0;   ///< that which the last correction of this substep found; none is infinite
  Array<simd::Quad> unknowns;  ///< of a solve: right hand sides, then the solution
  /// Multipliers of constraints and elastics, kg m and kg m/s or without the metre, if pulls count.
  Array<double> pulls, end_pulls;
  Array<ElasticStep> elastics;
  Array<double> by_bends;  ///< N s, what bends add to the pulls of rods that give, if any may break
  Array<Combination::Term> terms;
  Array<Side> sides;
  PlacedHulls hulls;
  GroundContacts ground;        ///< those with fixed things, if there are many
  bool is_predicted = false;    ///< d is where it flies, or else a guess
  bool squeezed = false;        ///< it hangs somewhere and hardly answers to what pushes it
  bool buckles = false;         ///< its rods stand straight on what it touches, and are to have room
  bool is_placed = false;       ///< its rods are at their lengths, or are to stay as they are
  bool rocks = false;           ///< its rods rock on what is round, see may_rock()
  double held = 0;              ///< 1/kg, a response that is no more is rounding
  bool answers_anew = false;    ///< its factors are others than those by which sides' answers were found
  bool keeps_responses = true;  ///< those of all sides are kept, not those of the last eight alone
  std::size_t next_kept = 0;    ///< where the next contact is likely to be found again
  // Padded to whole lanes, or by lanes:
  Array<Lanes> response;  ///< of eight sides after the other, of every unknown; the last ones if few
  Array<Lanes> coupling;  ///< G, a row for every side
  Array<Lanes> speed;     ///< what each side sees of d or v
  Array<Lanes> push;      ///< on each side, not yet applied
  Array<Lanes> sum;       ///< of responses
  Array<Lanes> last_speed, last_push;  ///< after the last sweep, where these have momentum
  // Where pushes are found freely:
  Array<Vec3> free;         ///< m or m/s, how particles would move if they were free
  Array<Vec3> last_motion;  ///< m or m/s, after the last sweep
  Array<double> last_pulls;

  std::span<double> right() { return numbers(unknowns); }
  /// Returns what weight and constant forces pull with at most, N.
  double pull() const {
    double out = state->linkage->mass() * norm(state->linkage->gravity());
    for (const Vec3 each : state->force) out += norm(each);
    return out;
  }
  /// Returns where the directions of the factors of positions are.
  std::span<const Vec3> directions() const { return theta > 0 ? at : state->x; }
  /// Keeps a share of multipliers and adds another of those that a solve has found.
  void take_pulls(Array<double>& to, double keep, double by) {
    for (double& each : to) each *= keep;
    state->linkage->take_multipliers(right(), by, to);
  }
  /// Returns whether a cable that was slack where a substep that was solved starts has come taut.
  bool comes_taut() const {
    constexpr double least_slack = 1e-9;  // of its length
    for (std::size_t i = 0; i < state->laws.size(); ++i)
      if (const ElasticLaw& law = state->laws[i];
          law.one_sided && elastics[i].acts && elastics[i].start < (1 - least_slack) * law.rest)
        return true;
    return false;
  }
  std::size_t batches() const { return (sides.size() + simd::kkt_lanes - 1) / simd::kkt_lanes; }
  Vec3 of(ClusterRows::Sum which, std::span<const Vec3> values) const {
    Vec3 out{};
    for (std::uint32_t k = which.first; k < which.end; ++k)
      out += terms[k].weight * values[terms[k].particle];
    return out;
  }
  const double* row(std::uint32_t side) const { return coupling[side * batches()].of; }
};

}  // namespace plumb::detail
