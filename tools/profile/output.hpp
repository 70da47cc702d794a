#pragma once

#include <optional>
#include <string>

#include "plot/table.hpp"
#include "profile/measure.hpp"
#include "scenes/basics/json.hpp"

/// These functions show a profile to people and programs. What is not available is "—" in tables, an empty
/// field in CSV and null in JSON. It is never a zero.
namespace plumb::tools {

/// Spells a value with three decimals, which a count per projection needs, or "—" if there is none.
std::string count_cell(const std::optional<double>& value);
/// Spells a value with three significant digits, or "—" if there is none.
std::string number_cell(const std::optional<double>& value);

/// Says where the state of a scene of that size fits: "L1", "L2" or "> L2".
std::string size_name(SceneSize size, const CachePair& caches);

/// Shows the rows of method relax, per projection.
Table relax_table(const Profile& profile);
/// Shows the rows of method direct, per rod and Newton step.
Table direct_table(const Profile& profile);

/// Says how it was measured and what that leaves out.
std::string way_text(const Profile& profile);

/// Returns a header and one line per row.
std::string profile_csv(const Profile& profile);
/// Returns way, caches, simulated caches (null unless cachegrind) and rows.
scenes::Json profile_json(const Profile& profile);

/// A picture shows one of these counts.
enum class MissKind : std::uint8_t { l1d_read, ll };
/// Draws bars of misses per projection for one order of a sweep, by scene, size and layout. Returns SVG text,
/// which is empty if no row has that count. Throws InputError if gnuplot fails.
std::string draw_misses(const Profile& profile, MissKind kind, SweepOrder order);

}  // namespace plumb::tools
