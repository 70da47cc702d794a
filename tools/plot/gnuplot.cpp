#include "plot/gnuplot.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "plumb/error.hpp"
#include "scenes/basics/files.hpp"

extern char** environ;

namespace plumb::tools {
namespace {

/// This makes a new folder under the system's temporary one. It is removed with all its files at the end of
/// the block.
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

/// Runs `gnuplot argument` and sends what it prints to `log`. Returns whether it ran and succeeded.
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

}  // namespace

std::string in_quotes(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("''") : std::string(1, c);
  return out + "'";
}

void require_gnuplot() {
  const ScratchFolder folder;
  if (!run_gnuplot("--version", folder / "log")) {
    throw InputError(
        "gnuplot, which draws the charts, does not run here; tools/setup installs it (gnuplot-nox)");
  }
}

std::string draw_svg(const std::string& title, int width, int height, const std::string& script) {
  const ScratchFolder folder;
  scenes::write_file(folder / "script", "set terminal svg noenhanced size " + std::to_string(width) + "," +
                                            std::to_string(height) +
                                            " font 'sans-serif,13' background 'white'\nset output " +
                                            in_quotes((folder / "svg").string()) + "\n" + script);
  if (!run_gnuplot((folder / "script").string(), folder / "log")) {
    require_gnuplot();
    throw InputError("gnuplot failed to draw '" + title + "': " + scenes::read_file(folder / "log"));
  }
  return scenes::read_file(folder / "svg");
}

}  // namespace plumb::tools
