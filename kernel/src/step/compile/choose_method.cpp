#include "step/compile/choose_method.hpp"

#include <algorithm>
#include <cmath>

namespace plumb::detail {
namespace {

/// From this accuracy on composed substeps take less time. They cost five times as much and are bound to the
/// fastest wave like all others, which is the faster against the motion the longer a tree is. For trees
/// fitted to where plumb frontier has both orders at the same error in the same time: chains of 5 to 100
/// links with end masses of 1 to 1000, trees of rods with mass. For loops between its truss, where they pay
/// from 1e-6 on, and its nets, at 1e-7 still hardly.
double worth_order_4(bool is_tree, std::size_t rods) {
  const auto n = static_cast<double>(rods);
  return is_tree ? 4.5e-3 / (n * std::sqrt(n)) : 3e-5;
}

}  // namespace

Method choose_method(const Scene& scene, bool shape_is_for_direct, std::span<const std::uint32_t> rods,
                     const Settings& settings) {
  if (shape_is_for_direct || settings.accuracy) return Method::direct;
  return carries_mass(scene, rods, mass_model_of(settings)) ? Method::direct : Method::relax;
}

Gradient choose_gradient(const Scene& scene, bool is_tree, std::span<const std::uint32_t> rods,
                         const Settings& settings) {
  if (settings.gradient) return *settings.gradient;
  if (!settings.accuracy) return Gradient::mid;
  // Steps of old cost a fraction of mid's where multipliers alone are unknown, else as much; and nets of rods
  // with mass that are drawn straight between their corners take it 130 times as many.
  return is_tree || !carries_mass(scene, rods, mass_model_of(settings)) ? Gradient::old : Gradient::mid;
}

std::uint32_t choose_time_order(Gradient gradient, bool is_tree, std::size_t rods, const Settings& settings) {
  return settings.accuracy && *settings.accuracy <= worth_order_4(is_tree, rods) &&
                 settings.precision == Precision::double_ && gradient == Gradient::old
             ? 4
             : 2;
}

}  // namespace plumb::detail
