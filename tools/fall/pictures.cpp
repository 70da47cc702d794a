#include "fall/pictures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <vector>

#include "fall/view.hpp"
#include "plumb/joints.hpp"
#include "plumb/layouts/islands.hpp"
#include "scenes/basics/numbers.hpp"
#include "scenes/humanoid/limbs.hpp"

namespace plumb::tools {
namespace {

using scenes::place_of;
using scenes::short_number;

// Sizes are in pixels.
constexpr double width = 960, between = 8, below = 24, highest = 300;
constexpr std::array<std::uint32_t, 8> colors = {0x1f5fa8, 0xd1495b, 0x2e8b57, 0xe6a532,
                                                 0x7b5ea7, 0x4aa3b5, 0x8c6239, 0x5a6b7b};
constexpr double paleness = 0.45;  // What is farthest away is so near to white.

/// Maps metres to a panel's pixels.
struct Panel {
  double x = 0, scale = 1;
  Window window;

  std::string at(Vec3 place) const {
    const Seen point = seen(place);
    return short_number(x + scale * (point.right - window.left), 5) + " " +
           short_number(scale * (window.high - point.up), 5);
  }
  std::string line(Vec3 a, Vec3 b) const { return "M" + at(a) + " L" + at(b); }
};

/// The level rectangle on which everything stands, and the distance of the lines on it, all in m.
struct Floor {
  double height = 0, left = INFINITY, right = -INFINITY, back = INFINITY, front = -INFINITY, spacing = 1;

