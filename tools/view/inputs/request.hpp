#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "plumb/vec3.hpp"
#include "scenes/basics/json.hpp"

namespace plumb::view {

/// Says what a page asks for. Those up to `throw_ball` change how worlds move: they are recorded with the
/// number of their frame, and a replay repeats them. The others do not.
enum class Verb : std::uint8_t {
  set,
  pull,
  release,
  cut,
  fix,
  free,
  reel,
  throw_ball,
  play,
  pause,
  step,
  speed,
  reset,
  defaults,
  load,
  compare,
  add_side,
  drop_side,
  values,
  record
};

/// A request is one message of a page. tools/view/README.md lists which members each verb reads.
struct Request {
  Verb verb = Verb::pause;
  std::optional<std::uint32_t> side{};  ///< The world that is meant; none stands for all.
  std::string name{};                   ///< Of a setting, a scene, or a comparison.
  std::string value{};                  ///< Its text.
  std::uint32_t number = 0;             ///< Of a particle, rod, tackle or reel, as the scene has them.
  Vec3 at{};                            ///< A place, in m.
  Vec3 velocity{};                      ///< In m/s.

  friend bool operator==(const Request&, const Request&) = default;
};

/// Returns whether a request changes how worlds move.
constexpr bool is_input(Verb verb) {
  return verb <= Verb::throw_ball;
}

std::string_view to_string(Verb verb);

/// Reads a message. Throws InputError that names what is unknown, missing or mistyped.
Request parse_request(std::string_view text);
/// Writes it, with those members that differ from a new Request's.
scenes::Json request_json(const Request& request);

}  // namespace plumb::view
