#pragma once

#include <string>

namespace plumb::tools {

/// Throws InputError if gnuplot, which draws the pictures, does not run here.
void require_gnuplot();

/// Quotes `text` as gnuplot's scripts need it.
std::string in_quotes(const std::string& text);

/// Returns as SVG text what the script draws. The script sets neither terminal nor output. Sizes are in
/// pixels, and `title` says what is drawn. Throws InputError with gnuplot's own words if it fails.
std::string draw_svg(const std::string& title, int width, int height, const std::string& script);

}  // namespace plumb::tools
