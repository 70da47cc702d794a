#pragma once

#include <string>
#include <vector>

#include "frontier/contest.hpp"
#include "peer.hpp"

namespace plumb::bench {

struct PeerLimits {
  double path_s = 1;    ///< seconds of wall-clock time for a path; its last run may take as much again
  double repeat_s = 2;  ///< seconds for the repetitions of a scene
};

/// Holds what was measured of a family on a problem that is prepared, and what was left out.
struct PeerResult {
  std::vector<frontier::Point> points{};
  unsigned failed =
      0;  ///< settings that gave up, did not stay finite, or stretched a rod to twice its length
  std::string reason{};  ///< the first line of the library's words about the last setting that gave up
};

/// Follows the paths of a family through a problem, from coarse to fine, until the position error falls no
/// longer or time is up. Then it times again, in turns, all that may be on the family's front.
PeerResult measure(const frontier::Problem& problem, const PeerFamily& family, const PeerLimits& limits);

}  // namespace plumb::bench
