#pragma once

#include <cstdint>
#include <optional>

namespace plumb::tools {

/// Which shots are fired.
struct ShotOrder {
  std::uint32_t count = 0;              ///< Numbers from 0 on.
  std::optional<std::uint32_t> only{};  ///< This number alone.
  std::uint32_t seed = 1;
  std::uint32_t threads = 0;  ///< Threads that share the shots; 0: as many as there are processors.
  bool quiet = false;
};

/// Fires random shots in all ways and prints what became of them, and the number of each bad one. Throws
/// CheckFailed if one is bad, see fault_of().
void report_shots(const ShotOrder& order);

}  // namespace plumb::tools
