#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "view/exhibit/exhibit.hpp"

/// What a page did, as a file that gives the same bits again. tools/view/README.md has its format.
namespace plumb::view {

struct Replay {
  Start start;
  std::vector<Taken> inputs;
  std::uint64_t frames = 0;
  std::vector<std::string> hashes;  ///< By side, the hash of its state after the last frame.
};

/// Returns the text of what has happened since the start.
std::string format_replay(const Exhibit& exhibit);
/// Reads it. `name` begins every message. Throws InputError with what is wrong.
Replay parse_replay(std::string_view text, std::string_view name);

/// Repeats inputs in an exhibit that starts as they did.
class Repeater {
 public:
  explicit Repeater(Replay replay) : replay_(std::move(replay)) {}

  /// Gives the exhibit the inputs of its frame.
  void give(Exhibit& exhibit);
  bool is_over(const Exhibit& exhibit) const { return exhibit.frame() >= replay_.frames; }
  const Replay& replay() const { return replay_; }

 private:
  Replay replay_;
  std::size_t next_ = 0;
};

/// Repeats a replay to its end in new worlds and returns them.
Exhibit repeat(const Replay& replay);

/// Returns the hashes of an exhibit's worlds, as reports spell them.
std::vector<std::string> hashes_of(const Exhibit& exhibit);

}  // namespace plumb::view