  void take_in(Vec3 at, double radius) {
    left = std::min(left, at.x - radius);
    right = std::max(right, at.x + radius);
    back = std::min(back, at.z - radius);
    front = std::max(front, at.z + radius);
  }
  /// Makes room around, to whole lines.
  void finish() {
    const double size = std::max(right - left, front - back);
    spacing = std::pow(10, std::floor(std::log10(size)));
    while (size < 5 * spacing) spacing /= 2;
    for (double* least : {&left, &back}) *least = spacing * std::floor(*least / spacing);
    for (double* most : {&right, &front}) *most = spacing * std::ceil(*most / spacing);
  }
  std::array<Vec3, 4> corners() const {
    return {Vec3{left, height, back}, {right, height, back}, {right, height, front}, {left, height, front}};
  }
};

template <class Places>
std::string outline(const Panel& panel, const Places& places) {
  std::string path;
  for (const Vec3& place : places) path += (path.empty() ? "M" : " L") + panel.at(place);
  return path + " Z";
}

std::string draw_floor(const Panel& panel, const Floor& floor) {
  std::string lines;
  const auto count = [&](double low, double high) { return std::lround((high - low) / floor.spacing); };
  for (long i = 0; i <= count(floor.left, floor.right); ++i) {
    const double x = floor.left + floor.spacing * static_cast<double>(i);
    lines += panel.line({x, floor.height, floor.back}, {x, floor.height, floor.front});
  }
  for (long i = 0; i <= count(floor.back, floor.front); ++i) {
    const double z = floor.back + floor.spacing * static_cast<double>(i);
    lines += panel.line({floor.left, floor.height, z}, {floor.right, floor.height, z});
  }
  return "<path d=\"" + outline(panel, floor.corners()) + "\" fill=\"#f3f1ec\"/>\n<path d=\"" + lines +
         "\" stroke=\"#dcd8cf\"/>\n";
}

/// Draws what lies straight below shapes, so that one sees how high they are.
std::string draw_shadows(const Panel& panel, const Scene& scene, double height, const Frame& instant) {
  std::string out = "<g opacity=\"0.16\" stroke=\"#000\">\n";
  const auto add = [&](Vec3 a, Vec3 b, double radius) {
    a.y = b.y = height;
    out += "<path d=\"" + panel.line(a, b) + "\" stroke-width=\"" +
           short_number(std::max(2 * panel.scale * radius, 1.0), 3) + "\"/>\n";
  };
  for (const Capsule& each : scene.capsules)
    add(place_of(each.a, instant.positions), place_of(each.b, instant.positions), each.radius);
  // What is large is drawn as it lies on the floor: a thick line as seen from above, and flattened.
  for (const GroundCapsule& each : scene.ground_capsules) {
    const Seen a = seen({each.a.x, height, each.a.z}), b = seen({each.b.x, height, each.b.z});
    const double flat = flatness_of_level();
    out += "<path transform=\"translate(" + panel.at({each.a.x, height, each.a.z}) + ") scale(1 " +
           short_number(flat, 5) + ")\" d=\"M0 0 L" + short_number(panel.scale * (b.right - a.right), 5) +
           " " + short_number(panel.scale * (a.up - b.up) / flat, 5) + "\" stroke-width=\"" +
           short_number(2 * panel.scale * each.radius, 4) + "\"/>\n";
  }
  return out + "</g>\n";
}

/// Draws the faces that are turned to the eye.
std::string draw_box(const Panel& panel, const Box& box) {
  constexpr std::array<std::array<int, 4>, 6> faces = {
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  constexpr std::array shades = {"#ccc", "#ccc", "#bbb", "#e4e4e4", "#d6d6d6", "#d6d6d6"};
  const std::vector<Vec3> corners = box_on_body(0, box).points;
  std::string out;
  for (std::size_t f = 0; f < 6; ++f) {
    Vec3 middle{};
    std::array<Vec3, 4> face;
    for (std::size_t i = 0; i < 4; ++i) {
      face[i] = corners[faces[f][i]];
      middle += 0.25 * face[i];
    }
    if (seen(middle).near <= seen(box.center).near) continue;
    out += "<path d=\"" + outline(panel, face) + "\" fill=\"" + shades[f] + "\" stroke=\"#999\"/>\n";
  }
  return out;
}

/// Draws a capsule of the ground as a thick line in light and shade: bands that are ever paler and thinner,
/// and lie ever nearer to where the light comes from.
std::string draw_round(const Panel& panel, const GroundCapsule& capsule) {
  constexpr int bands = 12;
  std::string out;
  for (int i = 0; i <= bands; ++i) {
    const double share = static_cast<double>(i) / bands, thin = std::sqrt(1 - share * share * 0.98);
    const Vec3 aside = (0.45 * share * capsule.radius) * Vec3{-0.35, 0.9, 0.1};
    char shade[8];
    const int grey = 0xb4 + static_cast<int>(share * 0x38);
    std::snprintf(shade, sizeof shade, "#%02x%02x%02x", grey, grey, grey);
    out += "<path d=\"" + panel.line(capsule.a + aside, capsule.b + aside) + "\" stroke=\"" + shade +
           "\" stroke-width=\"" +
           short_number(2 * panel.scale * capsule.radius * (i == 0 ? 1 : 0.97 * thin), 4) + "\"/>\n";
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

/// Mixes a colour with white.
std::string paler(std::uint32_t color, double share) {
  const auto mixed = [&](int shift) {
    const auto part = static_cast<int>(color >> shift & 0xff);
    return part + static_cast<int>(share * (255 - part));
  };
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", mixed(16), mixed(8), mixed(0));
  return text;
}

/// A shape as it lies in a picture.
struct Shown {
  Vec3 a, b;
  double radius, near;
  std::uint32_t color;
  bool hidden;
};

std::vector<Shown> shown_shapes(const Scene& scene, std::span<const std::uint32_t> islands,
                                const Frame& instant) {
  std::vector<Shown> out;
  for (const Capsule& each : scene.capsules) {
    const Vec3 a = place_of(each.a, instant.positions), b = place_of(each.b, instant.positions);
    const Vec3 middle = 0.5 * (a + b);
    out.push_back({a, b, each.radius, seen(middle).near, colors[islands[each.a.particles[0]] % colors.size()],
                   is_hidden(scene, middle)});
  }
  std::stable_sort(out.begin(), out.end(), [](const Shown& l, const Shown& r) { return l.near < r.near; });
  return out;
}

std::string draw_shape(const Panel& panel, const Shown& shape) {
  const Window& window = panel.window;
  const double deep = std::max(window.near - window.far, 1e-9);
  const double thick = std::max(2 * panel.scale * shape.radius, 1.0);
  const std::string path = "d=\"" + panel.line(shape.a, shape.b) + "\" stroke=\"";
  std::string out;
  if (thick > 3) out += "<path " + path + "#fff\" stroke-width=\"" + short_number(thick + 1, 3) + "\"/>\n";
  return out + "<path class=\"shape\" " + path +
         paler(shape.color, paleness * (window.near - shape.near) / deep) + "\" stroke-width=\"" +
         short_number(thick, 3) + "\"/>\n";
}

/// Draws what is behind solids, then these, then all other shapes, each from the back to the front.
std::string draw_panel(const Panel& panel, const Scene& scene, std::span<const Shown> shapes) {
  std::string out;
  for (const Shown& each : shapes)
    if (each.hidden) out += draw_shape(panel, each);
  for (const Box& box : scene.boxes) out += draw_box(panel, box);
  for (const GroundCapsule& capsule : scene.ground_capsules) out += draw_round(panel, capsule);
  for (const Shown& each : shapes)
    if (!each.hidden) out += draw_shape(panel, each);
  return out;
}

bool is_level(const Plane& plane) {
  return plane.normal.y == 1;
}

/// Takes in all that is ever seen, and makes the floor as wide.
Window window_of(const Scene& scene, std::span<const Frame> instants, Floor& floor) {
  Window window;
  const auto take_in = [&](Vec3 at, double radius) {
    window.take_in(seen(at), radius);
    floor.take_in(at, radius);
  };
  for (const Frame& instant : instants)
    for (const Capsule& each : scene.capsules)
      for (const Point* point : {&each.a, &each.b}) take_in(place_of(*point, instant.positions), each.radius);
  for (const Box& box : scene.boxes)
    for (const Vec3 corner : box_on_body(0, box).points) take_in(corner, 0);
  for (const GroundCapsule& each : scene.ground_capsules)
    for (const Vec3 end : {each.a, each.b}) take_in(end, each.radius);
  floor.finish();
  if (std::any_of(scene.planes.begin(), scene.planes.end(), is_level))
    for (const Vec3 corner : floor.corners()) window.take_in(seen(corner), 0);
  return window;
}

}  // namespace

std::string draw_fall(const Scene& scene, std::span<const Frame> instants) {
  Floor floor;
  const auto ground = std::find_if(scene.planes.begin(), scene.planes.end(), is_level);
  if (ground != scene.planes.end()) floor.height = ground->offset;
  const Window window = window_of(scene, instants, floor);
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
    const Panel panel{.x = left + aside, .scale = scale, .window = window};
    out += "<g stroke-linecap=\"round\" fill=\"none\">\n";
    if (ground != scene.planes.end())
      out += draw_floor(panel, floor) + draw_shadows(panel, scene, floor.height, instants[i]);
    out += draw_panel(panel, scene, shown_shapes(scene, islands, instants[i])) + "</g>\n<text x=\"" +
           short_number(left + room / 2, 5) + "\" y=\"" + short_number(high + 17, 5) +
           "\" text-anchor=\"middle\" font-size=\"12\">t = " + scenes::plain_number(instants[i].t, 2) +
           " s</text>\n";
  }
  return out + "</svg>\n";
}

}  // namespace plumb::tools
