#pragma once

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "scenes/basics/numbers.hpp"

namespace plumb::bench {

/// Holds a command line from which a program takes its own flags. The rest is for others.
class Flags {
 public:
  Flags(int argc, char** argv) : words_(argv, argv + argc) {}

  /// Takes --name, and returns whether it was there.
  bool take(const std::string& name) {
    const auto found = std::find(words_.begin(), words_.end(), name);
    if (found == words_.end()) return false;
    words_.erase(found);
    return true;
  }

  /// Takes --name VALUE or --name=VALUE. Throws std::invalid_argument if there is no value.
  std::optional<std::string> take_value(const std::string& name) {
    for (auto word = words_.begin(); word != words_.end(); ++word) {
      if (word->starts_with(name + "=")) {
        const std::string value = word->substr(name.size() + 1);
        words_.erase(word);
        return value;
      }
      if (*word != name) continue;
      if (word + 1 == words_.end()) throw std::invalid_argument(name + " needs a value");
      const std::string value = word[1];
      words_.erase(word, word + 2);
      return value;
    }
    return {};
  }

  /// Takes the value as a number of at least `least`. Throws std::invalid_argument if it is none.
  std::uint32_t take_count(const std::string& name, std::uint32_t otherwise, std::uint32_t least) {
    const auto text = take_value(name);
    if (!text) return otherwise;
    const auto count = scenes::parse_number<std::uint32_t>(*text);
    if (!count || *count < least)
      throw std::invalid_argument(name + " must be a whole number of at least " + std::to_string(least));
    return *count;
  }

  /// Returns the program's name and what nobody took.
  std::vector<std::string>& rest() { return words_; }

 private:
  std::vector<std::string> words_;
};

}  // namespace plumb::bench
