// Scene files: whatever the bytes, a scene or an InputError. A scene is written and read back to the same
// text.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "plumb/error.hpp"
#include "scenes/files/scene_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace plumb;
  Scene scene;
  try {
    scene = scenes::parse_scene({reinterpret_cast<const char*>(data), size}, "fuzz");
  } catch (const InputError&) {
    return 0;
  }
  const std::string once = scenes::format_scene(scene);
  const std::string twice = scenes::format_scene(scenes::parse_scene(once, "again"));
  if (once != twice) {
    std::fprintf(stderr, "written:\n%s\nread and written again:\n%s\n", once.c_str(), twice.c_str());
    std::abort();
  }
  return 0;
}
