#pragma once

#include <string>
#include <string_view>

namespace plumb::scenes {

/// Appends `item` to a list such as "a, b".
inline void append_item(std::string& list, std::string_view item, std::string_view separator = ", ") {
  if (!list.empty()) list += separator;
  list += item;
}

}  // namespace plumb::scenes
