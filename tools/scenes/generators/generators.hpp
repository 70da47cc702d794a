#pragma once

#include <cstdint>

#include "plumb/scene.hpp"

/// Tests, benchmarks and the command share these scenes, so that each is built in one place.
namespace plumb::scenes {

/// A chain has `links` massless rods, straight along +x from a fixed particle at the origin.
struct ChainShape {
  std::uint32_t links = 20;
  double length = 0.1;  ///< Length of every rod, in m.
  double mass = 1;      ///< Mass of every movable particle but the last, in kg.
  double end_mass = 1;  ///< Mass of the last, in kg.
};

/// A line of massless rods between two anchors, the first at the origin. The particles lie straight along +x
/// and evenly, whatever the rods' lengths. The world lets a slack line sag before its first step.
struct LineShape {
  std::uint32_t links = 20;
  double span = 2;      ///< Distance of the anchors, in m.
  double slack = 0.05;  ///< Share of the span by which the rods together are longer; above -1.
  double mass = 1;      ///< Mass of every movable particle, in kg.
};

/// A rope of massless rods hangs from a drum at the origin, straight at a slant of 45 degrees towards +x. Its
/// first rod is the cable that a winch reels in.
struct WinchShape {
  std::uint32_t rods = 20;  ///< Rods behind the cable.
  double cable = 1;         ///< Length of the first rod, in m.
  double length = 0.1;      ///< Length of every other rod, in m.
  double mass = 0.1;        ///< Mass of every movable particle but the last, in kg.
  double load = 10;         ///< Mass of the last, in kg.
};

/// A square net in the x-y plane hangs from its two fixed upper corners. Particles are numbered row by row
/// from the top left one at the origin. Rods are numbered first along x, then along y, within each particle.
struct NetShape {
  std::uint32_t width = 32;   ///< Particles along x.
  std::uint32_t height = 32;  ///< Particles along y.
  double spacing = 0.1;       ///< Distance of neighbours, in m.
  double mass = 1;            ///< Mass of every movable particle, in kg.
  /// 1 holds the net along its whole first row, and starts it level, in the x-z plane.
  std::uint32_t level = 0;
  double slack = 0;     ///< Share by which its rows are longer than what they span, at first in zigzag.
  double end_mass = 0;  ///< Mass of the last particle, in kg; 0 is that of the others.
};

/// Separate chains lie side by side in z, each with a fixed root. Particles and rods are numbered chain after
/// chain.
struct EnsembleShape {
  std::uint32_t chains = 1000;
  std::uint32_t links = 32;
  double length = 0.1;     ///< Length of every rod, in m.
  double mass = 1;         ///< Mass of every movable particle but the last of each chain, in kg.
  double end_mass = 10;    ///< Mass of the last, in kg.
  double spacing = 0.1;    ///< Distance of neighbouring chains, in m.
  double vary = 0;         ///< Each chain's end mass is multiplied by 1 ± at most this, in [0, 1).
  std::uint64_t seed = 1;  ///< Seed of that variation; without variation every chain is the same.
};

/// A ring in the x-y plane is a regular polygon of massless rods. It hangs from a fixed particle at the
/// origin, its highest. Particles and rods are numbered around it.
struct RingShape {
  std::uint32_t links = 24;
  double length = 0.1;  ///< Length of every rod, in m.
  double mass = 1;      ///< Mass of every movable particle, in kg.
};

/// A truss leads along +x from x = 0, where its end is fixed. With two chords it is flat in the x-y plane.
/// With three it is rigid, around an equilateral triangle with its upper side level. Particles are numbered
/// station after station; rods within each station, then to the next.
struct TrussShape {
  std::uint32_t bays = 10;
  std::uint32_t chords = 3;  ///< Chords, 2 or 3.
  std::uint32_t braces = 1;  ///< Diagonals per panel; with 2 the truss has more rods than it needs.
  std::uint32_t fixed =
      0;  ///< Particles of the first station that are fixed; 0 fixes all. With one less the truss swings.
  double spacing = 0.1;  ///< Distance of stations, and of chords, in m.
  double mass = 1;       ///< Mass of every movable particle, in kg.
};

/// A random graph lies in a cube. Its particles are at random places, and the nearest ones are tied together.
struct GraphShape {
  std::uint32_t particles = 1000;
  double degree = 4;     ///< Mean number of rods at a particle.
  double spacing = 0.1;  ///< The cube holds one particle per spacing³, in m.
  std::uint64_t seed = 1;
};

/// Each of these makes a scene. Each throws InputError with the value that makes no sense.
Scene make_chain(const ChainShape& shape);
Scene make_chain(std::uint32_t links, double length = 0.1, double end_mass = 1, double mass = 1);
Scene make_line(const LineShape& shape);
Scene make_winch(const WinchShape& shape);
Scene make_net(const NetShape& shape);
Scene make_net(std::uint32_t width, std::uint32_t height, double spacing = 0.1);
Scene make_ensemble(const EnsembleShape& shape);
Scene make_ring(const RingShape& shape);
Scene make_truss(const TrussShape& shape);

/// Makes a graph that is connected but for rare stragglers, with masses from 0.5 to 2 kg. About one particle
/// in fifty is fixed: the uppermost that no rod ties to another fixed one. Every rod is as long as its ends
/// are apart. The same seed gives the same scene with every compiler. Nothing here depends on the standard
/// library's distributions.
Scene make_graph(const GraphShape& shape);

/// Makes the thesis's experiment (section 4.4): five links, the last particle of double mass.
Scene make_thesis5();

/// Makes five uniform rods of 0.2 m in a row, straight along +x from a fixed particle. They have 5 kg each,
/// the last 10 kg.
Scene make_rods5();

/// Makes six uniform rods from a fixed particle. They branch twice, with a point mass on two of the joints.
Scene make_tree();

/// Makes the thesis's humanoid as a tree of uniform rods: nine limbs of the medium body (figure 4.9 and
/// appendix B, inches and pounds). It lies level along +x from the fixed top of the head, with legs 30
/// degrees to either side.
Scene make_humanoid();

}  // namespace plumb::scenes
