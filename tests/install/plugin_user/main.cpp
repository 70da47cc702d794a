// A program and its plugin, each with plumb: what the plugin refuses arrives in the program as plumb's own
// error.
#include <dlfcn.h>

#include <cmath>
#include <cstdio>
#include <plumb/plumb.hpp>

int main() {
  void* const plugin = dlopen(PLUGIN, RTLD_NOW | RTLD_LOCAL);
  if (plugin == nullptr) {
    std::printf("%s\n", dlerror());
    return 1;
  }
  const auto fall_for = reinterpret_cast<double (*)(double)>(dlsym(plugin, "fall_for"));
  if (std::abs(fall_for(0.1) + 9.81 * 0.01 / 2) > 1e-9) return 2;
  try {
    fall_for(-1);
  } catch (const plumb::InputError& error) {
    std::printf("%s\n", error.what());
    return 0;
  }
  return 3;
}
