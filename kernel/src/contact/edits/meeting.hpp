#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <utility>

#include "contact/edits/part_edits.hpp"
#include "plumb/settings.hpp"

namespace plumb::detail {

/// Names islands of the contact solver that come together, with each other or with what was not there. Joints
/// and springs may do that.
struct Meeting {
  std::span<const std::uint32_t> islands;
  const PartEdits& edits;
  /// They have particles, rods and bends, edited and where they are: of plain islands all, and of others
  /// what is new there. What is of `homes` is plain then.
  NamedPart homes, others;
  NamedPart joints;    ///< Of their particles the fixed ones are as they are now.
  const Scene& began;  ///< the whole one, in which all stands where it has its lengths and angles
};

/// Says of particles that come together how they are now, and of those that were there, where.
struct Met {
  std::map<std::uint32_t, Particle> now{};
  std::map<std::uint32_t, std::pair<std::uint32_t, std::uint32_t>> were{};  ///< island, and number there
};

}  // namespace plumb::detail
