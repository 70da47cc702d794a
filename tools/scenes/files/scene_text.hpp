#pragma once

#include <string>

#include "plumb/vec3.hpp"
#include "scenes/basics/json.hpp"

/// A scene file that is written has a list's items one to a line.
namespace plumb::scenes {

inline Json to_json(Vec3 v) {
  return Json::array_of({v.x, v.y, v.z});
}

template <class Items, class ToJson>
void append_list(std::string& out, const char* key, const Items& items, ToJson to_object) {
  out += std::string(",\n  \"") + key + "\": [";
  for (const auto& item : items) {
    out += &item == &items.front() ? "\n    " : ",\n    ";
    out += to_object(item).dump();
  }
  out += items.empty() ? "]" : "\n  ]";
}

}  // namespace plumb::scenes
