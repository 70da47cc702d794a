#pragma once

#include <string>
#include <vector>

namespace plumb::tools {

/// Stands in a cell that has no value.
inline constexpr const char* no_value = "—";

/// A table holds texts for a terminal or a page. The first column is set left, the others right.
class Table {
 public:
  explicit Table(std::vector<std::string> header) : header_(std::move(header)) {}
  void add_row(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }

  /// Returns one line per row, with two blanks between columns.
  std::string to_text() const;
  std::string to_html() const;

 private:
  std::vector<std::string> header_;
  std::vector<std::vector<std::string>> rows_;
};

/// Spells out the characters that mean something in HTML.
std::string escape_html(const std::string& text);

}  // namespace plumb::tools
