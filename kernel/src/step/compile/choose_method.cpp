#include "step/compile/choose_method.hpp"

#include <algorithm>
#include <cmath>

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

}  // namespace

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
