#include <algorithm>
#include <iterator>
#include <map>
#include <vector>

#include "plot/gnuplot.hpp"
#include "profile/output.hpp"
#include "scenes/basics/numbers.hpp"

namespace plumb::tools {
namespace {

constexpr const char* layouts[] = {"aos", "soa", "aosoa"};
constexpr const char* colors[] = {"#d1495b", "#edae49", "#1f5fa8"};

/// A group holds the bars of a shape and size, with their heights by layout.
struct Group {
  std::string name;
  std::map<std::string, double> height;
};

std::vector<Group> groups_of(const Profile& profile, MissKind kind, SweepOrder order) {
  std::vector<Group> groups;
  for (const ProfileRow& row : profile.rows) {
    const Settings& settings = row.profile_case.plan.settings;
    if (settings.method != Method::relax || settings.order != order) continue;
    const auto& count = kind == MissKind::l1d_read ? row.counts.l1d_read_misses : row.counts.ll_misses;
    if (!count) continue;
    const std::string name =
        row.profile_case.shape + "\\n" + size_name(row.profile_case.size, profile.caches);
    if (groups.empty() || groups.back().name != name) groups.push_back({name, {}});
    groups.back().height[row.layout] = std::max(0.0, *count);
  }
  return groups;
}

}  // namespace

std::string draw_misses(const Profile& profile, MissKind kind, SweepOrder order) {
  const std::vector<Group> groups = groups_of(profile, kind, order);
  if (groups.empty()) return {};
  const bool first = kind == MissKind::l1d_read;
  const std::string title = std::string(first ? "L1D read misses" : "LL misses") + " per projection, " +
                            std::string(to_string(order));
  std::string s = "set title " + in_quotes(title) + "\nset ylabel 'misses'\nset yrange [0:*]\n" +
                  "set style data histograms\nset style histogram clustered gap 1\n"
                  "set style fill solid border -1\nset boxwidth 1\nset border 3 lc rgb '#555555'\n"
                  "set tics nomirror\nset grid y lc rgb '#dddddd'\nset key outside right top Left "
                  "reverse\nset bmargin 4\n"
                  "$data << EOD\n";
  for (const Group& group : groups) {
    s += '"' + group.name + '"';
    for (const char* layout : layouts) {
      const auto it = group.height.find(layout);
      s += ' ';
      if (it == group.height.end()) {
        s += '?';
      } else {
        scenes::append_exact(s, it->second);
      }
    }
    s += '\n';
  }
  s += "EOD\nset datafile missing '?'\nplot ";
  for (std::size_t i = 0; i < std::size(layouts); ++i) {
    if (i > 0) s += ", ";
    s += "$data using " + std::to_string(i + 2) + (i == 0 ? ":xtic(1)" : "") + " title " +
         in_quotes(layouts[i]) + " lc rgb " + in_quotes(colors[i]);
  }
  return draw_svg(title, 1100, 400, s + "\n");
}

}  // namespace plumb::tools
