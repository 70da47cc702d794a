#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "contact/linkage/linkage.hpp"

namespace plumb::detail {

/// A box along the axes of space.
struct Bounds {
  Vec3 low{}, high{};

  bool is_empty() const { return !(low.x <= high.x); }
  bool overlaps(const Bounds& o) const {
    return low.x <= o.high.x && o.low.x <= high.x && low.y <= o.high.y && o.low.y <= high.y &&
           low.z <= o.high.z && o.low.z <= high.z;
  }
};

/// What held at a contact, to start from in the next substep: forces on the way, and those at its end, which
/// differ from them for many substeps in the same way.
struct KeptContact {
  std::uint64_t key = 0;
  Vec3 force{}, end_force{};  ///< N
};

/// What steps change of an island.
struct LinkageMotion {
  std::vector<Vec3> x, v;          ///< m and m/s; fixed particles too
  std::vector<Vec3> acceleration;  ///< m/s², by which the last substep's way differs from h v, over h²
  std::vector<KeptContact> kept;
  bool asleep = false;
  bool frozen = false;
  double slow_time = 0;            ///< s, for how long it has been slow
  std::optional<double> energy{};  ///< J, which free flight keeps
};

/// One island of a linkage's kind, wherever it is.
struct LinkageState : LinkageMotion {
  const Linkage* linkage = nullptr;
  std::vector<std::uint32_t> particles;  ///< the scene's numbers
  std::vector<Vec3> force;               ///< N, constant, on movable particles
  std::vector<simd::Block> factors;      ///< at x
  std::uint32_t number = 0;              ///< of this island
  bool factored = false;

  LinkageMotion& motion() { return *this; }

  /// False if the matrix at x has none.
  bool factor() {
    factors.resize(linkage->plan().blocks());
    linkage->assemble(x, factors);
    return factored = linkage->plan().factor(factors);
  }
};

/// A box around an island's shapes, wherever gravity and the speed (m/s) of its fastest movable particle
/// bring them within dt (s). It does not hold what goes farther: ends of shapes beyond the particles, anchors
/// that move, and what forces, drives and hits within dt add. The margin (m) is that of contact.
Bounds reach(const LinkageState& state, double speed, double dt, double margin);
/// The fastest of its particles, m/s.
double top_speed(const LinkageState& state);

}  // namespace plumb::detail
