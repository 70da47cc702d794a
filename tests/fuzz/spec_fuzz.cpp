// Generators by their text, such as chain:links=20: whatever the text, a valid scene or an InputError.
#include <cctype>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "plumb/error.hpp"
#include "scenes/spec.hpp"

namespace {

/// Text that could name a file, or a number of three digits, with which scenes are too large for a fuzzer to
/// build thousands of.
bool is_out_of_bounds(std::string_view spec) {
  if (spec.find('/') != spec.npos || spec.find("json") != spec.npos) return true;
  if (spec.substr(0, spec.find(':')).find('.') != spec.npos) return true;
  int digits = 0;
  for (const char c : spec) {
    digits = std::isdigit(static_cast<unsigned char>(c)) ? digits + 1 : 0;
    if (digits > 2) return true;
  }
  return false;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view spec(reinterpret_cast<const char*>(data), size);
  if (is_out_of_bounds(spec)) return 0;
  try {
    validate(plumb::scenes::load_scene(spec));
  } catch (const plumb::InputError&) {
  }
  return 0;
}
