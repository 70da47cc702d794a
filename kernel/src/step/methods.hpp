#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "interface/island_sets.hpp"
#include "interface/made_solver.hpp"
#include "plumb/export.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/settings.hpp"

namespace plumb::detail {

/// Names a setting that not every method reads.
enum class Reads : std::uint32_t {
  precision = 1u << 0,
  gradient = 1u << 1,
  mass = 1u << 2,
  weights = 1u << 3,
  order = 1u << 4,
  omega = 1u << 5,
  time_order = 1u << 6,
  accuracy = 1u << 7,
  sweeps = 1u << 8,
  tolerance = 1u << 9,
  budget_us = 1u << 10,
  integrator = 1u << 11,
  springs = 1u << 12,
  stabilization = 1u << 13,
  sleep = 1u << 14,
  layout = 1u << 15,
  contact = 1u << 16,
  tensions = 1u << 17,
  contacts = 1u << 18,
  most_work = 1u << 19,
  sleep_time = 1u << 20,
  stiffness = 1u << 21,
  damping_ratio = 1u << 22,
  baumgarte_rate = 1u << 23,
};
constexpr Reads operator|(Reads a, Reads b) {
  return static_cast<Reads>(static_cast<std::uint32_t>(a) | static_cast<std::uint32_t>(b));
}
constexpr bool contains(Reads all, Reads one) {
  return (static_cast<std::uint32_t>(all) & static_cast<std::uint32_t>(one)) != 0;
}

/// Describes a setting of that table: its name, and whether given settings differ from the default in it.
struct SettingRow {
  Reads id;
  std::string_view name;
  bool (*is_set)(const Settings& settings);
};
std::span<const SettingRow> setting_rows();

/// Describes one method: its name, what it moves, which settings it reads, what it refuses and why. Help
/// texts, validation, `plumb info` and the documentation read the table. A new method is one file and one
/// row.
struct MethodRow {
  Method method;
  std::string_view name;   ///< on the command line
  std::string_view moves;  ///< in words, for the documentation
  Reads reads;
  bool moves_joints = false;    ///< bodies, joints, air, shapes that touch
  bool moves_laws = false;      ///< rods that are not rigid
  bool moves_elements = false;  ///< bends, tackles, twists and reels
  /// Refuses settings that make no sense together. It may be null.
  void (*validate)(const Settings& settings) = nullptr;
  /// Makes the solvers of a scene's islands of particles and rods. It is null for automatic, which chooses
  /// among the others.
  Array<MadeSolver> (*make)(const Scene& scene, const IslandSets& sets, const Settings& settings,
                            StartReport& report) = nullptr;
  /// Makes the solver of an island with bodies or joints, as a scene of its own with its movable particles
  /// first. `particles` are their numbers in the scene. It is null for methods that leave such islands to the
  /// contact solver, or do not move them.
  MadeSolver (*make_jointed)(const Scene& island, std::span<const std::uint32_t> particles,
                             const Settings& settings, StartReport& report) = nullptr;
};

/// Returns all methods in the order of Method. Those of plumb::reference are there once they are registered.
std::span<const MethodRow> method_rows();
/// Returns the row of a method. Throws InputError if the method is not registered.
const MethodRow& method_row(Method method);
/// Adds a row, or replaces that of the same method. It is the only internal function that a shared plumb
/// exports, for plumb::reference.
PLUMB_API void register_method(const MethodRow& row);

}  // namespace plumb::detail
