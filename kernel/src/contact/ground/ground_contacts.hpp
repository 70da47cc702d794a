#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "contact/chunks.hpp"
#include "contact/linkage/linkage_state.hpp"
#include "contact/shapes/touch.hpp"

namespace plumb::detail {

/// This is where one island touches something fixed.
struct GroundContact {
  /// What few contacts have.
  struct More {
    double rolling = 0, spinning = 0;  ///< m, see Surface
    Vec3 carried{};                    ///< m, how the ground moves there
    Vec3 carried_at_end{};             ///< m/s, how fast it does
    Vec3 spin{};                       ///< 1/s, how fast it turns
    /// The capsule of the ground that the shape's line touches between its ends, where the substep starts, if
    /// it does.
    std::optional<Segment> round{};
    double apart = 0;  ///< m, from that capsule, where the substep starts
  };
  static const More no_more;

  Terms at{};
  Vec3 normal{};        ///< unit vector out of the ground
  double gap = 0;       ///< m, what may be lost in the substep
  double closes = 0;    ///< m, by how much the gap would become smaller in it
  double friction = 0;  ///< Coulomb's coefficient
  double bounce = 0;    ///< m/s, what it leaves with
  double approach = 0;  ///< m/s, how fast it was about to be hit
  std::uint64_t key = 0;
  std::uint32_t shape = 0;  ///< its number
  std::uint32_t other = 0;  ///< the number of the ground, or of the other island's shape
  bool is_held = false;     ///< it pushed in the last substep, by what follows
  Vec3 held{};              ///< kg m, on positions
  Vec3 held_end{};          ///< kg m/s, on velocities
  const More* more = &no_more;
};

/// Holds the contacts of one island with fixed ground, which stand in the island's own matrix.
///
/// A contact pushes by Pi(held - stiffness (gap + u)), with u how its place moves and Pi the projection onto
/// Coulomb's cone: the augmented Lagrangian of Alart and Curnier (1991). Its slope is a block of 3 x 3
/// numbers that stands where the masses of its particles do. For given bounds on friction the block is
/// positive semidefinite. So the matrix keeps its shape, and each of many contacts costs as little as each of
/// a few.
///
/// Newton's method on these pushes is semismooth. For given bounds it minimises a convex function, and
/// share_of() searches along each of its steps.
class GroundContacts {
 public:
  void clear();
  bool is_empty() const { return rows_.empty(); }
  std::size_t size() const { return rows_.size(); }
  /// Adds a copy of a contact whose heaviest particle has this mass (kg).
  void add(const GroundContact& contact, double heaviest);

  /// Begins to solve for positions. What `is_loose` grips by no more than a mass to the end. What `settles`
  /// does not spring back from a hit of the last substep.
  void begin_positions(bool is_loose, bool settles);
  /// Begins to solve for velocities at the end. Only what pushed on positions may push.
  void begin_velocities();
  /// Lets gaps to round ground be those where the island is taken to, at `there` (m). A line that turns about
  /// where it touches goes in, and what lets it sink while it rocks would rock it more and more.
  void follow_gaps(const LinkageState& state, std::span<const Vec3> there);
  /// Lets contacts with round ground follow to where the island is at the end, at x. A line rocks there, and
  /// what pushed at the end where it touched at the start would shake it up.
  void follow_round(const LinkageState& state);
  /// Finds pushes and slopes at a motion (m, or m/s). Bounds on friction follow the last solution if
  /// `bounds_follow`.
  void look(const Linkage& linkage, std::span<const Vec3> motion, bool bounds_follow);
  /// Returns the largest push that the last solution lacks (kg m or kg m/s), as a share of the largest push.
  double lack() const { return lack_; }
  /// Returns whether slopes differ so much from those in the matrix that it is worth a new factorisation.
  bool is_stale() const { return is_stale_; }
  /// Adds the slopes of the last look() to the island's matrix, which is assembled where it is, and
  /// factorises it.
  bool factor(LinkageState& state);

