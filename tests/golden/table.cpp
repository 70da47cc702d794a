#include "golden/table.hpp"

#include <array>
#include <charconv>
#include <sstream>

#include "plumb/error.hpp"
#include "scenes/basics/files.hpp"
#include "scenes/basics/numbers.hpp"

namespace plumb::golden {
namespace {

constexpr std::string_view header = "name;";
constexpr std::size_t columns = 8;

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(' ');
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(' ') - first + 1);
}

std::uint64_t parse_hash(const std::string& text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
  if (error != std::errc{} || end != text.data() + text.size()) {
    throw InputError("'" + text + "' is not a hash of hexadecimal digits");
  }
  return value;
}

std::string format_hash(std::uint64_t value) {
  std::array<char, 16> digits{};
  const auto result = std::to_chars(digits.data(), digits.data() + digits.size(), value, 16);
  const std::string text(digits.data(), result.ptr);
  return std::string(digits.size() - text.size(), '0') + text;
}

}  // namespace

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> out;
  while (true) {
    const std::size_t end = text.find(separator);
    out.emplace_back(trimmed(text.substr(0, end)));
    if (end == std::string_view::npos) return out;
    text.remove_prefix(end + 1);
  }
}

Row parse_row(std::string_view line) {
  const std::vector<std::string> fields = split(line, ';');
  if (fields.size() != columns)
    throw InputError("a golden row has 8 columns, not " + std::to_string(fields.size()) + ": '" +
                     std::string(line) + "'");
  const auto steps = scenes::parse_number<std::uint32_t>(fields[4]);
  if (!steps || *steps == 0 || !scenes::parse_fraction(fields[5]))
    throw InputError("steps and dt must be numbers: '" + std::string(line) + "'");
  return {fields[0],
          fields[1],
          fields[2],
          fields[3],
          *steps,
          fields[5],
          {parse_hash(fields[6]), parse_hash(fields[7])}};
}

std::string format_row(const Row& row) {
  return row.name + "; " + row.scene + "; " + row.settings + "; " + row.drive + "; " +
         std::to_string(row.steps) + "; " + row.dt + "; " + format_hash(row.wanted.state) + "; " +
         format_hash(row.wanted.motion);
}

bool is_row(std::string_view line) {
  return !line.empty() && line.front() != '#' && !line.starts_with(header);
}

std::vector<std::string> read_lines(const std::filesystem::path& path) {
  std::istringstream in(scenes::read_file(path));
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::vector<Row> read_table(const std::filesystem::path& path) {
  std::vector<Row> rows;
  for (const std::string& line : read_lines(path))
    if (is_row(line)) rows.push_back(parse_row(line));
  return rows;
}

}  // namespace plumb::golden
