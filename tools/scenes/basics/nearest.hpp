#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace plumb::scenes {

/// Returns how many letters to add, leave out, change, or swap with a neighbour make one word of another
/// (optimal string alignment).
inline std::size_t letters_apart(std::string_view a, std::string_view b) {
  // Rows of the table for the last two letters of a and for this one.
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), now(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) now[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before.swap(last);
    last.swap(now);
    now[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      now[j] = std::min({last[j] + 1, now[j - 1] + 1, last[j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        now[j] = std::min(now[j], before[j - 2] + 1);
    }
  }
  return now[b.size()];
}

/// Ends a message that a name is unknown with the first of the names nearest to it, if it may be a slip of
/// one: one letter off, and one more for every four of its letters.
inline std::string did_you_mean(std::string_view word, const std::vector<std::string>& names) {
  std::string nearest;
  std::size_t least = word.size() < 3 ? 0 : 2 + word.size() / 4;
  for (const std::string& name : names)
    if (const std::size_t apart = letters_apart(word, name); apart < least) {
      least = apart;
      nearest = name;
    }
  return nearest.empty() ? "" : ". Did you mean " + nearest + "?";
}

}  // namespace plumb::scenes