  /// Adds to the right hand side what a whole solution starts from, with the motion of the last look().
  void add_pushes(const Linkage& linkage, std::span<const Vec3> motion, std::span<double> right) const;
  /// Adds what the last solution lacks, from which a correction starts.
  void add_lack(const Linkage& linkage, std::span<double> right) const;
  /// Takes in a whole solution.
  void follow_solution(std::span<const Vec3> motion);
  /// Keeps the slopes in the matrix by which the island's answers to other pushes have been found.
  void keep_slopes();
  /// Takes in how other pushes changed the solution, through that matrix. Slopes that are newer would make
  /// pushes that nothing acts with.
  void follow_change(std::span<const Vec3> motion);
  /// Takes note of a correction.
  void aim(std::span<const Vec3> correction);
  /// Returns the share of that correction to take, from 0 to 1. `inertia` is the correction's product with
  /// the mass matrix and itself.
  double share_of(double inertia) const;
  /// Takes in this share of that correction.
  void take(double share);

  std::size_t count_pushes() const;
  /// Calls visit(contact) for all.
  template <class Visit>
  void for_all(Visit&& visit) const {
    for (const Row& row : rows_) visit(row.contact);
  }
  /// Calls keep(contact, push on positions, push on velocities) for all that push.
  template <class Keep>
  void for_kept(Keep&& keep) const {
    for (const Row& row : rows_)
      if (row.position != Vec3{}) keep(row.contact, row.position, row.push);
  }

 private:
  struct Row {
    enum class State : std::uint8_t { open, sticks, slides };
    GroundContact contact;
    double mass = 0;       ///< of its heaviest particle, kg
    double gap = 0;        ///< m or m/s
    double bound = 0;      ///< of what holds against sliding, kg m or kg m/s
    bool is_open = false;  ///< it does not push
    State state = State::open;
    Vec3 carried{};   ///< m or m/s, how the ground moves
    Vec3 held{};      ///< what it starts from
    Vec3 push{};      ///< in balance with the last solution
    Vec3 law{};       ///< what it is to be, at `moved`
    Vec3 position{};  ///< the push on positions, once they are found
    Vec3 moved{}, correction{};
    Sym3 slope{};  ///< in the matrix
  };
  using State = Row::State;

  /// Splits what a contact would push by if it neither slid nor let go.
  struct Wanted {
    double normal = 0;
    Vec3 across{};
  };
  Wanted wanted(const Row& row, Vec3 at) const;
  static Touch near_round(const LinkageState& state, const GroundContact& contact, std::span<const Vec3> x,
                          Vec3 carried);
  State state_at(const Row& row, Vec3 at) const;
  Vec3 law_at(const Row& row, Vec3 at, State as) const;
  Vec3 law_at(const Row& row, Vec3 at) const { return law_at(row, at, state_at(row, at)); }
  Sym3 slope_at(const Row& row, Vec3 at, State as) const;
  Sym3 slope(const Row& row) const { return slope_at(row, row.moved, row.state); }
  void grip();
  void begin_grip();
  void begin(Row& row, double gap, Vec3 held, bool is_open);
  void find_laws(const Linkage& linkage);
  bool springs_back() const;
  /// Calls push(row) for every row and adds what it returns to the particles of the row's place.
  template <class Push>
  void add(const Linkage& linkage, std::span<double> right, Push&& push) const;

  Chunks<Row> rows_;
  Chunks<GroundContact::More> more_;
  TermPool terms_;
  Array<Sym3> answering_;  ///< slopes in the matrix when other pushes' effects were found, or none
  double stiffness_ = 0;   ///< along normals, by mass
  double grip_ = 0;        ///< across them, by mass
  double lack_ = 0;
  double ease_ = 1;  ///< share of the grip
  bool is_stale_ = false;
  bool is_loose_ = false, settles_ = false;
  int settlements_ = 0;  ///< that are left
};

}  // namespace plumb::detail
