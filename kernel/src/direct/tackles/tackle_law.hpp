#pragma once

namespace plumb::detail {

/// This is how a tackle answers to what pulls on it. Stiffness and damping are divided by the unit of mass.
struct TackleLaw {
  double stiffness, damping;
  bool is_rigid, is_one_sided;
  double friction = 0;  ///< Coulomb's coefficient at its pulleys.
};

/// Forces of a substep act by `kick` (s²), and `rate` is 1/h (1/s). Theta is 1/2 for gradient mid, and 1 for
/// new.
struct TackleFactors {
  double kick, rate, theta;
};

/// A cord is so much longer (m) than its length at the start of a substep and at its end, and its multiplier
/// is -kick times its pull. The length of an elastic one is that of the middle of the substep, until when
/// `paid` (m) of it was paid out, and as much will be afterwards.
struct TackleIterate {
  double start, end, mu, paid = 0;
};

/// A row of Newton's matrix is  use gradient . (change of displacements) + soft (change of mu) = -c.
struct TackleRow {
  double use = 1, soft = 0, c = 0;
};

/// Returns the row of a cord.
///
/// With theta 1/2 an elastic cord pulls with the change of its energy over that of its length, so that mid
/// keeps energy where it becomes slack and taut, too. A rigid one-sided cord is taut where it would be too
/// long or pulls.
TackleRow tackle_row(const TackleLaw& law, const TackleFactors& factors, const TackleIterate& iterate);

/// Returns that of a cord whose rigidity gives way by `give`, the change of its length over that of its
/// multiplier. It has no damping, and theta is 1.
TackleRow giving_tackle_row(const TackleLaw& law, double kick, double give, const TackleIterate& iterate);

/// Returns the multiplier of such a cord at the end of a substep, and its energy.
struct TacklePull {
  double mu, energy;
};
TacklePull giving_tackle_pull(const TackleLaw& law, double kick, double give, double end);

}  // namespace plumb::detail
