#include "step/methods.hpp"

#include <algorithm>
#include <vector>

#include "relax/relax_solver.hpp"
#include "scene/refuse.hpp"

namespace plumb::detail {
namespace {

constexpr SettingRow settings_table[] = {
    {Reads::precision, "precision", [](const Settings& s) { return s.precision != Precision::double_; }},
    {Reads::gradient, "gradient", [](const Settings& s) { return s.gradient.has_value(); }},
    {Reads::mass, "mass", [](const Settings& s) { return s.mass.has_value(); }},
    {Reads::weights, "weights", [](const Settings& s) { return s.weights != Weights::mass; }},
    {Reads::order, "order", [](const Settings& s) { return s.order != SweepOrder::gauss_seidel; }},
    {Reads::omega, "omega", [](const Settings& s) { return s.omega != 1; }},
    {Reads::time_order, "time order", [](const Settings& s) { return s.time_order != 2; }},
    {Reads::accuracy, "accuracy", [](const Settings& s) { return s.accuracy.has_value(); }},
    // What a tolerance or a budget needs is named before the sweeps that come along with it.
    {Reads::tolerance, "tolerance", [](const Settings& s) { return s.stop.tolerance.has_value(); }},
    {Reads::budget_us, "budget", [](const Settings& s) { return s.stop.budget_us.has_value(); }},
    {Reads::sweeps, "sweeps", [](const Settings& s) { return s.stop.sweeps != StopRule{}.sweeps; }},
    {Reads::integrator, "integrator", [](const Settings& s) { return s.integrator.has_value(); }},
    {Reads::springs, "springs", [](const Settings& s) { return s.springs.model != SpringSettings{}.model; }},
    {Reads::stiffness, "stiffness",
     [](const Settings& s) { return s.springs.stiffness != SpringSettings{}.stiffness; }},
    {Reads::damping_ratio, "damping ratio",
     [](const Settings& s) { return s.springs.damping_ratio != SpringSettings{}.damping_ratio; }},
    {Reads::stabilization, "stabilization",
     [](const Settings& s) { return s.multipliers.stabilization != MultiplierSettings{}.stabilization; }},
    {Reads::baumgarte_rate, "baumgarte rate",
     [](const Settings& s) { return s.multipliers.baumgarte_rate != MultiplierSettings{}.baumgarte_rate; }},
    {Reads::most_work, "most work", [](const Settings& s) { return s.most_work != Settings{}.most_work; }},
    {Reads::sleep, "sleep", [](const Settings& s) { return !s.sleep; }},
    {Reads::sleep_time, "sleep time",
     [](const Settings& s) { return s.sleep_time != Settings{}.sleep_time; }},
    {Reads::contact, "contact", [](const Settings& s) { return s.contact != ContactSettings{}; }},
    {Reads::tensions, "tensions", [](const Settings& s) { return s.tensions; }},
    {Reads::contacts, "contacts", [](const Settings& s) { return s.contacts; }},
    {Reads::layout, "layout", [](const Settings& s) { return s.layout != LayoutChoice::automatic; }},
};

constexpr Reads common_reads =
    Reads::sleep | Reads::sleep_time | Reads::contact | Reads::tensions | Reads::contacts | Reads::most_work;
constexpr Reads stop_rule = Reads::sweeps | Reads::tolerance | Reads::budget_us;
constexpr Reads relax_reads = common_reads | stop_rule | Reads::precision | Reads::gradient | Reads::mass |
                              Reads::weights | Reads::order | Reads::omega | Reads::accuracy | Reads::layout;
constexpr Reads direct_reads =
    common_reads | Reads::precision | Reads::gradient | Reads::mass | Reads::accuracy | Reads::tolerance;

void validate_relax(const Settings& settings) {
  if (settings.mass == MassModel::consistent)
    refuse("mass consistent needs method direct or auto: relaxation moves particles one by one");
}

void validate_direct(const Settings& settings) {
  if (settings.time_order != 2 && gradient_of(settings) != Gradient::old)
    refuse("time order ", settings.time_order, " needs method direct with gradient old");
}

Array<MethodRow>& table() {
  static Array<MethodRow> rows{
      {.method = Method::automatic,
       .name = to_string(Method::automatic),
       .moves = "everything: picks relax or direct for every island",
       .reads = relax_reads | direct_reads,
       .moves_joints = true,
       .moves_laws = true,
       .moves_elements = true},
      {.method = Method::relax,
       .name = to_string(Method::relax),
       .moves = "rods, bodies and their joints, and what touches, one row after the other (thesis 3.2)",
       .reads = relax_reads,
       .moves_joints = true,
       .moves_laws = true,
       .validate = validate_relax,
       .make = make_relax_solvers},
      {.method = Method::direct,
       .name = to_string(Method::direct),
       .moves = "everything: all rods and joints of an island at once",
       .reads = direct_reads | Reads::time_order,
       .moves_joints = true,
       .moves_laws = true,
       .moves_elements = true,
       .validate = validate_direct},
  };
  return rows;
}

}  // namespace

std::span<const SettingRow> setting_rows() {
  return settings_table;
}

std::span<const MethodRow> method_rows() {
  return table();
}

const MethodRow& method_row(Method method) {
  const auto& rows = table();
  const auto row =
      std::find_if(rows.begin(), rows.end(), [&](const MethodRow& each) { return each.method == method; });
  if (row == rows.end())
    refuse("method ", to_string(method),
           " is not part of this program: link plumb::reference and call register_reference_methods()");
  return *row;
}

void register_method(const MethodRow& row) {
  auto& rows = table();
  std::erase_if(rows, [&](const MethodRow& each) { return each.method == row.method; });
  rows.push_back(row);
  std::sort(rows.begin(), rows.end(),
            [](const MethodRow& a, const MethodRow& b) { return a.method < b.method; });
}

}  // namespace plumb::detail

namespace plumb {

std::vector<MethodInfo> all_methods() {
  std::vector<MethodInfo> out;
  for (const detail::MethodRow& row : detail::method_rows()) {
    out.push_back(
        {.method = row.method, .name = row.name, .moves = row.moves, .moves_joints = row.moves_joints});
    for (const detail::SettingRow& setting : detail::setting_rows())
      if (contains(row.reads, setting.id)) out.back().reads.push_back(setting.name);
  }
  return out;
}

}  // namespace plumb
