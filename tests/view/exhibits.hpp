#pragma once

#include <string>
#include <utility>
#include <vector>

#include "scenes/spec.hpp"
#include "view/exhibit/exhibit.hpp"

namespace plumb::test {

/// Returns a start of a scene with worlds of these settings.
inline view::Start start_of(const std::string& scene, std::vector<Settings> settings) {
  view::Start out{.name = scene, .scene = scenes::load_scene(scene)};
  for (Settings& each : settings)
    out.sides.push_back({"world " + std::to_string(out.sides.size()), std::move(each)});
  return out;
}

inline void run(view::Exhibit& exhibit, int frames) {
  for (int i = 0; i < frames; ++i) exhibit.step();
}

inline view::Request set(std::string name, std::string value) {
  return {.verb = view::Verb::set, .name = std::move(name), .value = std::move(value)};
}

inline bool is_sound(const view::Exhibit& exhibit) {
  for (const view::Side& side : exhibit.sides())
    for (const Vec3& p : side.positions())
      if (!is_finite(p)) return false;
  return true;
}

}  // namespace plumb::test
