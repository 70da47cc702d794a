// What of C++20 plumb uses and libc++ 14 lacks, for the toolchain of WebAssembly, which includes this first
// in every file. Later versions of libc++ have it themselves.
#pragma once

#include <version>

#if defined(_LIBCPP_VERSION) && _LIBCPP_VERSION < 15000
#include <array>
#include <charconv>
#include <compare>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <system_error>
#include <vector>

namespace std {

template <class To, class From>
constexpr To bit_cast(const From& from) noexcept {
  return __builtin_bit_cast(To, from);
}

template <class T, size_t n>
constexpr auto operator<=>(const array<T, n>& a, const array<T, n>& b) -> decltype(a[0] <=> b[0]) {
  for (size_t i = 0; i < n; ++i)
    if (const auto order = a[i] <=> b[i]; order != 0) return order;
  return strong_ordering::equal;
}
template <class T, class Allocator>
constexpr auto operator<=>(const vector<T, Allocator>& a, const vector<T, Allocator>& b)
    -> decltype(a[0] <=> b[0]) {
  for (size_t i = 0; i < a.size() && i < b.size(); ++i)
    if (const auto order = a[i] <=> b[i]; order != 0) return order;
  return a.size() <=> b.size();
}

/// Reads by musl's strtod, which is exact and knows one locale.
inline from_chars_result from_chars(const char* first, const char* last, double& value) {
  const string copy(first, last);
  const char* const digits = copy.c_str() + (copy.starts_with('-') ? 1 : 0);
  char* end = nullptr;
  const double read = strtod(copy.c_str(), &end);
  if (end == copy.c_str() || (*digits != '.' && (*digits < '0' || *digits > '9')))
    return {first, errc::invalid_argument};
  value = read;
  return {first + (end - copy.c_str()), errc{}};
}
/// Writes by musl's snprintf, which is exact and knows one locale.
inline to_chars_result to_chars(char* first, char* last, double value, chars_format format, int precision) {
  const char* const pattern = format == chars_format::fixed        ? "%.*f"
                              : format == chars_format::scientific ? "%.*e"
                                                                   : "%.*g";
  char text[400];
  const int length = snprintf(text, sizeof text, pattern, precision, value);
  if (length < 0 || length > last - first) return {last, errc::value_too_large};
  return {copy(text, text + length, first), errc{}};
}
/// Writes the fewest digits that are read back as the same number.
inline to_chars_result to_chars(char* first, char* last, double value, chars_format format) {
  for (int precision = 1; precision < 17; ++precision) {
    const auto result = to_chars(first, last, value, format, precision);
    double back = 0;
    if (result.ec == errc{} && from_chars(first, result.ptr, back).ec == errc{} && back == value)
      return result;
  }
  return to_chars(first, last, value, format, 17);
}
inline to_chars_result to_chars(char* first, char* last, double value) {
  return to_chars(first, last, value, chars_format::general);
}

}  // namespace std
#endif
