#include "step/compile/choose_method.hpp"

#include <algorithm>
#include <cmath>

#include "plumb/layouts/trees.hpp"
#include "step/methods.hpp"

namespace plumb::detail {
namespace {

/// Returns the accuracy below which composed substeps of order 4 take less time. They cost five times as
/// much, and they too must resolve the fastest wave, which gains on the motion as a tree grows.
///
/// For trees the formula is fitted to where `plumb frontier` finds both orders equally fast at the same
/// error. It saw chains of 5 to 100 links with end masses of 1 to 1000, and trees of rods with mass.
///
/// For loops the number lies between the frontier's truss, where order 4 pays from 1e-6 on, and its nets,
/// where it hardly pays at 1e-7.
double worth_order_4(bool is_tree, std::size_t rods) {
  const auto n = static_cast<double>(rods);
  return is_tree ? 4.5e-3 / (n * std::sqrt(n)) : 3e-5;
}

/// Float rounds what the heaviest pulls by up to 0.4 % of what the lightest weighs, if it is so many times as
/// heavy.
constexpr double widest_in_float = 0x1p16;

/// Returns whether pulls of the heaviest, rounded to float, would move the lightest as if they were a force.
bool has_wide_masses(const Scene& scene, std::span<const std::uint32_t> particles,
                     std::span<const double> masses) {
  double most = 0, most_inverse = 0;
  for (const std::uint32_t i : particles) {
    if (!scene.particles[i].fixed) most = std::max(most, masses[i]);
    most_inverse = std::max(most_inverse, 1 / masses[i]);
  }
  return most * most_inverse > widest_in_float;
}

/// Returns whether rounding of float, in how far a cable is stretched where it comes tight, would give it
/// energy.
bool has_cables(const Scene& scene, std::span<const std::uint32_t> rods) {
  return std::any_of(rods.begin(), rods.end(), [&](std::uint32_t i) {
    const RodLaw& law = scene.rods[i].law;
    return law.one_sided && law.is_elastic();
  });
}

IslandShape shape_of(const layouts::Graph& island) {
  if (const auto tree = layouts::find_tree(island))
    return tree->ties.size() > 1 ? IslandShape::tied : IslandShape::tree;
  return is_thin(island) ? IslandShape::thin : is_vast(island) ? IslandShape::vast : IslandShape::wide;
}

/// Returns how method automatic moves an island whose precision is that of the settings.
Choice choose_automatic(const Scene& scene, const IslandNumbers& island, const Settings& settings) {
  const IslandShape shape = shape_of(island.graph);
  Choice out{choose_method(scene, shape, island.rods, settings), {}};
  if (out.method != Method::direct) return out;
  out.direct.gradient = choose_gradient(scene, shape, island.rods, settings);
  out.direct.time_order =
      choose_time_order(scene, out.direct.gradient, is_tree(shape), island.rods, settings);
  out.direct.bounds_frames = !settings.accuracy && !settings.gradient;
  out.direct.changes_gradient = settings.accuracy && !settings.gradient &&
                                out.direct.gradient == Gradient::old && out.direct.time_order == 2;
  return out;
}

}  // namespace

Choice choose_with_elements(const Settings& settings) {
  if (settings.method != Method::automatic)
    return {settings.method, {gradient_of(settings), settings.time_order, false}};
  return {Method::direct, {settings.gradient.value_or(Gradient::mid), 2, false}};
}

Choice choose(const Scene& scene, const IslandNumbers& island, std::span<const double> masses,
              const Settings& settings) {
  Settings of_island = settings;
  if (!masses.empty() && has_wide_masses(scene, island.particles, masses))
    of_island.precision = Precision::double_;
  Choice out = settings.method == Method::automatic ? choose_automatic(scene, island, of_island)
                                                    : choose_with_elements(settings);
  if (out.method == Method::direct && !(settings.gradient != Gradient::old && has_cables(scene, island.rods)))
    out.direct.precision = of_island.precision;
  return out;
}

Method choose_method(const Scene& scene, IslandShape shape, std::span<const std::uint32_t> rods,
                     const Settings& settings) {
  if (shape != IslandShape::vast || settings.accuracy || has_laws(scene, rods)) return Method::direct;
  return carries_mass(scene, rods, mass_model_of(settings)) ? Method::direct : Method::relax;
}

Gradient choose_gradient(const Scene& scene, IslandShape shape, std::span<const std::uint32_t> rods,
                         const Settings& settings) {
  if (settings.gradient) return *settings.gradient;
  const bool has_mass = carries_mass(scene, rods, mass_model_of(settings));
  if (!settings.accuracy) {
    const bool is_wide = shape == IslandShape::wide || shape == IslandShape::vast;
    return is_wide && !has_mass && !has_laws(scene, rods) ? Gradient::new_ : Gradient::mid;
  }
  const bool has_order_4 =
      is_tree(shape) && choose_time_order(scene, Gradient::old, true, rods, settings) == 4;
  // Steps of gradient old cost a fraction of mid's where multipliers are the only unknowns, else as much. A
  // net of rods with mass, drawn straight between its corners, takes 130 times as many steps with old.
  return shape == IslandShape::tree || !has_mass || has_order_4 ? Gradient::old : Gradient::mid;
}

std::uint32_t choose_time_order(const Scene& scene, Gradient gradient, bool is_tree,
                                std::span<const std::uint32_t> rods, const Settings& settings) {
  // Composed substeps go backwards in between, where damping would feed motion.
  return settings.accuracy && *settings.accuracy <= worth_order_4(is_tree, rods.size()) &&
                 settings.precision == Precision::double_ && gradient == Gradient::old &&
                 !has_laws(scene, rods)
             ? 4
             : 2;
}

}  // namespace plumb::detail
