#include "support/sheet.hpp"

#include <algorithm>

namespace plumb::bench {
namespace {

void append_csv_row(std::string& out, const std::vector<std::string>& cells) {
  for (std::size_t c = 0; c < cells.size(); ++c) out.append(c == 0 ? "" : ",").append(cells[c]);
  out += "\n";
}

void append_markdown_row(std::string& out, const std::vector<std::string>& cells,
                         const std::vector<std::size_t>& widths) {
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const std::string padding(widths[c] - cells[c].size(), ' ');
    out.append("| ").append(c == 0 ? cells[c] + padding : padding + cells[c]).append(" ");
  }
  out += "|\n";
}

}  // namespace

std::string Sheet::to_csv() const {
  std::string out;
  append_csv_row(out, header_);
  for (const auto& row : rows_) append_csv_row(out, row);
  return out;
}

std::string Sheet::to_markdown() const {
  std::vector<std::size_t> widths;
  for (const std::string& name : header_) widths.push_back(std::max<std::size_t>(name.size(), 2));
  for (const auto& row : rows_)
    for (std::size_t c = 0; c < widths.size(); ++c) widths[c] = std::max(widths[c], row[c].size());
  std::string out;
  append_markdown_row(out, header_, widths);
  for (std::size_t c = 0; c < widths.size(); ++c)  // the first column is set left, the others right
    out.append("|").append(widths[c] + 1, '-').append(c == 0 ? "-" : ":");
  out += "|\n";
  for (const auto& row : rows_) append_markdown_row(out, row, widths);
  return out;
}

}  // namespace plumb::bench
