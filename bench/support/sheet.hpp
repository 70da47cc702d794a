#pragma once

#include <string>
#include <vector>

namespace plumb::bench {

/// Holds rows of texts under a header, as CSV for programs and as Markdown for people. Markdown's columns are
/// padded, so that it also reads well in a terminal.
class Sheet {
 public:
  explicit Sheet(std::vector<std::string> header) : header_(std::move(header)) {}
  /// Adds a row, which must have as many cells as the header.
  void add_row(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }
  bool empty() const { return rows_.empty(); }

  std::string to_csv() const;
  std::string to_markdown() const;

 private:
  std::vector<std::string> header_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace plumb::bench
