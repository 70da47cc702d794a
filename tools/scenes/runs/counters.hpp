#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "plumb/world.hpp"
#include "scenes/basics/json.hpp"

/// This is the one list of StepReport's counters. Reports, CSV files and summaries loop over it, so that a
/// new counter is a member of StepReport and one row in counters.cpp.
namespace plumb::scenes {

/// A counter says where StepReport holds a number and how outputs call it.
struct Counter {
  using Member = std::variant<std::uint64_t StepReport::*, std::uint32_t StepReport::*, double StepReport::*>;

  std::string_view name;     ///< Name of the JSON member and of the CSV column.
  Member member;             ///< The number in StepReport.
  std::string_view meaning;  ///< What it counts, with its unit, for people who read `plumb run`.
  std::string_view group{};  ///< The object of a report that holds it; none if the report itself does.
};

/// All counters, in the order of StepReport. StepReport::stopped_by is a word and no counter.
std::span<const Counter> counters();

/// Reads a counter of a report as a JSON number.
Json value_of(const Counter& counter, const StepReport& report);
/// Reads a counter of a report as text, with six significant digits if it is no whole number.
std::string text_of(const Counter& counter, const StepReport& report);
/// Whether anything was counted.
bool is_counted(const Counter& counter, const StepReport& report);

/// The name of a counter in a flat list, which begins with its group: "contact_points".
std::string flat_name(const Counter& counter);

/// Adds all counters of a group to a JSON object, by name.
void add_counters(Json& object, std::string_view group, const StepReport& report);

}  // namespace plumb::scenes
