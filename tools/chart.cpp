#include "chart.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "plumb/error.hpp"
#include "scenes/files.hpp"
#include "scenes/numbers.hpp"

extern char** environ;

namespace plumb::tools {
namespace {

/// A folder of our own under the system's, gone at the end of the block.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "plumb-XXXXXX").string();
    if (!::mkdtemp(name.data())) throw InputError("cannot make a folder like " + name);
    path_ = name;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  std::filesystem::path operator/(const char* name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

/// Runs `gnuplot argument` with what it prints sent to `log`; true if it ran and was content.
bool run_gnuplot(std::string argument, const std::filesystem::path& log) {
  std::string program = "gnuplot";
  char* const arguments[] = {program.data(), argument.data(), nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  pid_t child = 0;
  const int error = ::posix_spawnp(&child, program.c_str(), &actions, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  int status = 0;
  return error == 0 && ::waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("''") : std::string(1, c);
  return out + "'";
}

std::string script_for(const Chart& chart, const std::filesystem::path& svg) {
  std::string s =
      "set terminal svg noenhanced size 760,430 font 'sans-serif,13' background 'white'\n"
      "set output " +
      quoted(svg.string()) + "\nset title " + quoted(chart.title) + "\nset xlabel " + quoted(chart.x) +
      "\nset ylabel " + quoted(chart.y) +
      "\nset logscale xy\nset format '%g'\nset grid lc rgb '#dddddd'\nset border 3 lc rgb '#555555'\n"
      "set tics nomirror\nset key outside right top Left reverse samplen 2.5\n";
  std::string plot;
  for (std::size_t i = 0; i < chart.series.size(); ++i) {
    const Series& series = chart.series[i];
    if (series.points.empty()) continue;
    const std::string name = "$data" + std::to_string(i);
    s += name + " << EOD\n";
    for (const auto& [x, y] : series.points) {
      scenes::append_exact(s, x);
      s += ' ';
      scenes::append_exact(s, y);
      s += '\n';
    }
    s += "EOD\n";
    plot += (plot.empty() ? "plot " : ", ");
    plot += name + " using 1:2 with linespoints title " + quoted(series.name) + " lc rgb " +
            quoted(series.color) + (series.dashed ? " dt 2 pt 7" : " dt 1 pt 7") + " lw 2 ps 0.5";
  }
  return s + (plot.empty() ? "set label 'no data' at graph 0.5,0.5\nplot [1:10] [1:10] NaN notitle" : plot) +
         "\n";
}

}  // namespace

void require_gnuplot() {
  const ScratchFolder folder;
  if (!run_gnuplot("--version", folder / "log")) {
    throw InputError(
        "gnuplot, which draws the charts, does not run here; tools/setup installs it (gnuplot-nox)");
  }
}

std::string draw_svg(const Chart& chart) {
  const ScratchFolder folder;
  scenes::write_file(folder / "script", script_for(chart, folder / "svg"));
  if (!run_gnuplot((folder / "script").string(), folder / "log")) {
    require_gnuplot();
    throw InputError("gnuplot failed to draw '" + chart.title + "': " + scenes::read_file(folder / "log"));
  }
  return scenes::read_file(folder / "svg");
}

}  // namespace plumb::tools
