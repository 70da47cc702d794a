#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "plumb/settings.hpp"

namespace plumb::golden {

/// Settings as a row spells them: `key=value`, separated by blanks, in any order; `none` is an optional that
/// is not set. A row names every setting that its method reads, so that no default of Settings can change
/// what it means. Throws InputError on a key that is missing, unknown, given twice or not read by the method.
///
///   all           method, mass, substeps
///   relax         precision, gradient, weights, order, omega, sweeps, tolerance, layout
///   direct        precision, gradient, time_order, accuracy, tolerance
///   auto          what relax and direct have, but for time_order
///   springs       integrator, springs, stiffness (N/m), damping_ratio, accuracy
///   multipliers   integrator, stabilization, baumgarte_rate (1/s)
///   featherstone  integrator
///   with more than particles and rods    sleep (0 or 1) besides
///
/// Values are those of to_string() and of the command line. Instruction set and threads are not the row's.
Settings parse_settings(std::string_view text, bool has_more_than_rods);

/// A key and all the values that the table must have it with.
struct Choices {
  std::string key;
  std::vector<std::string> values;
};
std::vector<Choices> list_choices();

}  // namespace plumb::golden
