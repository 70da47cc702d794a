// bench_hinges: run time against error of a figure of 21 hinges alone in the air, plumb beside MuJoCo.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

#include "plot/table.hpp"
#include "run.hpp"
#include "scenes/basics/numbers.hpp"
#include "scenes/runs/machine.hpp"
#include "support/flags.hpp"
#include "support/output.hpp"
#include "support/run_main.hpp"
#include "support/sheet.hpp"
#include "support/statistics.hpp"

namespace plumb::bench {
namespace {

constexpr const char* usage =
    "usage: bench_hinges [--repeat N] [--quick] [--out FILE]\n"
    "\n"
    "Run time against error of a figure of 22 bodies and 21 hinges that tumbles in the air for two seconds:\n"
    "plumb and MuJoCo side by side, one thread, double precision.\n"
    "\n"
    "  --repeat N   runs of every setting, in turns [5]\n"
    "  --quick      every fourth setting only\n"
    "  --out FILE   all points as CSV\n"
    "\n"
    "First both must come to the same end by small steps. The exit status is 1 if they do not.\n";

const double targets[] = {1e-2, 1e-3, 1e-4, 3.6e-5, 1e-5, 1e-6, 1e-7, 1e-8};
/// m, by which the two truths may differ at most: RMS over centres of mass.
constexpr double alike = 1e-9;

struct Error {
  double rms = 0, most = 0;  ///< m, over centres of mass
};

Error error_of(const std::vector<Vec3>& of, const std::vector<Vec3>& truth) {
  double sum = 0, most = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Vec3 apart = of[i] - truth[i];
    sum += dot(apart, apart);
    most = std::max(most, dot(apart, apart));
  }
  return {std::sqrt(sum / static_cast<double>(truth.size())), std::sqrt(most)};
}

struct Measured {
  Setting setting{};
  Error error{};
  std::vector<double> ms{};
};

/// `first`, then ever finer by about `factor`, up to `last`.
std::vector<std::uint32_t> counts(double first, double last, double factor) {
  std::vector<std::uint32_t> out;
  for (double count = first; count < 1.01 * last; count *= factor)
    out.push_back(static_cast<std::uint32_t>(std::lround(count)));
  return out;
}

void append_plumb(std::vector<Setting>& out, const std::string& name, const Scene& scene) {
  for (const std::uint32_t order : {2u, 4u, 6u})
    for (const std::uint32_t steps :
         counts(order == 2 ? 60 : 20, order == 2 ? 6000 : 600, std::pow(10, 0.125)))
      out.push_back({name + " order " + std::to_string(order), std::to_string(steps) + " steps",
                     [=] { return run_plumb(scene, order, steps); }});
  for (const double accuracy : {1e-2, 1e-3, 1e-4, 3e-5, 1e-5, 3e-6, 1e-6, 1e-7, 1e-8})
    out.push_back({name + " auto", "accuracy " + scenes::short_number(accuracy),
                   [=] { return run_plumb_to_accuracy(scene, accuracy); }});
}

std::vector<Setting> all_settings(const std::vector<Limb>& limbs) {
  std::vector<Setting> out;
  for (const std::string integrator : {"Euler", "implicit", "RK4"})
    for (const std::uint32_t steps : counts(200, 20000, std::pow(10, integrator == "RK4" ? 1 / 24.0 : 0.125)))
      out.push_back({"MuJoCo " + integrator, std::to_string(steps) + " steps",
                     [=, &limbs] { return run_mujoco(limbs, integrator, steps); }});
  append_plumb(out, "plumb", scene_of(limbs));
  append_plumb(out, "plumb shared", shared_scene_of(limbs));
  return out;
}

void time_in_turns(std::vector<Measured>& all, std::uint32_t rounds, const std::vector<Vec3>& truth) {
  for (std::uint32_t round = 0; round < rounds; ++round)
    for (std::size_t k = 0; k < all.size(); ++k) {
      Measured& each = all[(k + round) % all.size()];
      const Outcome outcome = each.setting.run();
      each.ms.push_back(outcome.ms);
      each.error = error_of(outcome.centers, truth);
    }
}

tools::Table target_table(const std::vector<Measured>& all) {
  tools::Table table({"error at most (m)", "program", "setting", "RMS", "largest", "ms", "median"});
  std::vector<std::string> families;
  for (const Measured& each : all)
    if (families.empty() || families.back() != each.setting.family) families.push_back(each.setting.family);
  for (const double target : targets)
    for (const std::string& family : families) {
      const Measured* best = nullptr;
      for (const Measured& each : all)
        if (each.setting.family == family && each.error.rms <= target &&
            (!best || least(each.ms) < least(best->ms)))
          best = &each;
      if (best)
        table.add_row({scenes::short_number(target), family, best->setting.name,
                       scenes::short_number(best->error.rms, 2), scenes::short_number(best->error.most, 2),
                       scenes::plain_number(least(best->ms)), scenes::plain_number(median(best->ms))});
    }
  return table;
}

std::string csv_of(const std::vector<Measured>& all) {
  Sheet sheet({"family", "setting", "rms_error_m", "max_error_m", "ms", "median_ms", "repetitions"});
  for (const Measured& each : all)
    sheet.add_row({each.setting.family, each.setting.name, scenes::short_number(each.error.rms),
                   scenes::short_number(each.error.most), scenes::short_number(least(each.ms)),
                   scenes::short_number(median(each.ms)), std::to_string(each.ms.size())});
  return sheet.to_csv();
}

int run(int argc, char** argv) {
  Flags flags(argc, argv);
  if (flags.take("--help") || flags.take("-h")) {
    std::fputs(usage, stdout);
    return 0;
  }
  const std::uint32_t rounds = flags.take_count("--repeat", 5, 1);
  const bool quick = flags.take("--quick");
  auto out = open_output(flags.take_value("--out").value_or(""));
  if (flags.rest().size() > 1)
    throw std::invalid_argument("unknown: " + flags.rest()[1] + "; see bench_hinges --help");

  const std::vector<Limb> limbs = make_figure();
  const std::vector<Vec3> truth = run_plumb(scene_of(limbs), 6, 2000).centers;
  const Error apart = error_of(run_mujoco(limbs, "RK4", 200'000).centers, truth);
  const Error shared = error_of(run_plumb(shared_scene_of(limbs), 6, 2000).centers, truth);
  std::printf("%s; one thread, MuJoCo %s. ms of stepping for %g s.\n", scenes::describe_machine().cpu.c_str(),
              mujoco_version().c_str(), duration);
  std::printf("By small steps both come to the same end but for %.1e m (RMS), %.1e m (largest).\n", apart.rms,
              apart.most);
  std::printf("The two figures of plumb differ by %.1e m (RMS), %.1e m (largest).\n\n", shared.rms,
              shared.most);
  if (!(apart.rms <= alike && shared.rms <= alike)) {
    std::fprintf(stderr, "bench_hinges: the two are not the same figure\n");
    return 1;
  }
  std::vector<Measured> all;
  std::size_t number = 0;
  for (Setting& setting : all_settings(limbs))
    if (number++ % 4 == 0 || !quick) all.push_back({std::move(setting)});
  time_in_turns(all, rounds, truth);
  std::fputs(target_table(all).to_text().c_str(), stdout);
  finish_output(out, csv_of(all));
  return 0;
}

}  // namespace
}  // namespace plumb::bench

int main(int argc, char** argv) {
  return plumb::bench::run_main("bench_hinges", plumb::bench::run, argc, argv);
}
