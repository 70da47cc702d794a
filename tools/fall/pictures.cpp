#include "fall/pictures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "plot/table.hpp"
#include "plumb/layouts/islands.hpp"
#include "scenes/basics/numbers.hpp"
#include "scenes/humanoid/limbs.hpp"
#include "scenes/runs/depth.hpp"

namespace plumb::tools {
namespace {

using scenes::place_of;
using scenes::short_number;

// Sizes are in pixels.
constexpr double width = 960, between = 8, below = 24, highest = 300;
constexpr std::array colors = {"#1f5fa8", "#d1495b", "#2e8b57", "#e6a532",
                               "#7b5ea7", "#4aa3b5", "#8c6239", "#5a6b7b"};

/// A point as it is seen: to the right, up and towards the eye, in m.
struct Seen {
  double right, up, near;
};

/// Looks from a corner, 30° to the side and 25° down.
Seen seen(Vec3 at) {
  const double side_sin = 0.5, side_cos = std::sqrt(0.75), down_sin = 0.4226182617, down_cos = 0.9063077870;
  const double right = side_cos * at.x - side_sin * at.z, away = side_sin * at.x + side_cos * at.z;
  return {right, down_cos * at.y - down_sin * away, down_sin * at.y + down_cos * away};
}

struct Window {
  double left = INFINITY, right = -INFINITY, low = INFINITY, high = -INFINITY;

  void take_in(const Seen& at, double radius) {
    left = std::min(left, at.right - radius);
    right = std::max(right, at.right + radius);
    low = std::min(low, at.up - radius);
    high = std::max(high, at.up + radius);
  }
};

/// Maps metres to a panel's pixels.
struct Panel {
  double x = 0, scale = 1;
  Window window;

  std::string at(const Seen& point) const {
    return short_number(x + scale * (point.right - window.left), 5) + " " +
           short_number(scale * (window.high - point.up), 5);
  }
};

std::array<Vec3, 8> corners_of(const Box& box) {
  Box back = box;
  for (int i = 1; i < 4; ++i) back.orientation[i] = -back.orientation[i];
  std::array<Vec3, 8> out;
  for (std::size_t i = 0; i < 8; ++i) {
    const auto side = [&](std::size_t bit, double half) { return (i >> bit & 1) != 0 ? half : -half; };
    out[i] = box.center + scenes::to_axes(back, {side(0, box.half_size.x), side(1, box.half_size.y),
                                                 side(2, box.half_size.z)});
  }
  return out;
}

/// Draws the faces that are turned to the eye.
std::string draw_box(const Panel& panel, const Box& box) {
  constexpr std::array<std::array<int, 4>, 6> faces = {
      {{0, 2, 6, 4}, {1, 5, 7, 3}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 6, 7, 5}}};
  constexpr std::array shades = {"#ccc", "#ccc", "#bbb", "#e4e4e4", "#d6d6d6", "#d6d6d6"};
  const std::array<Vec3, 8> corners = corners_of(box);
  std::string out;
  for (std::size_t f = 0; f < 6; ++f) {
    Vec3 middle{};
    for (const int corner : faces[f]) middle += 0.25 * corners[corner];
    if (seen(middle).near <= seen(box.center).near) continue;
    std::string path;
    for (const int corner : faces[f]) path += (path.empty() ? "M" : " L") + panel.at(seen(corners[corner]));
    out += "<path d=\"" + path + " Z\" fill=\"" + shades[f] + "\" stroke=\"#999\"/>\n";
  }
  return out;
}

/// Returns the number of every particle's island.
std::vector<std::uint32_t> islands_of(const Scene& scene) {
  std::vector<layouts::Edge> edges;
  for (const Rod& rod : scene.rods) edges.push_back({rod.a, rod.b});
  std::vector<std::uint8_t> movable;
  for (const Particle& particle : scene.particles) movable.push_back(particle.fixed ? 0 : 1);
  const auto count = static_cast<std::uint32_t>(scene.particles.size());
  const layouts::Islands islands = layouts::find_islands({count, edges, movable});
  std::vector<std::uint32_t> out(count, 0);
  for (std::uint32_t i = 0; i < islands.count(); ++i)
    for (const std::uint32_t particle : islands.vertices(i)) out[particle] = i;
  return out;
}

std::string draw_panel(const Panel& panel, const Scene& scene, std::span<const std::uint32_t> islands,
                       const Frame& instant) {
  std::string out;
  for (const Box& box : scene.boxes) out += draw_box(panel, box);
  std::vector<std::size_t> order(scene.capsules.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto near = [&](std::size_t i) {
    const Capsule& each = scene.capsules[i];
    return seen(place_of(each.a, instant.positions)).near + seen(place_of(each.b, instant.positions)).near;
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t i, std::size_t k) { return near(i) < near(k); });
  for (const std::size_t i : order) {
    const Capsule& each = scene.capsules[i];
    const std::string path = "<path d=\"M" + panel.at(seen(place_of(each.a, instant.positions))) + " L" +
                             panel.at(seen(place_of(each.b, instant.positions))) + "\" stroke=\"";
    const double thick = std::max(2 * panel.scale * each.radius, 1.0);
    if (thick > 3) out += path + "#fff\" stroke-width=\"" + short_number(thick + 1, 3) + "\"/>\n";
    out += path + colors[islands[each.a.particles[0]] % colors.size()] + "\" stroke-width=\"" +
           short_number(thick, 3) + "\"/>\n";
  }
  return out;
}

}  // namespace

std::string draw_fall(const Scene& scene, std::span<const Frame> instants) {
  Window window;
  for (const Frame& instant : instants)
    for (const Capsule& each : scene.capsules)
      for (const Point* point : {&each.a, &each.b})
        window.take_in(seen(place_of(*point, instant.positions)), each.radius);
  for (const Box& box : scene.boxes)
    for (const Vec3 corner : corners_of(box)) window.take_in(seen(corner), 0);
  const auto columns = static_cast<double>(std::max<std::size_t>(instants.size(), 1));
  const double room = (width - between * (columns - 1)) / columns;
  const double scale = std::min(room / (window.right - window.left), highest / (window.high - window.low));
  const double high = scale * (window.high - window.low);
  const std::string size = short_number(width) + "\" height=\"" + short_number(high + below, 5);
  std::string out = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + size + "\" viewBox=\"0 0 " +
                    short_number(width) + " " + short_number(high + below, 5) +
                    "\" font-family=\"sans-serif\" fill=\"#222\">\n"
                    "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n";
  const std::vector<std::uint32_t> islands = islands_of(scene);
  for (std::size_t i = 0; i < instants.size(); ++i) {
    const double left = static_cast<double>(i) * (room + between);
    const double aside = 0.5 * (room - scale * (window.right - window.left));
    out += "<g stroke-linecap=\"round\" fill=\"none\">\n" +
           draw_panel({.x = left + aside, .scale = scale, .window = window}, scene, islands, instants[i]) +
           "</g>\n<text x=\"" + short_number(left + room / 2, 5) + "\" y=\"" + short_number(high + 17, 5) +
           "\" text-anchor=\"middle\" font-size=\"12\">t = " + scenes::plain_number(instants[i].t, 2) +
           " s</text>\n";
  }
  return out + "</svg>\n";
}

}  // namespace plumb::tools
