#include "plot/heat_map.hpp"

#include <algorithm>
#include <cmath>

#include "plot/gnuplot.hpp"
#include "scenes/basics/lists.hpp"
#include "scenes/basics/numbers.hpp"

namespace plumb::tools {
namespace {

using scenes::append_item;
using scenes::short_number;

// Sizes are in pixels.
constexpr int width = 820, panel_height = 185, left = 78, right = 14, between = 14;
constexpr int above = 62, below_line = 36, below = 110;
constexpr std::size_t panels_in_line = 3;

// The palette is viridis, from its light end to its dark one.
constexpr const char* palette =
    "set palette defined (0 '#fde725', 1 '#a0da39', 2 '#4ac16d', 3 '#1fa187', 4 '#277f8e', 5 '#365c8d', "
    "6 '#46327e', 7 '#440154')\n";

std::string ticks_of(const std::vector<std::string>& names) {
  std::string list;
  for (std::size_t i = 0; i < names.size(); ++i)
    append_item(list, in_quotes(names[i]) + " " + std::to_string(i));
  return "(" + list + ")";
}

/// Returns the power of ten of a value, cut to the range of the colours.
double level_of(const HeatMap& map, double value) {
  if (std::isnan(value)) return map.most;
  return std::clamp(value > 0 ? std::log10(value) : map.least, static_cast<double>(map.least),
                    static_cast<double>(map.most));
}

/// Tells gnuplot what a panel shows: its cells as data blocks, and the arguments of `plot`.
struct PanelScript {
  std::string blocks;
  std::string plot;
};

/// Adds the cells of one kind, if there are any.
template <class Takes>
void add_cells(PanelScript& script, const HeatMap& map, const HeatPanel& panel, const std::string& name,
               const std::string& style, Takes takes) {
  std::string lines;
  for (const HeatCell& cell : panel.cells) {
    if (!takes(cell)) continue;
    lines += std::to_string(cell.column) + " " + std::to_string(cell.row) + " " +
             short_number(level_of(map, cell.value)) + "\n";
  }
  if (lines.empty()) return;
  script.blocks += name + " << EOD\n" + lines + "EOD\n";
  append_item(script.plot, name + " " + style);
}

/// Whether a black mark would be lost on the cell's colour.
bool is_dark(const HeatMap& map, const HeatCell& cell) {
  return level_of(map, cell.value) > map.least + 0.55 * (map.most - map.least);
}

std::string colour_ticks(const HeatMap& map) {
  std::string list;
  for (int power = map.least; power <= map.most; ++power) {
    std::string text = power == map.least ? "≤ " : power == map.most ? "≥ " : "";
    text += power == 0 ? "1" : power == -1 ? "0.1" : power == -2 ? "0.01" : "1e";
    if (power < -2 || power > 0) text += std::to_string(power);
    append_item(list, in_quotes(text) + " " + std::to_string(power));
  }
  return "(" + list + ")";
}

std::string script_for(const HeatMap& map, int height) {
  const auto share = [](double pixels, int all) { return short_number(pixels / all, 6); };
  const auto from_below = [&](double y) { return share(height - y, height); };
  const double panel_width =
      (width - left - right - between * (panels_in_line - 1)) / static_cast<double>(panels_in_line);
  std::string s = "set multiplot\nunset key\nunset colorbox\nset border lc rgb '#555555'\n" +
                  std::string(palette) + "set cbrange [" + std::to_string(map.least) + ":" +
                  std::to_string(map.most) + "]\nset xrange [-0.5:" + std::to_string(map.columns.size()) +
                  "-0.5]\nset yrange [-0.5:" + std::to_string(map.rows.size()) +
                  "-0.5]\nset style fill solid noborder\n" + "set label 1 " + in_quotes(map.title) +
                  " at screen 0.5," + from_below(18) + " center font ',15'\nset label 2 " + in_quotes(map.x) +
                  " at screen 0.5," + from_below(height - below + 40) + " center\n";
  for (std::size_t i = 0; i < map.panels.size(); ++i) {
    const HeatPanel& panel = map.panels[i];
    const std::size_t column = i % panels_in_line, line = i / panels_in_line;
    const double x = left + static_cast<double>(column) * (panel_width + between);
    const double y = above + static_cast<double>(line) * (panel_height + below_line);
    const bool lowest = i + panels_in_line >= map.panels.size();
    s += "set lmargin at screen " + share(x, width) + "\nset rmargin at screen " +
         share(x + panel_width, width) + "\nset tmargin at screen " + from_below(y) +
         "\nset bmargin at screen " + from_below(y + panel_height) + "\nset title " + in_quotes(panel.title) +
         " offset 0,-0.6\nset xtics " + (lowest ? ticks_of(map.columns) : "('' 0)") +
         " scale 0 offset 0,0.4 font ',12'\nset ytics " + (column == 0 ? ticks_of(map.rows) : "('' 0)") +
         " scale 0 font ',12'\nset ylabel " + in_quotes(column == 0 ? map.y : "") + "\n";
    if (i + 1 == map.panels.size()) {
      const std::string y_marks = from_below(height - 26);
      s += "set cbtics " + colour_ticks(map) + " scale 0.4 font ',12'\nset cblabel " +
           in_quotes(map.quantity) + " offset 0,0.4\nset colorbox horizontal user origin " +
           share(left, width) + "," + from_below(height - 44) + " size " + share(0.52 * width, width) + "," +
           share(14, height) + "\n";
      s += "set label 3 " + in_quotes(map.crossed) + " at screen 0.72," + from_below(height - 50) +
           " point pt 2 ps 0.7 lw 1.6 lc rgb 'black' offset 0.8,0 font ',12'\n";
      if (std::any_of(map.panels.begin(), map.panels.end(), [](const HeatPanel& p) {
            return std::any_of(p.cells.begin(), p.cells.end(), [](const HeatCell& c) { return c.missing; });
          })) {
        s += "set label 4 " + in_quotes(map.missing) + " at screen 0.72," + y_marks +
             " point pt 6 ps 0.7 lw 1.6 lc rgb 'black' offset 0.8,0 font ',12'\n";
      }
    }
    PanelScript script;
    const std::string box = "using 1:2:(0.5):(0.5)";
    const std::string cross = "using 1:2 with points pt 2 ps 0.7 lw 1.6 lc rgb ";
    add_cells(script, map, panel, "$coloured", box + ":3 with boxxyerror lc palette",
              [](const HeatCell& c) { return !c.missing; });
    add_cells(script, map, panel, "$grey", box + " with boxxyerror lc rgb '#d9d9d9'",
              [](const HeatCell& c) { return c.missing; });
    add_cells(script, map, panel, "$black", cross + "'black'",
              [&](const HeatCell& c) { return c.crossed && !is_dark(map, c); });
    add_cells(script, map, panel, "$white", cross + "'white'",
              [&](const HeatCell& c) { return c.crossed && is_dark(map, c); });
    add_cells(script, map, panel, "$ringed", "using 1:2 with points pt 6 ps 0.7 lw 1.6 lc rgb 'black'",
              [](const HeatCell& c) { return c.missing; });
    s += script.blocks + "plot " + (script.plot.empty() ? "NaN" : script.plot) + "\nunset label\n";
  }
  return s + "unset multiplot\n";
}

}  // namespace

std::string draw_svg(const HeatMap& map) {
  const auto lines = static_cast<int>((map.panels.size() + panels_in_line - 1) / panels_in_line);
  const int height = above + lines * (panel_height + below_line) - below_line + below;
  return draw_svg(map.title, width, height, script_for(map, height));
}

}  // namespace plumb::tools
