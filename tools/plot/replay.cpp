#include "plot/replay.hpp"

#include <algorithm>
#include <cmath>

#include "player.hpp"
#include "scenes/basics/json.hpp"

namespace plumb::tools {
namespace {

/// A page needs no more than millimetres. What left the world, or is no number, is out of sight there.
long millimetres(double metres) {
  constexpr double farthest = 1e9;
  return std::isnan(metres) ? 0 : std::lround(std::clamp(1e3 * metres, -farthest, farthest));
}

/// Returns what changed since the frame before: most numbers are small then, and so is the page.
scenes::Json frames_json(const std::vector<std::vector<Vec3>>& frames) {
  scenes::Json out = scenes::Json::array();
  std::vector<long> before;
  for (const std::vector<Vec3>& frame : frames) {
    std::vector<long> now, change;
    for (const Vec3 end : frame)
      for (const double along : {end.x, end.y, end.z}) now.push_back(millimetres(along));
    before.resize(now.size());
    for (std::size_t i = 0; i < now.size(); ++i) change.push_back(now[i] - before[i]);
    out.push_back(scenes::Json::array_of(change));
    before = std::move(now);
  }
  return out;
}

scenes::Json run_json(const ReplayRun& run) {
  scenes::Json lines = scenes::Json::array();
  for (const ReplayLine& line : run.lines)
    lines.push_back({{"radius", line.radius}, {"look", std::string(line.look)}});
  return {{"title", run.title}, {"lines", lines}, {"frames", frames_json(run.frames)}};
}

}  // namespace

std::string replay_data(const Replay& replay) {
  scenes::Json runs = scenes::Json::array();
  for (const ReplayRun& run : replay.runs) runs.push_back(run_json(run));
  const scenes::Json json{{"frame_length", replay.frame_length},
                          {"left", replay.left},
                          {"right", replay.right},
                          {"top", replay.top},
                          {"runs", runs}};
  std::string text = json.dump();
  // No title may end the element that it stands in.
  for (std::size_t at = text.find('<'); at != text.npos; at = text.find('<', at))
    text.replace(at, 1, "\\u003c");
  return "<script type=\"application/json\" class=\"replay\">" + text + "</script>\n";
}

std::string replay_player() {
  return "<script>\n" + std::string(player_script) + "</script>\n";
}

}  // namespace plumb::tools
