// plumb view shows a scene live in a browser, or writes the page that does so as a file.
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <memory>

#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "plot/page.hpp"
#include "plumb/error.hpp"
#include "scenes/basics/files.hpp"
#include "scenes/spec.hpp"
#include "view/export/export.hpp"
#include "view/inputs/replay.hpp"
#include "view/server/server.hpp"

namespace plumb::tools {
namespace {

/// A rope of twenty links at a slant, whose end weighs ten times a link's: nothing shows so plainly what
/// weights do.
constexpr const char* heavy_rope = "winch:rods=19,cable=0.1,length=0.1,mass=1,load=10";

struct ViewOptions {
  std::string scene, compared, replay, folder;
  Settings settings{};
  unsigned port = 0;
  bool opens = false;
};

view::Start start_of(const ViewOptions& options) {
  const std::string name = options.scene.empty() ? heavy_rope : options.scene;
  view::Start start{.name = name, .scene = scenes::load_scene(name)};
  if (!options.compared.empty() || options.scene.empty())
    start.sides =
        (options.compared.empty() ? view::comparisons().front() : view::comparison(options.compared)).sides;
  else
    start.sides = {{std::string(to_string(options.settings.method)), options.settings}};
  return start;
}

void open_browser(const std::string& address) {
  const pid_t child = ::fork();
  if (child == 0) {
    ::execlp("xdg-open", "xdg-open", address.c_str(), nullptr);
    ::_exit(127);
  }
  int status = 0;
  if (child < 0 || ::waitpid(child, &status, 0) < 0 || status != 0)
    std::fprintf(stderr, "plumb: no browser could be opened; open the address yourself\n");
}

/// Writes the page into a folder.
int write_page(const ViewOptions& options) {
  const std::filesystem::path folder = options.folder;
  const std::string worker =
      scenes::read_file(view::find_worker(std::filesystem::read_symlink("/proc/self/exe")));
  std::string start;
  if (options.replay.empty()) {
    start = view::format_replay(view::Exhibit(start_of(options)));
  } else {
    start = scenes::read_file(options.replay);
    view::Exhibit(view::parse_replay(start, options.replay).start);  // refuses what the page could not show
  }
  make_folder(folder);
  scenes::write_file(folder / "index.html", view::exported_page(view::page_files(), worker, start));
  std::printf("%s\n", (folder / "index.html").c_str());
  return fine;
}

int run(const ViewOptions& options) {
  if (!options.folder.empty()) return write_page(options);
  std::optional<view::Replay> replay;
  if (!options.replay.empty()) replay = view::parse_replay(scenes::read_file(options.replay), options.replay);
  view::Server server(view::Exhibit(replay ? replay->start : start_of(options)), options.port, replay);
  std::printf("%s\n", server.address().c_str());
  std::fflush(stdout);
  std::fprintf(stderr, "plumb: open this address in a browser on this machine; Ctrl-C ends\n");
  if (options.opens) open_browser(server.address());
  server.run(true);
  return fine;
}

}  // namespace

void add_view_command(Command& plumb) {
  Command command = plumb.add_command("view", "Show a scene live in a browser; compare worlds, pull, cut");
  auto options = std::make_shared<ViewOptions>();
  ViewOptions& o = *options;
  const Option scene = command.add_option(
      "SCENE", "", o.scene, "A scene file (.json) or a generator; without it a rope with a heavy end");
  std::vector<std::string> names;
  for (const view::Comparison& each : view::comparisons()) names.push_back(each.name);
  add_words(
      command, "--compare", names, [&o](const std::string& name) { o.compared = name; },
      "Worlds that start alike and are shown together");
  add_solver_options(command, o.settings);
  add_layout_options(command, o.settings);
  const Option port =
      add_count(command, "--port", o.port, "Port on 127.0.0.1; 0: one that is free [0]", {.most = 65535});
  const Option open = command.add_flag("--open", o.opens, "Open the address in the default browser");
  const Option replay = command.add_option("--replay", "FILE", o.replay, "Repeat what a page saved");
  replay.excludes(scene);
  const Option folder = command.add_option("--export", "DIR", o.folder,
                                           "Write the page into this folder instead, as one file that needs "
                                           "no server: worlds run in WebAssembly, whose "
                                           "compiler `tools/setup --ports` installs");
  folder.excludes(port);
  folder.excludes(open);
  command.set_footer([options] {
    return "Examples:\n"
           "  plumb view\n"
           "  plumb view net:width=24,height=24 --method relax --sweeps 20\n"
           "  plumb view rope --compare 'relax against direct'\n"
           "  plumb view --replay replay.json\n"
           "  plumb view --export page humanoid\n\n" +
           methods_help() + "\n" + generators_help(options->scene);
  });
  command.set_action([options] { return run(*options); });
}

}  // namespace plumb::tools
