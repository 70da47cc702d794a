#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "plumb/settings.hpp"
#include "scenes/shots/shots.hpp"

/// Random shots show whether things pass through each other, and whether blows bring energy.
namespace plumb::scenes {

/// A way to move shots.
struct ShotWay {
  std::string name;
  Settings settings{};
  /// Energy may gain this share by rounding: of a float's 24 bits, or of a double's with what solves leave.
  double most_gain = 1e-6;
};
/// Returns the ways in which all shots are moved: method auto as it is, direct, and relaxation in double and
/// in float. Nothing sleeps.
const std::vector<ShotWay>& shot_ways();

/// Says what became of a shot.
struct ShotResult {
  bool finite = true;    ///< All was finite after every step, and no island was frozen.
  bool hit = false;      ///< The missile's velocity changed.
  bool through = false;  ///< Something came through, see fly().
  bool deep = false;     ///< Two things were more than half the thinner one's radius in each other.
  bool gained = false;   ///< Energy rose by more than the way's most_gain.
  double gain = 0;       ///< Largest rise of energy above that of the start, as a share of it.
  double depth = 0;      ///< How far an end was beyond a wall's middle, in m, or the share in an island.
};

/// Moves a shot. A missile is through a wall if an end or a corner is more than 1 mm beyond its middle. It
/// is through a held net if an end of its axis is on the other side. It is through anything else if it flies
/// on as though nothing had been there, and the target's middle was in its way. Past a wall's edge nothing
/// counts any more, nor do ends that were beside a net's frame or in a mesh at its corner, which is open.
ShotResult fly(const Shot& shot, const ShotWay& way);

/// Names what of a result is wrong, or nothing.
std::string fault_of(const ShotResult& result);

/// Returns whether `at` is on the other side of a net than `out` points to: going there along y one crosses
/// the net an odd number of times. The net's particles are the first side x side ones, row after row, and
/// every mesh is two triangles.
bool is_behind_net(std::span<const Vec3> positions, std::uint32_t side, Vec3 at, Vec3 out);

}  // namespace plumb::scenes
