#include "humanoid/pictures.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "plot/table.hpp"
#include "scenes/basics/numbers.hpp"
#include "scenes/humanoid/limbs.hpp"

namespace plumb::tools {
namespace {

using scenes::place_of;
using scenes::short_number;

// Sizes are in pixels.
constexpr double width = 960, left = 10, right = 10, between = 8, title_height = 26, below = 30;
constexpr double highest_panel = 220;
/// This margin surrounds what is drawn, in m.
constexpr double margin = 0.15;

constexpr const char* ball_color = "#d1495b";
constexpr const char* near_color = "#1f5fa8";
constexpr const char* far_color = "#8fb3dc";

/// A box is a rectangle in the plane of the picture, in m.
struct Window {
  double left = 0, right = 0, top = 0;
  double width() const { return right - left; }
};

/// Returns what the figures of all rows ever cover, the places where they stood, and the balls at the first
/// instants. Later the balls may fly out of it.
Window window_of(std::span<const PoseRow> rows) {
  Window window{.left = -0.5, .right = 0.5, .top = 0.5};
  const auto take_in = [&](const Capsule& capsule, const Frame& pose) {
    for (const Point* point : {&capsule.a, &capsule.b}) {
      const Vec3 at = place_of(*point, pose.positions);
      window.left = std::min(window.left, at.x - capsule.radius);
      window.right = std::max(window.right, at.x + capsule.radius);
      window.top = std::max(window.top, at.y + capsule.radius);
    }
  };
  for (const PoseRow& row : rows) {
    if (row.poses.empty() || row.scene.capsules.empty()) continue;
    take_in(row.scene.capsules.back(), row.poses.front());
    for (const std::vector<Frame>* frames : {&row.poses, &row.motion})
      for (const Frame& pose : *frames)
        for (std::size_t i = 0; i + 1 < row.scene.capsules.size(); ++i) take_in(row.scene.capsules[i], pose);
  }
  window.left -= margin;
  window.right += margin;
  window.top += margin;
  return window;
}

/// Maps a panel's metres to the picture.
struct Panel {
  double x = 0, ground = 0;  ///< Pixels of the window's left end and of y = 0.
  double scale = 1;          ///< Scale in pixels per metre.
  Window window;

  std::string across(double metres) const { return short_number(x + scale * (metres - window.left), 6); }
  std::string up(double metres) const { return short_number(ground - scale * metres, 6); }
  std::string length(double metres) const { return short_number(scale * metres, 5); }
};

std::string text_at(const std::string& x, double y, const char* anchor, const std::string& text, int size) {
  return "<text x=\"" + x + "\" y=\"" + short_number(y, 6) + "\" text-anchor=\"" + anchor +
         "\" font-size=\"" + std::to_string(size) + "\">" + escape_html(text) + "</text>\n";
}

/// Draws a limb with a pale edge, so that limbs in front of one another can be told apart.
std::string draw_limb(const Panel& panel, const Capsule& capsule, const Frame& pose, bool near) {
  const Vec3 a = place_of(capsule.a, pose.positions), b = place_of(capsule.b, pose.positions);
  const double thickness = 2 * panel.scale * capsule.radius;
  const auto line = [&](const char* kind, const char* color, double width_px) {
    return std::string("<line class=\"") + kind + "\" x1=\"" + panel.across(a.x) + "\" y1=\"" +
           panel.up(a.y) + "\" x2=\"" + panel.across(b.x) + "\" y2=\"" + panel.up(b.y) + "\" stroke=\"" +
           color + "\" stroke-width=\"" + short_number(width_px, 5) + "\"/>\n";
  };
  return line("edge", "#fff", thickness + 0.8) + line("limb", near ? near_color : far_color, thickness - 0.8);
}

double depth_of(const Capsule& capsule, std::span<const Vec3> positions) {
  return place_of(capsule.a, positions).z + place_of(capsule.b, positions).z;
}

/// Says of each capsule whether it is on the near side while the figure stands.
std::vector<bool> near_capsules(const Scene& scene) {
  std::vector<Vec3> standing;
  for (const Particle& particle : scene.particles) standing.push_back(particle.position);
  std::vector<bool> out;
  for (const Capsule& capsule : scene.capsules) out.push_back(depth_of(capsule, standing) >= -0.02);
  return out;
}

/// Draws the figure's limbs from the farthest to the nearest. Limbs that are on the far side while it stands
/// stay pale all the way.
std::string draw_figure(const Panel& panel, const PoseRow& row, const Frame& pose) {
  const std::vector<Capsule>& capsules = row.scene.capsules;
  std::vector<std::size_t> order(capsules.empty() ? 0 : capsules.size() - 1);
  std::iota(order.begin(), order.end(), std::size_t{0});
  // Of two limbs whose depths differ by less than a centimetre, the thicker one is behind.
  const auto key = [&](std::size_t i) {
    return std::pair(std::lround(50 * depth_of(capsules[i], pose.positions)), -capsules[i].radius);
  };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t k) { return key(i) < key(k); });
  const std::vector<bool> is_near = near_capsules(row.scene);
  std::string out;
  for (const std::size_t i : order) out += draw_limb(panel, capsules[i], pose, is_near[i]);
  return out;
}

