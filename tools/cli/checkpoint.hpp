#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "plumb/world.hpp"

namespace plumb::tools {

/// Keeps a file with a snapshot of a running world: of its start, of its end, and of every ten seconds of
/// computing, or of every so many seconds of its own time. The file is always a whole one. While a checkpoint
/// lives, the first Ctrl-C (or SIGTERM) ends the run after its frame, and the second ends the program.
class Checkpoint {
 public:
  /// `run` says what was run (scenes::run_text()). `every` (s) is simulated time; none stands for ten seconds
  /// of computing.
  explicit Checkpoint(std::string file, std::string run = {}, std::optional<double> every = {});
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

  bool is_due(const World& world) const;

  std::string file_, run_, bytes_;
  std::optional<double> every_;  ///< s, of the world's time
  Clock::time_point next_{};     ///< When the world is written again without that.
  double written_ = -1;          ///< Time of the world (s) that is in the file.
};

}  // namespace plumb::tools
