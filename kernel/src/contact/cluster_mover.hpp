#pragma once

#include <cstdint>
#include <span>

#include "contact/linkage/linkage_state.hpp"
#include "contact/surroundings.hpp"
#include "interface/tally.hpp"
#include "plumb/settings.hpp"
#include "threads/team.hpp"

namespace plumb::detail {

/// Says how a cluster's steps are cut.
struct ClusterRules {
  std::uint32_t substeps = 1;    ///< of a step, at least
  std::uint32_t time_order = 2;  ///< of an island alone in the air
  bool is_watched = false;       ///< errors are estimated, which is to tell the length of substeps in the air
  Team* team = nullptr;          ///< that may help; null: there is none
  Strain strain = Strain::none;  ///< why rods are off their lengths, which is no blow
};

/// Moves the islands of one cluster after the other.
class ClusterMover {
 public:
  virtual ~ClusterMover() = default;
  /// Islands that sleep may be in the cluster, in whole heaps: these are woken if something pushes them.
  virtual void step(std::span<LinkageState* const> cluster, const Surroundings& surroundings,
                    const ClusterRules& rules, double dt, Tally& report) = 0;
  virtual bool set_stop_rule(const StopRule&) { return false; }  ///< true if it is read
  virtual bool set_weights(Weights) { return false; }            ///< true if they are read
  /// Islands are made otherwise than they were.
  virtual void forget() {}
};

}  // namespace plumb::detail
