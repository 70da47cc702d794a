#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "scenes/basics/json.hpp"
#include "view/exhibit/exhibit.hpp"

/// The messages that go to a page. tools/view/README.md has the table of their bytes, page/messages.js reads
/// them, and view/inputs/request.hpp has those that come back.
namespace plumb::view {

/// "PLV2" as a little-endian number: the first four bytes of a frame.
inline constexpr std::uint32_t frame_magic = 0x32564c50;

/// Says what a frame shows of rods.
enum class Values : std::uint8_t { none, strain, tension };
/// Throws InputError on another word.
Values values_of(std::string_view word);

/// Says how the worlds run, for a frame's head.
struct Pace {
  bool playing = false;
  bool replaying = false;
  double reached = 0;   ///< Simulated seconds per second.
  double frame_us = 0;  ///< Time of the frame before, from the end of its step to its bytes.
  bool hashed = false;  ///< Whether the frame has the hashes of states.
};

/// What is measured of a side, which costs time in large scenes.
struct Measured {
  double strain_rms = 0, strain_max = 0;
  Energy energy{};
  double distance = 0;
};
Measured measure(const Exhibit& exhibit, std::size_t side);

/// Returns the bytes of a frame. `measured` has an item for each side.
std::string encode_frame(const Exhibit& exhibit, const Pace& pace, Values values,
                         const std::vector<Measured>& measured);

/// Returns what a page draws, with everything that does not change from frame to frame.
scenes::Json scene_json(const Exhibit& exhibit);
/// Returns the worlds and their settings, the comparison that they are, and the scene's gravity, drag and end
/// mass.
scenes::Json sides_json(const Exhibit& exhibit);
/// Returns scenes, comparisons and methods to choose from.
scenes::Json menu_json();
/// Returns a sentence for the reader; `refused` says that what was asked for did not happen.
scenes::Json note_json(std::string_view text, bool refused);

}  // namespace plumb::view
