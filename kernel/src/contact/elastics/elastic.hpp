#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>

#include "contact/linkage/combination.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// Says how an elastic pulls. It changes while a world runs.
struct ElasticLaw {
  double rest = 0;                                            ///< m or rad
  double stiffness = 0;                                       ///< N/m or N m/rad; infinity is rigid
  double damping = 0;                                         ///< N s/m or N m s/rad
  double force = 0;                                           ///< N or N m, a pull that is added
  bool one_sided = false;                                     ///< It is slack below its rest.
  double strength = std::numeric_limits<double>::infinity();  ///< N; a rod that pulls more breaks
};

/// Write how springs, torsions and angles pull into the laws of their elastics. A spring of length 0 has
/// four: the first pulls with its force alone, and the others along the axes of space.
void set_laws(const Spring& spring, std::span<ElasticLaw> laws);
void set_laws(const Torsion& torsion, std::span<ElasticLaw> laws);
void set_laws(const AngleControl& angle, std::span<ElasticLaw> laws);

/// An elastic is what a spring, a torsion, a drive of an angle or a rod that gives is in a linkage: a number
/// that follows from where particles are, and a row of the matrix by which it pulls.
struct Elastic {
  enum class Kind : std::uint8_t { distance, along, angle, turn };
  Kind kind = Kind::distance;
  /// The distance is that along the first sum, whose part along `axis` is of Kind::along. An angle is from
  /// the first to the second, and a turn is about the third.
  std::array<Combination, 3> sums{};
  Vec3 axis{};
  std::uint32_t angle = 0;  ///< its number among the linkage's angles
  std::uint32_t row = 0;
  Array<std::uint32_t> touched{};  ///< movable particles
  /// No constraint holds those particles, and none of them shares its mass with another, so that elastics
  /// alone say how this one gives.
  bool is_loose = false;
  Array<std::uint32_t> places{};  ///< of its gradient among the values, three by particle
};

/// Holds the derivatives of an elastic's number by its sums: 1, or 1/m for angles.
using ElasticSlope = std::array<Vec3, 3>;

/// Returns the square of how far an elastic swings in a substep of h (s), plus what it damps, in rad.
double swing(const ElasticLaw& law, double give, double h);

/// Says how an elastic takes part in one substep of h (s). With c its number at the start (0) and the end (1)
/// of it, less its rest, its row is
///   c1 + soft p + before = 0,   p = kick s.
/// It pulls with -s (N or N m), of whose impulse one half acts where the substep starts and the other where
/// it ends.
struct ElasticStep {
  bool acts = false;    ///< It is not slack.
  double start = 0;     ///< m or rad, its number at the start
  double resolved = 1;  ///< share of its own swing that the substep resolves
  double damped = 0;    ///< share of damping in how stiff it is
  double soft = 0, before = 0, kick = 0, p = 0;
  double end_push = 0;   ///< N s or N m s, impulse that is left for the end
  double end_rate = 0;   ///< m/s or rad/s, to which velocities at the end are held
  bool lets_go = false;  ///< A cable would push where the substep ends, and does not.
  double give = 0;       ///< 1/kg or 1/(kg m²), how a pull of one moves it at the start
  /// m/s or rad/s, its mean rate in the last substep, or not a number.
  double went = std::numeric_limits<double>::quiet_NaN();

  /// Begins a substep at the number `start`. The potential of a resolved elastic is k/2 ((c0 + c1)/2)², which
  /// is variational (Marsden, West 2001) and damps nothing. The less of a swing is resolved, the more it
  /// takes of c1 alone, and the more velocities at the end are held as rigid rods hold them. It leaves out of
  /// both what it did in the last substep anyway, by `went`: that damps what turns round from substep to
  /// substep, and not a heavy body that swings slowly on stiff springs. What pulls `at_end` takes all of c1,
  /// and all of its impulse.
  void begin(const ElasticLaw& law, double gives, double h, bool at_end);
  /// Returns the soft of its row, or less than 0 if it does not act.
  double soft_of_positions() const { return acts ? soft : -1; }
  /// Returns what velocities at the end still find: soft of a row that holds them, or less than 0 for none.
  double soft_at_end() const;
  /// Returns the rate to which velocities are held at the end of a substep in which it went on by `mean` (m/s
  /// or rad/s): what is damped goes on as it goes, and what is stiff as its last two rates say, like Gear's
  /// method of second order. It comes to rest if the first of them is unknown.
  double rate_at_end(double mean) const;
};

template <class Archive>
void visit_members(Archive& archive, ElasticLaw& of) {
  auto& [rest, stiffness, damping, force, one_sided, strength] = of;
  archive(rest, stiffness, damping, force, one_sided, strength);
}

}  // namespace plumb::detail
