#include "stability/grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "plumb/error.hpp"
#include "scenes/basics/lists.hpp"
#include "scenes/basics/numbers.hpp"
#include "scenes/basics/require.hpp"

namespace plumb::scenes {
namespace {

constexpr std::uint32_t most_size = 10'000'000;

template <class T>
void require_one_of(const std::vector<T>& values, T value, const char* what) {
  std::string list;
  for (const T v : values) append_item(list, short_number(static_cast<double>(v)));
  if (std::find(values.begin(), values.end(), value) == values.end()) {
    throw InputError("no plane at " + std::string(what) + " " + short_number(static_cast<double>(value)) +
                     ": the grid has " + list);
  }
}

void require_grid(const StabilityGrid& grid) {
  if (grid.methods.empty() || grid.severities.empty() || grid.sizes.empty() || grid.dts.empty())
    throw InputError("the grid is empty");
  for (const double each : grid.severities)
    require_positive(each, is_landing(grid.scene) ? "the speed" : "the end-mass ratio");
  for (const double dt : grid.dts) require_positive(dt, "dt");
  for (const std::uint32_t size : grid.sizes)
    if (size == 0 || size > most_size)
      throw InputError("sizes must be from 1 to " + std::to_string(most_size));
  require_positive(grid.duration, "the duration");
  require_one_of(grid.dts, grid.at_dt, "dt");
  require_one_of(grid.sizes, grid.at_size, "size");
}

}  // namespace

const std::vector<StabilityMethod>& all_stability_methods() {
  static const std::vector<StabilityMethod> list = {
      {"relax-old", Method::relax, Gradient::old},
      {"relax-mid", Method::relax, Gradient::mid},
      {"relax-new", Method::relax, Gradient::new_},
      {"relax-jacobi", Method::relax, Gradient::new_, SweepOrder::jacobi},
      {.name = "springs", .method = Method::springs, .integrator = Integrator::semi_implicit_euler},
      {.name = "springs-implicit", .method = Method::springs, .integrator = Integrator::implicit_euler},
      {"direct-old", Method::direct, Gradient::old},
      {"direct-mid", Method::direct, Gradient::mid},
      {"direct-new", Method::direct, Gradient::new_},
      {"auto", Method::automatic, {}},
  };
  return list;
}

std::vector<StabilityMethod> default_stability_methods() {
  std::vector<StabilityMethod> out = all_stability_methods();
  std::erase_if(out, [](const StabilityMethod& m) { return m.method == Method::automatic; });
  return out;
}

std::vector<StabilityMethod> landing_methods() {
  std::vector<StabilityMethod> out = all_stability_methods();
  std::erase_if(out, [](const StabilityMethod& m) {
    return m.name != "auto" && m.name != "direct-old" && m.name != "relax-new";
  });
  return out;
}

std::string_view to_string(StabilityScene scene) {
  constexpr std::array<std::string_view, 5> names = {"chains", "nets", "ropes", "drapes", "boxes"};
  return names[static_cast<std::size_t>(scene)];
}

bool is_landing(StabilityScene scene) {
  return scene >= StabilityScene::ropes;
}

StabilityGrid default_grid(StabilityScene scene) {
  StabilityGrid grid{.scene = scene};
  if (scene == StabilityScene::nets) {
    grid.severities = {1, 100, 1e4, 1e6};
    grid.sizes = {4, 8, 16, 32};
    grid.dts = {0.003, 0.01, 1.0 / 60, 0.033, 0.1};
    grid.at_size = 8;
  } else if (is_landing(scene)) {
    grid.methods = landing_methods();
    grid.severities = {1, 3, 10, 30, 100};
    grid.at_size = scene == StabilityScene::ropes ? 20 : scene == StabilityScene::drapes ? 8 : 5;
    grid.sizes = {grid.at_size};
    grid.dts = {0.003, 0.01, 1.0 / 60, 0.033, 0.1};
    grid.duration = 1;
  }
  return grid;
}

std::vector<StabilityCase> list_cells(const StabilityGrid& grid) {
  require_grid(grid);
  std::vector<StabilityCase> out;
  for (const StabilityMethod& method : grid.methods) {
    for (const std::uint32_t size : grid.sizes) {
      for (const double dt : grid.dts) {
        if (!grid.full && size != grid.at_size && dt != grid.at_dt) continue;
        const auto frames = static_cast<std::uint64_t>(std::max(1.0, std::round(grid.duration / dt)));
        for (const double each : grid.severities) out.push_back({method, each, size, dt, frames, grid.scene});
      }
    }
  }
  return out;
}

}  // namespace plumb::scenes
