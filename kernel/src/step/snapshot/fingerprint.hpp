#pragma once

#include <cstdint>

#include "plumb/scene.hpp"
#include "plumb/settings.hpp"

namespace plumb::detail {

/// Says what a snapshot fits to. Equal ones stand for equal scenes, but for one in 2^64.
struct Fingerprint {
  std::uint64_t scene = 0;
  /// Of all settings that storage or motion depends on. Instruction set, threads and executor do not count,
  /// nor the stop rule and weights. Substeps and accuracy count as the world began with them,
  /// or as World::set_settings() gave them last.
  std::uint64_t settings = 0;

  friend bool operator==(const Fingerprint&, const Fingerprint&) = default;
};
Fingerprint fingerprint_of(const Scene& scene, const Settings& settings);

}  // namespace plumb::detail
