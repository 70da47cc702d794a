#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "plumb/scene.hpp"
#include "view/exhibit/choices.hpp"
#include "view/exhibit/side.hpp"
#include "view/inputs/request.hpp"

/// Worlds that start alike and are compared, and how requests change them. Nothing here knows of threads,
/// clocks or pages: the same start and the same inputs at the same frames give the same bits.
namespace plumb::view {

struct Start {
  std::string name;  ///< As scenes::load_scene() reads it, or the name of a file that was dropped.
  Scene scene{};
  std::vector<SideStart> sides{};
};

/// The worlds take frames of a sixtieth of a second.
inline constexpr double frame_length = 1.0 / 60;
/// So many worlds are compared at most.
inline constexpr std::size_t most_sides = 4;

/// An input as it was taken, before the step of frame `frame` + 1.
struct Taken {
  std::uint64_t frame = 0;
  Request request{};
};

class Exhibit {
 public:
  /// Throws what Side throws, and InputError on no sides or too many.
  explicit Exhibit(Start start);

  /// Takes an input. An input without a side goes to all of them. Where some refuse, the others take it, and
  /// the text that is returned says who refused and why. Throws InputError if all refuse.
  std::string take(const Request& request);
  void step();
  /// Begins anew: the scene as it was loaded, with settings, gravity, drag and end mass of now.
  void reset();

  std::uint64_t frame() const { return frame_; }
  const std::vector<Side>& sides() const { return sides_; }
  const std::vector<Taken>& taken() const { return taken_; }
  const Start& start() const { return start_; }
  /// Returns what reset() starts from.
  Start next_start() const;
  /// Returns the RMS distance of a side's particles from those of the first, relative to the scene's
  /// diagonal. It is 0 where the two have other numbers of particles.
  double distance(std::size_t side) const;

 private:
  void give(Side& side, const Request& request) const;

  Start start_;
  std::vector<Side> sides_;
  std::vector<Taken> taken_;
  std::uint64_t frame_ = 0;
  double diagonal_ = 0;
};

}  // namespace plumb::view
