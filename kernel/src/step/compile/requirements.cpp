#include "step/compile/requirements.hpp"

#include <algorithm>
#include <cmath>

#include "contact/linkage/scene_parts.hpp"
#include "interface/made_solver.hpp"
#include "plumb/error.hpp"
#include "plumb/layouts/memory.hpp"
#include "scene/refuse.hpp"

namespace plumb::detail {
namespace {

/// Joins words as a sentence does.
std::string listed(const Array<std::string>& words) {
  std::string out;
  for (std::size_t i = 0; i < words.size(); ++i)
    out += (i == 0 ? "" : i + 1 == words.size() ? " and " : ", ") + words[i];
  return out;
}

/// Returns whether a body's mass matrix has nothing between its particles.
bool has_point_masses(const Scene& scene, std::size_t body) {
  const auto mass = body_mass(scene, body);
  for (std::size_t j = 0; j < 4; ++j)
    for (std::size_t k = 0; k < j; ++k)
      if (!(std::abs(mass[j][k]) <= 1e-9 * scene.bodies[body].mass)) return false;
  return true;
}

bool has_heavy_bodies(const Scene& island) {
  for (std::size_t i = 0; i < island.bodies.size(); ++i)
    if (!has_point_masses(island, i)) return true;
  return false;
}

/// Lists what makes an island more than particles and rods that may touch, as is_plain() looks for it.
std::string kinds_of_parts(const Scene& island) {
  Array<std::string> out;
  const auto name = [&](bool has, const char* what) {
    if (has) out.emplace_back(what);
  };
  name(!island.bodies.empty(), "bodies");
  name(!island.pins.empty() || !island.alignments.empty() || !island.angles.empty(), "joints");
  name(!island.springs.empty(), "springs");
  name(!island.torsions.empty(), "torsions");
  name(has_air(island), "air on rods");
  name(island.joint_drag != 0, "drag of joints");
  name(std::any_of(island.particles.begin(), island.particles.end(),
                   [](const Particle& each) { return each.asleep && !each.fixed; }),
       "sleepers");
  if (!island.capsules.empty()) {
    name(std::any_of(island.rods.begin(), island.rods.end(),
                     [](const Rod& rod) { return !rod.law.is_rigid(); }),
         "shapes beside rods that give");
    name(!island.bends.empty(), "shapes beside bends");
  }
  name(out.empty(), "shapes that reach beyond their rods");
  return listed(out);
}

/// Returns whether a method moves an island with joints. Those that make solvers of their own are asked by
/// trying: what they refuse depends on more than kinds.
bool moves(const MethodRow& row, const Scene& island, std::span<const std::uint32_t> particles) {
  if (row.method == Method::relax) return !has_air(island) && !has_heavy_bodies(island);
  if (!row.make_jointed) return row.moves_joints;
  if (!island.capsules.empty() || !island.hulls.empty()) return false;
  try {
    StartReport report;
    row.make_jointed(island, particles, {.method = row.method, .threads = 1}, report);
    return true;
  } catch (const InputError&) {
    return false;
  }
}

}  // namespace

std::string methods_that(const std::function<bool(const MethodRow&)>& can) {
  Array<std::string> names;
  for (const MethodRow& row : method_rows())
    if (row.method != Method::automatic && can(row)) names.emplace_back(row.name);
  if (can(method_row(Method::automatic))) names.emplace_back(to_string(Method::automatic));
  return listed(names);
}

void require_springs_moved(const Scene& scene, Method method) {
  const auto moves_springs = [](const MethodRow& row) { return row.moves_joints || row.make_jointed; };
  if (moves_springs(method_row(method))) return;
  const char* const what = !scene.springs.empty() ? "spring" : !scene.torsions.empty() ? "torsion" : "";
  if (*what != 0)
    refuse(what, " 0: method ", to_string(method), " moves no ", what, "s; ", methods_that(moves_springs),
           " do");
}

void require_laws_moved(const Scene& scene, const Settings& settings) {
  const auto moves_laws = [](const MethodRow& row) { return row.moves_laws; };
  const bool moves = moves_laws(method_row(settings.method));
  for (std::size_t i = 0; i < scene.rods.size(); ++i) {
    if (scene.rods[i].law.is_rigid()) continue;
    if (!moves)
      refuse("rod ", i, ": gives, which method ", to_string(settings.method), " cannot move; ",
             methods_that(moves_laws), " can");
    if (settings.time_order > 2 && scene.rods[i].law.damping > 0)
      refuse("rod ", i, ": is damped, which time order ", settings.time_order,
             " cannot move, since it goes backwards in between; 2 can");
  }
}

void require_element_moved(const Settings& settings, const char* kind, std::size_t i, const char* why) {
  const auto moves_elements = [](const MethodRow& row) { return row.moves_elements; };
  if (!moves_elements(method_row(settings.method)))
    refuse(kind, " ", i, ": method ", to_string(settings.method), " moves no ", kind, "s; ",
           methods_that(moves_elements), " do");
  if (settings.gradient == Gradient::old)
    refuse(kind, " ", i, ": gradient old moves no ", kind, "s", why, "; mid and new do");
}

void require_joints_moved(const Scene& island, std::span<const std::uint32_t> particles,
                          const Settings& settings) {
  const auto refuse_it = [&](const std::string& what, const char* why) {
    refuse("particle ", particles.front(), ": its island has ", what, ", which method ",
           to_string(settings.method), " cannot move", why, "; ",
           methods_that([&](const MethodRow& row) { return moves(row, island, particles); }), " can");
  };
  if (settings.method == Method::relax) {
    if (has_air(island)) refuse_it("air on rods", "");
    if (has_heavy_bodies(island))
      refuse_it("a body whose mass does not lie in its four particles",
                ": add_body() makes one that relaxation moves");
    return;
  }
  if (!method_row(settings.method).moves_joints) refuse_it(kinds_of_parts(island), "");
  if (settings.mass == MassModel::lumped)
    refuse("particle ", particles.front(), ": its island has ", kinds_of_parts(island),
           ", which mass lumped does not know: bodies need their inertia");
}

void require_read_by_direct(const Settings& settings, bool touches) {
  constexpr Reads of_relaxation =
      Reads::weights | Reads::order | Reads::omega | Reads::sweeps | Reads::budget_us | Reads::layout;
  for (const SettingRow& row : setting_rows()) {
    if (!contains(of_relaxation, row.id) || !row.is_set(settings)) continue;
    // A cap on sweeps comes along with a tolerance, which nets may read, or with a budget, which is named.
    if (row.id == Reads::sweeps && (settings.stop.tolerance || settings.stop.budget_us)) continue;
    refuse_unread(row.name, "method auto solves every island of this scene directly",
                  touches ? ", or relaxes what touches as it sees fit" : "", "; method relax reads it");
  }
}

void require_tolerance_read(const Settings& settings) {
  if (settings.stop.tolerance)
    refuse_unread("tolerance", "method ", to_string(settings.method),
                  " relaxes nothing of this scene, and solves no net of it by its lines",
                  "; method relax reads it");
}

}  // namespace plumb::detail
