#pragma once

#include <string>

namespace plumb::tools {

/// Throws InputError if gnuplot, which draws the pictures, does not run here.
void require_gnuplot();

/// `text` as gnuplot's scripts spell it.
std::string in_quotes(const std::string& text);

/// What the script, which need set no terminal and no output, draws, as SVG text; sizes in pixels. Throws
/// InputError with gnuplot's own words if it fails; `title` says what was to be drawn.
std::string draw_svg(const std::string& title, int width, int height, const std::string& script);

}  // namespace plumb::tools
