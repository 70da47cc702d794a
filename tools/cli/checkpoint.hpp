#pragma once

#include <chrono>
#include <string>

#include "plumb/world.hpp"

namespace plumb::tools {

/// Keeps a file with a snapshot of a running world: of its start, of every ten seconds of computing, and of
/// its end. The file is always a whole one. While a checkpoint lives, the first Ctrl-C (or SIGTERM) ends the
/// run after its frame, and the second ends the program.
class Checkpoint {
 public:
  explicit Checkpoint(std::string file);
  ~Checkpoint();
  Checkpoint(const Checkpoint&) = delete;
  Checkpoint& operator=(const Checkpoint&) = delete;

  /// Sees the world between frames, and says whether the run goes on. Throws InputError if the world keeps no
  /// snapshots, or if the file cannot be written.
  bool see(const World& world);
  /// Writes the world now, unless it was seen last.
  void write(const World& world);

 private:
  using Clock = std::chrono::steady_clock;

  std::string file_, bytes_;
  Clock::time_point next_{};  ///< When the world is written again.
  double written_ = -1;       ///< Time of the world (s) that is in the file.
};

}  // namespace plumb::tools
