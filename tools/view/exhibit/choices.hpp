#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "plumb/settings.hpp"
#include "scenes/basics/json.hpp"

/// The settings of a world that a page changes, by name and text.
namespace plumb::view {

/// Sets one of method, gradient, weights, order, substeps, sweeps, tolerance and accuracy. `auto` and `off`
/// are texts of those that may be left to plumb. Throws InputError that says what is known.
void set_choice(Settings& settings, std::string_view name, std::string_view text);

/// Returns these settings by name, each as a text that set_choice() reads.
scenes::Json choices_json(const Settings& settings);

/// Returns all settings that change bits, by the names of options of the command; an inverse to
/// read_setting(). A budget of time is not among them, since nothing repeats what a clock did.
scenes::Json all_settings_json(const Settings& settings);
/// Sets one of them, or throws InputError as set_choice() does.
void read_setting(Settings& settings, std::string_view name, std::string_view text);

/// Returns settings without what their method does not read, so that moving from one method to another and
/// back keeps what was chosen for each.
Settings readable(const Settings& settings);
/// Sets a setting of the page back that nothing of a scene reads. Returns whether it is one.
bool forget(Settings& settings, std::string_view setting);

/// The name of a side that was added as a copy of another ends with this.
inline constexpr std::string_view again = " again";

/// A side is one of the worlds that start alike and are compared.
struct SideStart {
  std::string name;
  Settings settings{};
};

/// Returns the name of a side and what of its method, gradient, weights and accuracy is another than that
/// name says, such as "by mass · direct". It asks the settings alone, so that a replay has the names of its
/// page.
std::string name_now(const SideStart& side);

/// A comparison is a list of worlds to put side by side. The first is what the others are measured against.
struct Comparison {
  std::string name;
  std::string about;  ///< What there is to see, in a sentence.
  std::vector<SideStart> sides;
  std::string hint{};  ///< What to do where there is an end mass.
};

/// Returns the comparisons that a page offers. The first is the thesis's.
std::vector<Comparison> comparisons();
/// Returns that of a name. Throws InputError with those that are known.
Comparison comparison(std::string_view name);
/// Returns the one whose sides have these names of now, or one without a name and sides.
Comparison comparison_of(const std::vector<std::string>& names);

}  // namespace plumb::view