std::string draw_ball(const Panel& panel, const PoseRow& row, const Frame& pose) {
  if (row.scene.capsules.empty()) return "";
  const Capsule& ball = row.scene.capsules.back();
  const Vec3 at = place_of(ball.a, pose.positions);
  return "<circle class=\"ball\" cx=\"" + panel.across(at.x) + "\" cy=\"" + panel.up(at.y) + "\" r=\"" +
         panel.length(ball.radius) + "\" fill=\"" + ball_color + "\"/>\n";
}

std::string draw_panel(const Panel& panel, const PoseRow& row, const Frame& pose, const std::string& clip) {
  const std::string ground = short_number(panel.ground, 6);
  const std::string start = panel.across(0);
  // A mark on the ground shows where it stood.
  return "<g class=\"pose\" clip-path=\"url(#" + clip + ")\">\n<path d=\"M" +
         panel.across(panel.window.left) + " " + ground + " H" + panel.across(panel.window.right) +
         "\" stroke=\"#777\" stroke-width=\"1.5\"/>\n<path d=\"M" + start + " " + ground +
         " l-4 7 h8 z\" fill=\"#777\"/>\n" + "<g stroke-linecap=\"round\">\n" +
         draw_figure(panel, row, pose) + "</g>\n" + draw_ball(panel, row, pose) + "</g>\n";
}

std::string clip_path(const std::string& id, const Panel& panel, double top) {
  return "<clipPath id=\"" + id + "\"><rect x=\"" + short_number(panel.x, 6) + "\" y=\"" +
         short_number(top, 6) + "\" width=\"" + panel.length(panel.window.width()) + "\" height=\"" +
         short_number(panel.ground + 9 - top, 6) + "\"/></clipPath>\n";
}

}  // namespace

std::string draw_poses(std::span<const PoseRow> rows) {
  std::size_t columns = 1;
  for (const PoseRow& row : rows) columns = std::max(columns, row.poses.size());
  const Window window = window_of(rows);
  const auto n = static_cast<double>(columns);
  const double room = (width - left - right - between * (n - 1)) / n;
  const double scale = std::min(room / window.width(), highest_panel / window.top);
  const double panel_height = scale * window.top;
  const double row_height = title_height + panel_height + below;
  const double height = row_height * static_cast<double>(rows.size());
  std::string out = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + short_number(width) +
                    "\" height=\"" + short_number(height, 6) + "\" viewBox=\"0 0 " + short_number(width) +
                    " " + short_number(height, 6) +
                    "\" font-family=\"sans-serif\" fill=\"#222\">\n"
                    "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n";
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const double top = row_height * static_cast<double>(r);
    out += text_at(short_number(left), top + 17, "start", rows[r].title, 14);
    for (std::size_t c = 0; c < rows[r].poses.size(); ++c) {
      const Frame& pose = rows[r].poses[c];
      const Panel panel{.x = left + static_cast<double>(c) * (room + between),
                        .ground = top + title_height + panel_height,
                        .scale = scale,
                        .window = window};
      const std::string clip = "panel" + std::to_string(r) + "_" + std::to_string(c);
      out += clip_path(clip, panel, top + title_height) + draw_panel(panel, rows[r], pose, clip);
      out += text_at(panel.across((window.left + window.right) / 2), panel.ground + 23, "middle",
                     "t = " + scenes::plain_number(pose.t, 2) + " s", 12);
    }
  }
  return out + "</svg>\n";
}

Replay replay_poses(std::span<const PoseRow> rows, double frame_length) {
  const Window window = window_of(rows);
  Replay out{.frame_length = frame_length, .left = window.left, .right = window.right, .top = window.top};
  for (const PoseRow& row : rows) {
    const std::vector<Capsule>& capsules = row.scene.capsules;
    const std::vector<bool> is_near = near_capsules(row.scene);
    ReplayRun& run = out.runs.emplace_back(ReplayRun{.title = row.title});
    for (std::size_t i = 0; i < capsules.size(); ++i)
      run.lines.push_back({.radius = capsules[i].radius,
                           .look = i + 1 == capsules.size() ? "ball"
                                   : is_near[i]             ? "near"
                                                            : "far"});
    for (const Frame& pose : row.motion) {
      std::vector<Vec3>& ends = run.frames.emplace_back();
      for (const Capsule& capsule : capsules)
        for (const Point* end : {&capsule.a, &capsule.b}) ends.push_back(place_of(*end, pose.positions));
    }
  }
  return out;
}

}  // namespace plumb::tools
