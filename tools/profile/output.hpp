#pragma once

#include <optional>
#include <string>

#include "plot/table.hpp"
#include "profile/measure.hpp"
#include "scenes/basics/json.hpp"

/// A profile as people and programs read it. What is not available is "—" in tables, an empty field in CSV
/// and null in JSON: never a zero.
namespace plumb::tools {

/// With three decimals, which a count per projection needs; "—" if there is none.
std::string count_cell(const std::optional<double>& value);
/// With three significant digits; "—" if there is none.
std::string number_cell(const std::optional<double>& value);

/// Where the state of a scene of that size fits: "L1", "L2" or "> L2".
std::string size_name(SceneSize size, const CachePair& caches);

/// Per projection, of the rows of method relax.
Table relax_table(const Profile& profile);
/// Per rod and Newton step, of the rows of method direct.
Table direct_table(const Profile& profile);

/// How it was measured and what that leaves out.
std::string way_text(const Profile& profile);

/// One line per row, with a header.
std::string profile_csv(const Profile& profile);
/// way, caches, simulated (null unless cachegrind), rows.
scenes::Json profile_json(const Profile& profile);

/// Which count a picture shows.
enum class MissKind : std::uint8_t { l1d_read, ll };
/// Bars of misses per projection by scene, size and layout, as SVG text; empty if no row has that count.
/// Throws InputError if gnuplot fails.
std::string draw_misses(const Profile& profile, MissKind kind, SweepOrder order);

}  // namespace plumb::tools
