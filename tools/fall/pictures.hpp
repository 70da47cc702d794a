#pragma once

#include <span>
#include <string>

#include "plumb/measures.hpp"
#include "plumb/scene.hpp"

namespace plumb::tools {

/// Draws a scene at some instants side by side, seen from a corner above, all at one scale. Shapes are
/// rounded lines as thick as they are, a colour for each island, and nearer ones lie over farther ones. Boxes
/// are drawn, planes are left white. Returns an SVG file's text.
std::string draw_fall(const Scene& scene, std::span<const Frame> instants);

}  // namespace plumb::tools
