#pragma once

#include <span>
#include <string>

#include "plumb/measures.hpp"
#include "plumb/scene.hpp"

namespace plumb::tools {

/// Draws a scene at some instants side by side, seen from a corner above, all at one scale. Shapes are
/// rounded lines as thick as they are, a colour for each island; nearer ones lie over farther ones, which are
/// paler. Boxes and round ground hide what is behind them. A level plane has lines and shadows of what is
/// above. Other ground and hulls are not drawn. Returns an SVG file's text.
std::string draw_fall(const Scene& scene, std::span<const Frame> instants);

}  // namespace plumb::tools
