#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

namespace plumb::scenes {

/// Returns the number that the whole of `text` spells, or none. Blanks, trailing letters, infinity and NaN
/// are refused. It is the same in every locale.
template <class Number>
std::optional<Number> parse_number(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || text.empty()) return {};
  if constexpr (std::is_floating_point_v<Number>) {
    if (!std::isfinite(value)) return {};
  }
  return value;
}

/// Reads seconds, as a decimal or a fraction: "0.25" or "1/60".
inline std::optional<double> parse_fraction(std::string_view text) {
  const std::size_t slash = text.find('/');
  if (slash == std::string_view::npos) return parse_number<double>(text);
  const auto above = parse_number<double>(text.substr(0, slash));
  const auto below = parse_number<double>(text.substr(slash + 1));
  if (!above || !below || *below == 0) return {};
  return *above / *below;
}

/// Appends `value` with 17 significant digits (printf's %.17g), so that reading it back gives the same bits.
inline void append_exact(std::string& out, double value) {
  char buffer[32];
  const auto result = std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::general, 17);
  out.append(buffer, result.ptr);
}

/// Spells `value` with at most `digits` significant digits, for people.
inline std::string short_number(double value, int digits = 6) {
  char buffer[40];
  const auto result =
      std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::general, digits);
  return {buffer, result.ptr};
}

/// Spells `value` with at least `digits` significant digits, for columns that people compare. It has no
/// exponent unless it is tiny.
inline std::string plain_number(double value, int digits = 3) {
  if (value == 0 || !std::isfinite(value) || std::abs(value) < 1e-4) return short_number(value, digits);
  const int decimals = std::max(0, digits - 1 - static_cast<int>(std::floor(std::log10(std::abs(value)))));
  char buffer[400];
  const auto result =
      std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::fixed, decimals);
  return {buffer, result.ptr};
}

}  // namespace plumb::scenes
