#include "scenes/files/trajectory.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "plumb/error.hpp"
#include "scenes/basics/files.hpp"
#include "scenes/basics/numbers.hpp"

namespace plumb::scenes {
namespace {

constexpr std::size_t columns = 8;
constexpr std::size_t tension_columns = 3;

/// Walks the lines of a text without copying it, and names the present one in errors.
class Lines {
 public:
  Lines(std::string_view text, std::string_view name) : rest_(text), name_(name) {}

  bool next(std::string_view& line) {
    if (rest_.empty()) return false;
    ++number_;
    const std::size_t end = rest_.find('\n');
    line = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    if (line.ends_with('\r')) line.remove_suffix(1);
    return true;
  }

  [[noreturn]] void refuse(const std::string& reason) const {
    throw InputError(std::string(name_) + ":" + std::to_string(number_) + ": " + reason);
  }

 private:
  std::string_view rest_;
  std::string_view name_;
  std::size_t number_ = 0;
};

struct Row {
  double t;
  std::uint32_t particle;
  Vec3 position;
  Vec3 velocity;
};

template <std::size_t wanted>
std::array<std::string_view, wanted> cells_of(std::string_view line, const Lines& lines) {
  std::array<std::string_view, wanted> cells;
  std::size_t count = 0;
  for (std::size_t start = 0; start <= line.size(); ++count) {
    const std::size_t end = std::min(line.find(',', start), line.size());
    if (count < wanted) cells[count] = line.substr(start, end - start);
    start = end + 1;
  }
  if (count != wanted)
    lines.refuse("expected " + std::to_string(wanted) + " values, found " + std::to_string(count));
  return cells;
}

double number_in(std::string_view cell, const Lines& lines) {
  const auto value = parse_number<double>(cell);
  if (!value) lines.refuse("'" + std::string(cell) + "' is not a finite number");
  return *value;
}

std::uint32_t count_in(std::string_view cell, const char* what, const Lines& lines) {
  const auto value = parse_number<std::uint32_t>(cell);
  if (!value) lines.refuse("'" + std::string(cell) + "' is not the number of a " + what);
  return *value;
}

Row parse_row(std::string_view line, const Lines& lines) {
  const auto cells = cells_of<columns>(line, lines);
  const auto number = [&](std::size_t i) { return number_in(cells[i], lines); };
  const std::uint32_t particle = count_in(cells[1], "particle", lines);
  return {number(0), particle, {number(2), number(3), number(4)}, {number(5), number(6), number(7)}};
}

void require_complete(const std::vector<Frame>& frames, const Lines& lines) {
  const Frame& last = frames.back();
  if (last.positions.size() == frames.front().positions.size()) return;
  lines.refuse("time " + short_number(last.t, 17) + " has " + std::to_string(last.positions.size()) +
               " particles, the first time has " + std::to_string(frames.front().positions.size()));
}

}  // namespace

void append_frame(std::string& csv, const Frame& frame) {
  for (std::size_t i = 0; i < frame.positions.size(); ++i) {
    append_exact(csv, frame.t);
    csv += ',';
    csv += std::to_string(i);
    for (const Vec3& v : {frame.positions[i], frame.velocities[i]}) {
      for (const double value : {v.x, v.y, v.z}) {
        csv += ',';
        append_exact(csv, value);
      }
    }
    csv += '\n';
  }
}

void append_tensions(std::string& csv, const Frame& frame) {
  for (std::size_t i = 0; i < frame.tensions.size(); ++i) {
    append_exact(csv, frame.t);
    csv += ',' + std::to_string(i) + ',';
    if (std::isfinite(frame.tensions[i])) append_exact(csv, frame.tensions[i]);
    csv += '\n';
  }
}

std::string format_trajectory(std::span<const Frame> frames) {
  std::string csv(trajectory_header);
  for (const Frame& frame : frames) append_frame(csv, frame);
  return csv;
}

std::vector<Frame> parse_trajectory(std::string_view csv, std::string_view name) {
  Lines lines(csv, name);
  std::string_view line;
  const std::string_view header = trajectory_header.substr(0, trajectory_header.size() - 1);
  if (!lines.next(line) || line != header) {
    lines.refuse("the first line must be " + std::string(header));
  }
  std::vector<Frame> frames;
  while (lines.next(line)) {
    const Row row = parse_row(line, lines);
    if (frames.empty() || row.t != frames.back().t) {
      if (!frames.empty()) {
        if (row.t < frames.back().t) lines.refuse("times must rise");
        require_complete(frames, lines);
      }
      frames.push_back({.t = row.t, .positions = {}, .velocities = {}});
    }
    Frame& frame = frames.back();
    if (row.particle != frame.positions.size()) {
      lines.refuse("expected particle " + std::to_string(frame.positions.size()) + ", found " +
                   std::to_string(row.particle));
    }
    frame.positions.push_back(row.position);
    frame.velocities.push_back(row.velocity);
  }
  if (frames.empty()) lines.refuse("no rows follow the header");
  require_complete(frames, lines);
  return frames;
}

void parse_tensions(std::string_view csv, std::string_view name, std::vector<Frame>& frames) {
  Lines lines(csv, name);
  std::string_view line;
  const std::string_view header = tensions_header.substr(0, tensions_header.size() - 1);
  if (!lines.next(line) || line != header) lines.refuse("the first line must be " + std::string(header));
  while (lines.next(line)) {
    const auto cells = cells_of<tension_columns>(line, lines);
    const double t = number_in(cells[0], lines);
    const auto frame =
        std::find_if(frames.begin(), frames.end(), [&](const Frame& each) { return each.t == t; });
    if (frame == frames.end()) lines.refuse("no positions are known at this time");
    if (count_in(cells[1], "rod", lines) != frame->tensions.size())
      lines.refuse("expected rod " + std::to_string(frame->tensions.size()) + ", found " +
                   std::string(cells[1]));
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    frame->tensions.push_back(cells[2].empty() ? unknown : number_in(cells[2], lines));
  }
}

void read_tensions(const std::filesystem::path& path, std::vector<Frame>& frames) {
  parse_tensions(read_file(path), path.string(), frames);
}

std::vector<Frame> read_trajectory(const std::filesystem::path& path) {
  return parse_trajectory(read_file(path), path.string());
}

PositionError position_error(const Frame& frame, const Frame& truth, double diagonal) {
  const double rms = rms_distance(frame.positions, truth.positions);
  return {.t = truth.t, .rms_m = rms, .relative = rms / diagonal};
}

TensionError tension_error(const Frame& frame, const Frame& truth) {
  double squares = 0, of_truth = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < frame.tensions.size() && i < truth.tensions.size(); ++i) {
    const double off = frame.tensions[i] - truth.tensions[i];
    if (!std::isfinite(off)) continue;
    squares += off * off;
    of_truth += truth.tensions[i] * truth.tensions[i];
    ++count;
  }
  const double rms = std::sqrt(squares / static_cast<double>(count));
  return {.t = truth.t, .rms_n = rms, .relative = std::sqrt(squares / of_truth)};
}

}  // namespace plumb::scenes
