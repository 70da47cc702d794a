#include "frontier/peers.hpp"

#include "plumb/error.hpp"
#include "scenes/basics/files.hpp"
#include "scenes/basics/numbers.hpp"

namespace plumb::frontier {
namespace {

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> out;
  for (;;) {
    const std::size_t comma = line.find(',');
    out.push_back(line.substr(0, comma));
    if (comma == std::string_view::npos) return out;
    line.remove_prefix(comma + 1);
  }
}

}  // namespace

std::string csv_row(const std::string& scene, const Point& p) {
  std::string row = scene + "," + p.family + "," + p.setting;
  for (const double value :
       {p.ms, p.median_ms, double{1} * p.repetitions, p.position_error, p.stretch, p.energy_drift})
    row += "," + scenes::short_number(value, 9);
  return row + (p.on_front ? ",1\n" : ",0\n");
}

std::vector<PeerPoint> read_points(const std::filesystem::path& file) {
  const std::string text = scenes::read_file(file);
  std::vector<PeerPoint> out;
  std::string_view rest = text;
  for (std::size_t number = 1; !rest.empty(); ++number) {
    const std::size_t end = rest.find('\n');
    const std::string_view line = rest.substr(0, end);
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    const auto refuse = [&](const std::string& reason) {
      throw InputError(file.string() + ", line " + std::to_string(number) + ": " + reason);
    };
    if (number == 1) {
      if (line != csv_header.substr(0, csv_header.size() - 1)) refuse("not the header of such a file");
      continue;
    }
    const std::vector<std::string_view> cells = cells_of(line);
    if (cells.size() != 10) refuse("not ten cells");
    PeerPoint peer{.scene = std::string(cells[0])};
    Point& p = peer.point;
    p.family = cells[1];
    p.setting = cells[2];
    double repetitions = 0;
    double* const numbers[] = {&p.ms,      &p.median_ms,   &repetitions, &p.position_error,
                               &p.stretch, &p.energy_drift};
    for (std::size_t i = 0; i < std::size(numbers); ++i) {
      const auto value = scenes::parse_number<double>(cells[3 + i]);
      if (!value || *value < 0) refuse("'" + std::string(cells[3 + i]) + "' is not a number of 0 or more");
      *numbers[i] = *value;
    }
    if (!(p.ms > 0)) refuse("a time of 0");
    p.repetitions = static_cast<std::uint32_t>(repetitions);
    out.push_back(std::move(peer));
  }
  return out;
}

void add_peers(const std::vector<PeerPoint>& peers, const Problem& problem, std::vector<Point>& points) {
  for (const PeerPoint& peer : peers)
    if (peer.scene == problem.name) points.push_back(peer.point);
  mark_front(points, problem.truth_error);
}

}  // namespace plumb::frontier
