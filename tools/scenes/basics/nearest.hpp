#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace plumb::scenes {

/// Returns, for each number of first letters of b, how many letters to add, leave out, change, or swap with a
/// neighbour make a of them (optimal string alignment). Where a may begin `anywhere`, letters before it are
/// left out for nothing.
inline std::vector<std::size_t> letters_apart_row(std::string_view a, std::string_view b, bool anywhere) {
  // Rows of the table for the last two letters of a and for this one.
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), now(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) now[j] = anywhere ? 0 : j;
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
  return now;
}

/// Returns how many such changes make one word of another.
inline std::size_t letters_apart(std::string_view a, std::string_view b) {
  return letters_apart_row(a, b, false).back();
}

/// Returns the same of a word and the part of a name that is nearest to it.
inline std::size_t letters_apart_within(std::string_view word, std::string_view name) {
  const std::vector<std::size_t> row = letters_apart_row(word, name, true);
  return *std::min_element(row.begin(), row.end());
}

/// Returns how many letters two words have in common from the start on.
inline std::size_t common_start(std::string_view a, std::string_view b) {
  const auto [end, ignored] = std::mismatch(a.begin(), a.end(), b.begin(), b.end());
  return static_cast<std::size_t>(end - a.begin());
}

inline std::string_view without_dashes(std::string_view word) {
  return word.substr(std::min(word.size(), word.find_first_not_of('-')));
}

/// Returns how many slips make a word of a name. A word that is nearly a part of the name left out the rest
/// in one slip; fewer than four letters are part of too many. Dashes before the word are none of its letters.
inline std::size_t slips(std::string_view word, std::string_view name) {
  const std::size_t whole = letters_apart(word, name);
  const std::string_view bare = without_dashes(word);
  const std::size_t part = letters_apart_within(bare, name);
  return bare.size() < 4 || part > bare.size() / 4 ? whole : std::min(whole, 1 + part);
}

/// Ends a message that a name is unknown with the name that was meant, if one is near: one slip, and one more
/// for every four letters of the word. Of names as near it is the one of the nearest length, and of these the
/// first of those that begin most alike.
inline std::string did_you_mean(std::string_view word, const std::vector<std::string>& names) {
  const std::string* nearest = nullptr;
  std::array<std::size_t, 3> least{};
  const std::size_t most = 1 + without_dashes(word).size() / 4;
  for (const std::string& name : names) {
    const std::size_t longer = std::max(word.size(), name.size()),
                      shorter = std::min(word.size(), name.size());
    const std::array off{slips(word, name), longer - shorter, word.size() - common_start(word, name)};
    if (word.size() < 3 || off[0] > most || (nearest && off >= least)) continue;
    least = off;
    nearest = &name;
  }
  return nearest ? ". Did you mean " + *nearest + "?" : "";
}

}  // namespace plumb::scenes
