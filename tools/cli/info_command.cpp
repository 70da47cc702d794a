// plumb info shows what a scene holds and how a world lays it out.
#include <algorithm>
#include <cstdio>
#include <limits>
#include <memory>
#include <optional>

#include "cli/commands.hpp"
#include "cli/options.hpp"
#include "cli/run_summary.hpp"
#include "plot/table.hpp"
#include "plumb/error.hpp"
#include "plumb/world.hpp"
#include "scenes/basics/files.hpp"
#include "scenes/basics/json.hpp"
#include "scenes/basics/numbers.hpp"
#include "scenes/files/scene_file.hpp"
#include "scenes/runs/report.hpp"
#include "scenes/spec.hpp"

namespace plumb::tools {
namespace {

using scenes::short_number;

struct InfoOptions {
  std::string scene;
  Settings settings{.method = Method::relax};
  std::string report;
  std::string write;
};

struct SceneFacts {
  std::uint64_t fixed = 0;
  double least_mass = std::numeric_limits<double>::infinity();  ///< Least mass of movable particles, in kg.
  double most_mass = 0;
};

SceneFacts facts_of(const Scene& scene) {
  SceneFacts facts;
  const std::vector<double> masses = lumped_masses(scene);
  for (std::size_t i = 0; i < masses.size(); ++i) {
    if (scene.particles[i].fixed) {
      ++facts.fixed;
      continue;
    }
    facts.least_mass = std::min(facts.least_mass, masses[i]);
    facts.most_mass = std::max(facts.most_mass, masses[i]);
  }
  return facts;
}

/// Prints the blocks of rods that are relaxed.
void print_blocks(const WorldInfo& info) {
  std::printf("\n");
  Table table(
      {"shape", "layout", "islands", "particles", "rods", "colours", "bytes", "bytes/projection", "uniform"});
  for (const BlockInfo& b : info.blocks) {
    table.add_row({b.shape, b.layout, std::to_string(b.islands), std::to_string(b.particles),
                   std::to_string(b.rods), std::to_string(b.colors), std::to_string(b.bytes),
                   short_number(b.bytes_per_projection, 3),
                   short_number(100 * b.uniform_fraction, 4) + " %"});
  }
  std::fputs(table.to_text().c_str(), stdout);
}

void print_info(const InfoOptions& options, const Scene& scene, const SceneFacts& facts,
                const WorldInfo& info) {
  std::printf("scene      %s\n", options.scene.c_str());
  std::printf("particles  %u, %llu of them fixed\n", info.particles,
              static_cast<unsigned long long>(facts.fixed));
  std::printf("rods       %u\n", info.rods);
  std::printf("islands    %u\n", info.islands);
  if (facts.most_mass > 0) {
    std::printf("masses     %s to %s kg\n", short_number(facts.least_mass).c_str(),
                short_number(facts.most_mass).c_str());
  }
  if (const std::string strain = start_text(scene); !strain.empty())
    std::printf("start      %s\n", strain.c_str());
  if (const std::string shapeless = shapeless_text(scene); !shapeless.empty())
    std::printf("shapes     %s\n", shapeless.c_str());
  std::printf("diagonal   %s m\n", short_number(bounding_diagonal(scene)).c_str());
  std::printf("memory     %s MB of arrays\n",
              short_number(1e-6 * static_cast<double>(info.memory), 3).c_str());
  std::printf("threads    %u, %s\n", info.threads,
              info.parallel ? "used" : "not used: the scene is too small to win");
  std::printf("isa       ");
  for (const Isa isa : all_isas()) {
    if (!is_supported(isa)) continue;
    std::printf(" %s%s", std::string(to_string(isa)).c_str(), isa == best_isa() ? " (best)" : "");
  }
  std::printf("; used: %s\n", std::string(to_string(info.isa)).c_str());
  if (!info.blocks.empty()) print_blocks(info);
}

/// Returns the methods that may move the scene. Those that move no joints are left out where it has some.
std::vector<MethodInfo> methods_for(const Scene& scene) {
  std::vector<MethodInfo> out = all_methods();
  if (has_more_than_rods(scene)) std::erase_if(out, [](const MethodInfo& m) { return !m.moves_joints; });
  return out;
}

void print_methods(const Scene& scene, const WorldInfo& picked) {
  std::printf("\n%s\nmethod %s solves %u rods directly and relaxes %u\n",
              methods_help(methods_for(scene)).c_str(), std::string(to_string(Method::automatic)).c_str(),
              picked.direct_rods, picked.relaxed_rods);
}

scenes::Json methods_json(const Scene& scene) {
  scenes::Json list = scenes::Json::array();
  for (const MethodInfo& method : methods_for(scene))
    list.push_back(
        {{"method", method.name}, {"moves", method.moves}, {"reads", scenes::Json::array_of(method.reads)}});
  return list;
}

int info(const InfoOptions& options) {
  const Scene scene = scenes::load_scene(options.scene);
  if (has_more_than_rods(scene) && options.settings.layout != LayoutChoice::automatic)
    throw InputError("--layout: nothing reads it: this scene has more than particles and rods");
  std::optional<scenes::OutputFile> report;
  std::optional<scenes::OutputFile> file;
  if (!options.report.empty()) report.emplace(options.report);
  if (!options.write.empty()) file.emplace(options.write);
  Settings automatic = options.settings;
  automatic.method = Method::automatic;
  automatic.layout = LayoutChoice::automatic;
  // The layouts are those of relaxation, which knows no bodies, joints or shapes.
  const World world(scene, has_more_than_rods(scene) ? automatic : options.settings);
  const SceneFacts facts = facts_of(scene);
  if (report) {
    scenes::Json json{{"scene", options.scene}};
    json["fixed"] = facts.fixed;
    json["mass"] =
        facts.most_mass > 0 ? scenes::Json::array_of({facts.least_mass, facts.most_mass}) : nullptr;
    json["diagonal"] = bounding_diagonal(scene);
    json["world"] = scenes::world_json(world.info());
    json["methods"] = methods_json(scene);
    json["machine"] = scenes::machine_json(scenes::describe_machine(world.info()));
    report->write(scenes::format_json(json));
    report->commit();
  }
  if (file) {
    file->write(scenes::format_scene(scene));
    file->commit();
  }
  print_info(options, scene, facts, world.info());
  print_methods(scene, World(scene, automatic).info());
  return fine;
}

}  // namespace

void add_info_command(Command& plumb) {
  Command command = plumb.add_command("info", "Show what a scene holds and how it is laid out");
  auto options = std::make_shared<InfoOptions>();
  add_scene(command, options->scene);
  add_layout_options(command, options->settings);
  command.add_option("--report", "OUT.json", options->report, "Write the same as JSON to this file");
  command.add_option("--write", "SCENE.json", options->write, "Write the scene to this file");
  command.set_footer([options] {
    return "Examples:\n"
           "  plumb info ensemble --precision float\n"
           "  plumb info net:width=8,height=8 --write net.json\n\n" +
           generators_help(options->scene);
  });
  command.set_action([options] { return info(*options); });
}

}  // namespace plumb::tools
