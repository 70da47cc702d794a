#include "plot/table.hpp"

#include <algorithm>

namespace plumb::tools {
namespace {

/// Counts characters on the screen. UTF-8's continuation bytes take no room there.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

/// A longer cell, in characters, is a sentence. Lines of its column may break, and all begin at the left.
constexpr std::size_t longest_number = 40;

void append_html_row(std::string& out, const std::vector<std::string>& cells, const std::string& tag,
                     const std::vector<bool>& is_text) {
  out += "<tr>";
  for (std::size_t c = 0; c < cells.size(); ++c) {
    out.append("<").append(tag).append(is_text[c] ? " class=\"text\">" : ">");
    out.append(escape_html(cells[c])).append("</").append(tag).append(">");
  }
  out += "</tr>\n";
}

}  // namespace

std::string Table::to_text() const {
  std::vector<std::size_t> widths(header_.size());
  for (std::size_t c = 0; c < widths.size(); ++c) widths[c] = width_of(header_[c]);
  for (const auto& row : rows_) {
    for (std::size_t c = 0; c < widths.size(); ++c) widths[c] = std::max(widths[c], width_of(row[c]));
  }
  std::string out;
  const auto append = [&](const std::vector<std::string>& cells) {
    std::string line;
    for (std::size_t c = 0; c < widths.size(); ++c) {
      const std::string padding(widths[c] - width_of(cells[c]), ' ');
      line += c == 0 ? cells[c] + padding : "  " + padding + cells[c];
    }
    line.erase(line.find_last_not_of(' ') + 1);
    out += line + "\n";
  };
  append(header_);
  for (const auto& row : rows_) append(row);
  return out;
}

std::string Table::to_html() const {
  std::vector<bool> is_text(header_.size());
  for (const auto& row : rows_)
    for (std::size_t c = 0; c < row.size(); ++c) is_text[c] = is_text[c] || row[c].size() > longest_number;
  std::string out = "<table>\n<thead>";
  append_html_row(out, header_, "th", is_text);
  out += "</thead>\n<tbody>\n";
  for (const auto& row : rows_) append_html_row(out, row, "td", is_text);
  return out + "</tbody>\n</table>\n";
}

std::string escape_html(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&') {
      out += "&amp;";
    } else if (c == '<') {
      out += "&lt;";
    } else if (c == '>') {
      out += "&gt;";
    } else if (c == '"') {
      out += "&quot;";
    } else {
      out += c;
    }
  }
  return out;
}

}  // namespace plumb::tools
