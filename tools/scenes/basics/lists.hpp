#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/basics/nearest.hpp"

namespace plumb::scenes {

/// Appends `item` to a list such as "a, b".
inline void append_item(std::string& list, std::string_view item, std::string_view separator = ", ") {
  if (!list.empty()) list += separator;
  list += item;
}

/// Joins items into one list.
inline std::string joined(const std::vector<std::string>& items, std::string_view separator = ", ") {
  std::string list;
  for (const std::string& item : items) append_item(list, item, separator);
  return list;
}

/// Returns the items of a list such as "a,b". An empty text has one, and a comma that ends it has none after
/// it.
inline std::vector<std::string> split_list(std::string_view list) {
  std::vector<std::string> out;
  do {
    const std::size_t comma = std::min(list.find(','), list.size());
    out.emplace_back(list.substr(0, comma));
    list.remove_prefix(std::min(comma + 1, list.size()));
  } while (!list.empty());
  return out;
}

/// Returns those of `all` whose names, by name_of(item), are in a list such as "a,b", in its order. Throws
/// std::invalid_argument on a word that names none, with the words that do and the one that was meant.
template <class Item, class NameOf>
std::vector<Item> named(std::string_view list, const std::vector<Item>& all, NameOf name_of) {
  std::vector<Item> out;
  for (;;) {
    const std::size_t comma = list.find(',');
    const std::string_view word = list.substr(0, comma);
    const auto it =
        std::find_if(all.begin(), all.end(), [&](const Item& item) { return name_of(item) == word; });
    if (it == all.end()) {
      std::vector<std::string> known;
      for (const Item& item : all) known.emplace_back(name_of(item));
      throw std::invalid_argument("'" + std::string(word) + "' is not one of " + joined(known) +
                                  did_you_mean(word, known));
    }
    out.push_back(*it);
    if (comma == std::string_view::npos) return out;
    list.remove_prefix(comma + 1);
  }
}

}  // namespace plumb::scenes
