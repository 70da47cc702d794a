#pragma once

#include <cstdint>
#include <filesystem>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

/// The table of golden hashes: what a scene looks like after some steps, as numbers that no change of the
/// code may alter unnoticed.
namespace plumb::golden {

struct Hashes {
  std::uint64_t state = 0;   ///< World::state_hash()
  std::uint64_t motion = 0;  ///< positions and velocities as World hands them out

  bool operator==(const Hashes&) const = default;
};

/// One line of the table; the head of golden.csv explains the columns.
struct Row {
  std::string name;
  std::string scene;     ///< scenes.hpp
  std::string settings;  ///< settings_text.hpp
  std::string drive;     ///< run.hpp
  std::uint32_t steps = 0;
  std::string dt;  ///< s, as a decimal or a fraction
  Hashes wanted{};

  friend void PrintTo(const Row& row, std::ostream* out) { *out << row.name; }
};

/// The row that `line` spells. Throws InputError that quotes the line if it spells none.
Row parse_row(std::string_view line);
/// The line that parse_row() reads as `row`.
std::string format_row(const Row& row);

/// A line of the file is a row unless it is empty, a comment (#) or the header.
bool is_row(std::string_view line);
std::vector<std::string> read_lines(const std::filesystem::path& path);
std::vector<Row> read_table(const std::filesystem::path& path);

/// The parts of `text` between separators; blanks around them are cut off, and empty parts are kept.
std::vector<std::string> split(std::string_view text, char separator);

}  // namespace plumb::golden
