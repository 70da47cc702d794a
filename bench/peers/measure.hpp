#pragma once

#include <string>
#include <vector>

#include "frontier/contest.hpp"
#include "peer.hpp"

namespace plumb::bench {

struct PeerLimits {
  double path_s = 1;    ///< of wall-clock time for a path; its last run may take as much again
  double repeat_s = 2;  ///< for the repetitions of a scene
};

/// What was measured of a family on a problem that is prepared, and what was left out.
struct PeerResult {
  std::vector<frontier::Point> points{};
  unsigned failed =
      0;  ///< settings that gave up, did not stay finite, or stretched a rod to twice its length
  std::string reason{};  ///< of the last that gave up, the first line of its library's words
};

/// Follows the paths of a family through a problem, from coarse to fine, until the position error falls no
/// longer or time is up; then times again, in turns, all that may be on the family's front.
PeerResult measure(const frontier::Problem& problem, const PeerFamily& family, const PeerLimits& limits);

}  // namespace plumb::bench
