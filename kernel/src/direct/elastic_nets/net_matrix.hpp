#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "direct/loops/loop_rod.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/vec3.hpp"

namespace plumb::detail {

/// Returns nodes by their distance in rods from one end of the island. Rows and columns of a net then run one
/// way, and so does elimination along them.
Array<std::uint32_t> order_by_levels(std::span<const LoopRod> rods, std::uint32_t nodes);

/// Lists the rods of an island by the later of their ends.
struct NetPattern {
  NetPattern(std::span<const LoopRod> of, std::uint32_t nodes);

  std::uint32_t nodes;
  Array<LoopRod> rods;          ///< They are as the island numbers them.
  Array<std::uint32_t> number;  ///< It says by place which rod it is.
  Array<std::uint32_t> first;   ///< The places of every node begin here; their end follows.
  Array<std::uint32_t> before;  ///< It says by place which node is the earlier end.
  Array<std::uint32_t> tied;    ///< These rods lead to fixed vertices.
};

/// A symmetric matrix has a tile for every two nodes that a rod joins,
///
///   K = M + sum over rods of (along f fᵀ + across 1),
///
/// with plus at both ends and minus between them. It is solved by conjugate gradients (Hestenes, Stiefel
/// 1952) in linear time for each iteration. Their preconditioner is an incomplete factorisation, which keeps
/// the tiles between nodes as they are (Meijerink, van der Vorst 1977). It exists for every such matrix whose
/// rods pull, and on a flat net it is exact along rows and columns. Eisenstat (1981) showed how it
/// costs no more than a multiplication.
class NetMatrix {
 public:
  explicit NetMatrix(const NetPattern& pattern);

  /// What a rod adds. `along` is not negative; `across` is where the rod pushes.
  struct RodPart {
    Vec3 f;  ///< It has any length.
    double along, across;
  };
  /// Takes masses of nodes, and what every rod adds, by its number.
  void set(std::span<const double> mass, std::span<const RodPart> rods);

  enum class Outcome : std::uint8_t { solved, stalled, indefinite };
  /// Puts the solution of K x = b into `x`. It ends when the residual's norm, that of the preconditioner, is
  /// `goal` of the first one. It stalls after `most` iterations.
  Outcome solve(std::span<const Vec3> b, double goal, int most, std::span<Vec3> x);

 private:
  /// A symmetric tile has xx, xy, xz, yy, yz, zz.
  using Tile = std::array<double, 6>;

  void factorize();
  /// Replaces v by (P - L)⁻¹ v or (P - Lᵀ)⁻¹ v, L being what K takes from a node for earlier ones.
  void forward(std::span<Vec3> v) const;
  void backward(std::span<Vec3> v) const;

  const NetPattern* pattern_;
  Array<RodPart> parts_;                  ///< They are by place.
  Array<Tile> pivot_, inverse_, beyond_;  ///< P, its inverse and K's diagonal less 2 P, by node.
  Array<Vec3> rest_, near_, along_, image_;
};

}  // namespace plumb::detail
