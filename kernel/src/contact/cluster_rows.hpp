#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <tuple>

#include "contact/linkage/combination.hpp"
#include "contact/shapes/touch.hpp"
#include "contact/solved/cluster_limits.hpp"
#include "plumb/vec3.hpp"

namespace plumb::detail {

/// This is what pushes in a cluster, and on what. Rows are those of contacts, angle limits and brakes.
struct ClusterRows {
  /// A sum of particles, among an island's terms.
  struct Sum {
    std::uint32_t first = 0, end = 0;
    friend bool operator==(const Sum&, const Sum&) = default;
  };
  /// A push on an island: along_a on a sum of its particles, along_b on another.
  struct Side {
    Sum a, b;
    Vec3 along_a{}, along_b{};
  };
  enum class Kind : std::uint8_t { normal, sliding, rolling, spinning, limit, brake };
  static constexpr std::uint32_t none = 0xffffffff;

  /// Where a row finds what its side of an island sees, and what its pushes do there.
  struct End {
    double* speed = nullptr;  ///< of the island's sides
    double* push = nullptr;
    const double* coupling = nullptr;  ///< the side's row; of a contact's other rows, the next ones
    std::uint32_t side = 0, padded = 0;
  };
  struct Row {
    Kind kind = Kind::normal;
    bool held = false;  ///< in the last substep: p and q are what did
    std::uint32_t island[2] = {none, none}, side[2] = {0, 0};
    std::uint32_t ends = 0;  ///< islands that it acts on
    End end[2]{};
    double gap = 0;           ///< m or rad, what may be lost
    double closes = 0;        ///< m, of normals, by how much that would become less without pushes
    double given = 0;         ///< m, what the ground moves by
    double given_at_end = 0;  ///< m/s, how fast it moves
    /// Of brakes; of normals the coefficient of friction, of rolling and spinning a length (m).
    double bound = 0;
    double bounce = 0;          ///< m/s, what it leaves with; of brakes the bound of q
    double own = 0;             ///< its response to itself
    double over = 0;            ///< 1 / own, or 0
    double p = 0, q = 0;        ///< what pushes positions, and velocities
    double from = 0;            ///< p as the sweeps begin, which what yields keeps
    double across[2] = {0, 0};  ///< of normals: what a push of one takes from the two rows that follow
    std::uint64_t key = 0;
    std::uint32_t of[2] = {0, 0};  ///< the shapes that touch, or the angle and 1 at its upper limit
    std::uint32_t axis = 0;        ///< which of a contact's rows
    std::uint32_t first_term = 0, end_term = 0;  ///< among free terms
    std::uint32_t normal = none;                 ///< of rolling and spinning, the row of the contact's normal
    Vec3 along{};                                ///< of contacts, the direction of what it pushes

    /// Returns whether it may push only where the contact's normal does.
    bool follows_normal() const {
      return kind == Kind::sliding || kind == Kind::rolling || kind == Kind::spinning;
    }
    void add_end(std::uint32_t on, std::uint32_t at, std::uint32_t shape) {
      island[ends] = on;
      side[ends] = at;
      of[ends++] = shape;
    }
  };
  /// Nesterov's momentum of sweeps (Soviet Mathematics Doklady 27, 1983, 372). It begins anew where pushes
  /// turn back (O'Donoghue and Candès 2015).
  class Momentum {
   public:
    /// Returns the share of the last change by which the next sweep goes on first.
    double share() {
      const double next = 0.5 * (1 + std::sqrt(1 + 4 * pace_ * pace_)), out = (pace_ - 1) / next;
      pace_ = next;
      return out;
    }
    void begin_anew() { pace_ = 1; }
    /// Goes on from a value by this share of its last change, of which it takes note.
    template <class T>
    static void go_on(double share, T& value, T& last) {
      const T now = value;
      value += share * (now - last);
      last = now;
    }

   private:
    double pace_ = 1;
  };
  /// Sweeps come in rounds, with a correction after each.
  struct Rounds {
    int most = 0;                ///< sweeps of the next one, at most
    double left = INFINITY;      ///< m or rad, the least that any left
    int idle = 0;                ///< rounds since that was much less than before
    bool is_over = false;        ///< another would come no closer
    bool is_thrown_off = false;  ///< momentum led away
    /// Takes note of one of `taken` sweeps that changed `last` in the end. Rounds get longer while they come
    /// closer. What contradicts itself does not, however often it is swept, and what came close is left so.
    void follow(int taken, double last, double enough) {
      idle = last < contact_limits::much_better * left ? 0 : idle + 1;
      const bool comes_closer = idle < contact_limits::most_idle_rounds;
      most =
          comes_closer ? std::min(2 * taken, contact_limits::most_sweeps) : contact_limits::most_sweeps / 4;
      is_over = !comes_closer && last <= enough;
      left = std::min(left, last);
    }
  };
  /// A free particle that a contact's rows act on.
  struct FreeTerm {
    Vec3* motion;      ///< m or m/s
    double over_mass;  ///< 1/kg, 0 if it is fixed
    Vec3 along[3]{};   ///< of each row
  };
  /// One end of a contact: the island, the place on the middle of a shape there, and the way from it to
  /// where it is touched.
  struct ContactEnd {
    std::uint32_t island;
    Terms at;
    std::uint32_t shape;
    Vec3 arm;
  };
  /// The levers of a contact. Its sides on an island follow each other, as do the three of turning.
  struct Levers {
    struct End {
      std::uint32_t island, shape, normal, turning;
      Sum middle;
      Vec3 arm;
    };
    End end[2]{};
    std::uint32_t ends = 0;
    Vec3 along{};  ///< the contact's normal
  };
  /// The unknowns that a side consists of, and the weight of each.
  struct SideUnknowns {
    static constexpr std::size_t most = 2 * 3 * std::tuple_size_v<decltype(Combination::terms)>;
    std::array<std::uint32_t, most> slots;
    std::array<double, most> factors;
    std::uint32_t used = 0;
  };
  /// A contact of lines that follows where they touch as they turn, with rows from `row` on.
  struct RoundContact {
    std::uint32_t levers, row;
    Segment other;      ///< on ground, where it is as the substep begins
    Vec3 carried;       ///< m, what that moves by
    double gap, apart;  ///< m, as the substep begins, the second with what is let be of overlaps
  };
  /// Says where shapes touch whose contact has rows from `row` on, for those who count that.
  struct RowsTouch {
    std::uint32_t row, ends, other;
    Combination at[2];
    double radius[2];
    double approach;  ///< m/s
  };
};

}  // namespace plumb::detail
