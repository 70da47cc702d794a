// bench_ropes: ropes that fall on ground of triangles and on each other until they sleep, plumb beside
// Bullet.
#include <LinearMath/btScalar.h>

#include <chrono>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

#include "measure.hpp"
#include "plot/table.hpp"
#include "scenes/basics/numbers.hpp"
#include "scenes/runs/machine.hpp"
#include "scenes/spec.hpp"
#include "support/flags.hpp"
#include "support/output.hpp"
#include "support/run_main.hpp"
#include "support/sheet.hpp"
#include "support/statistics.hpp"

namespace plumb::bench {
namespace {

constexpr const char* usage =
    "usage: bench_ropes [--scene SPEC] [--seconds S] [--threads N] [--only WORD] [--quick] [--out FILE]\n"
    "\n"
    "Ropes fall on ground of triangles and on each other until they sleep: plumb beside Bullet's capsules "
    "on\n"
    "ball joints, each by frames of 1/60 s.\n"
    "\n"
    "  --scene SPEC   ropes on one mesh [terrain:ropes=1000,triangles=10000]\n"
    "  --seconds S    simulated time, at most [10]\n"
    "  --threads N    of plumb [1]; Bullet has one\n"
    "  --only WORD    settings whose program and name contain it\n"
    "  --quick        a scene of 16 ropes, for a second\n"
    "  --out FILE     all rows as CSV\n";

struct Run {
  std::vector<double> ms{};           ///< by frame
  std::uint32_t awake = 0;            ///< ropes at the end
  double strain = 0, end_strain = 0;  ///< the largest ever and at the end
  Depths most{}, last{};
};

Run run_setting(const Setting& setting, const Scene& scene, std::uint32_t frames) {
  using Clock = std::chrono::steady_clock;
  const std::unique_ptr<Faller> faller = setting.start(scene);
  DepthMeter meter(scene);
  std::vector<Vec3> positions(scene.particles.size());
  Run out;
  for (std::uint32_t i = 0; i < frames; ++i) {
    const auto before = Clock::now();
    faller->step();
    out.ms.push_back(std::chrono::duration<double, std::milli>(Clock::now() - before).count());
    faller->copy_positions(positions);
    out.last = meter.measure(positions);
    out.end_strain = faller->strain();
    out.strain = std::max(out.strain, out.end_strain);
    out.most = {std::max(out.most.in_ground, out.last.in_ground),
                std::max(out.most.in_ropes, out.last.in_ropes), std::max(out.most.through, out.last.through),
                std::max(out.most.lost, out.last.lost)};
    out.awake = faller->awake();
    if (out.awake == 0) break;
  }
  return out;
}

std::vector<Setting> all_settings(unsigned threads) {
  std::vector<Setting> out;
  for (const auto& [substeps, sweeps] :
       {std::pair{4u, 5u}, {4u, 10u}, {8u, 5u}, {8u, 10u}, {16u, 5u}, {16u, 10u}, {32u, 5u}})
    out.push_back(plumb_relaxed(substeps, sweeps, threads));
  out.push_back(plumb_automatic(threads));
  for (const auto& [steps, iterations] : {std::pair{4u, 10}, {4u, 50}, {8u, 10}, {16u, 10}, {16u, 50}})
    out.push_back(bullet_rods(steps, iterations));
  return out;
}

std::vector<std::string> row_of(const Setting& setting, const Run& run) {
  double sum = 0;
  for (const double each : run.ms) sum += each;
  const auto millimetres = [](double m) { return scenes::short_number(1e3 * m, 3); };
  const auto both = [](const std::string& a, const std::string& b) { return a + " / " + b; };
  return {setting.program,
          setting.name,
          scenes::short_number(static_cast<double>(run.ms.size()) * frame, 3),
          std::to_string(run.awake),
          scenes::short_number(sum / static_cast<double>(run.ms.size()), 4),
          scenes::short_number(*std::max_element(run.ms.begin(), run.ms.end()), 4),
          scenes::short_number(1e-3 * sum, 4),
          both(scenes::short_number(100 * run.strain, 3), scenes::short_number(100 * run.end_strain, 3)),
          both(millimetres(run.most.in_ground), millimetres(run.last.in_ground)),
          both(millimetres(run.most.in_ropes), millimetres(run.last.in_ropes)),
          both(std::to_string(run.most.through), std::to_string(run.last.through)),
          std::to_string(run.last.lost)};
}

int run(int argc, char** argv) {
  Flags flags(argc, argv);
  if (flags.take("--help") || flags.take("-h")) {
    std::fputs(usage, stdout);
    return 0;
  }
  const bool quick = flags.take("--quick");
  const std::string spec = flags.take_value("--scene").value_or(
      quick ? "terrain:ropes=16,stack=16,triangles=200" : "terrain:ropes=1000,triangles=10000");
  const std::uint32_t seconds = flags.take_count("--seconds", quick ? 1 : 10, 1);
  const unsigned threads = flags.take_count("--threads", 1, 1);
  const std::string only = flags.take_value("--only").value_or("");
  auto out = open_output(flags.take_value("--out").value_or(""));
  if (flags.rest().size() > 1)
    throw std::invalid_argument("unknown: " + flags.rest()[1] + "; see bench_ropes --help");

  const Scene scene = scenes::load_scene(spec);
  std::printf("%s; Bullet %d. %s: %zu rods, %zu triangles.\n\n", scenes::describe_machine().cpu.c_str(),
              btGetVersion(), spec.c_str(), scene.rods.size(), scene.meshes.at(0).triangles.size());
  const std::vector<std::string> header{"program",      "setting",     "s",       "awake",
                                        "mean ms",      "worst ms",    "all s",   "strain %, most / last",
                                        "in ground mm", "in ropes mm", "through", "beside"};
  tools::Table table(header);
  Sheet sheet(header);
  for (const Setting& setting : all_settings(threads)) {
    if ((setting.program + " " + setting.name).find(only) == std::string::npos) continue;
    const std::vector<std::string> row = row_of(setting, run_setting(setting, scene, 60 * seconds));
    for (const std::string& cell : row) std::fprintf(stderr, "%s | ", cell.c_str());
    std::fprintf(stderr, "\n");
    table.add_row(row);
    sheet.add_row(row);
  }
  std::fputs(table.to_text().c_str(), stdout);
  finish_output(out, sheet.to_csv());
  return 0;
}

}  // namespace
}  // namespace plumb::bench

int main(int argc, char** argv) {
  return plumb::bench::run_main("bench_ropes", plumb::bench::run, argc, argv);
}
