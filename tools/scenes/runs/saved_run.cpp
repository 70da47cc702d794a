#include "scenes/runs/saved_run.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>

#include "plumb/error.hpp"
#include "scenes/basics/files.hpp"
#include "scenes/basics/json.hpp"
#include "scenes/runs/report.hpp"

namespace plumb::scenes {
namespace {

/// The version of what stands behind a snapshot.
constexpr int text_version = 2;

bool may_differ(std::string_view setting) {
  constexpr std::array names{"duration", "step_budget_us", "threads", "isa"};
  return std::find(names.begin(), names.end(), setting) != names.end();
}

/// Returns the option of a setting, which a report spells with other dashes.
std::string option_of(std::string setting) {
  std::replace(setting.begin(), setting.end(), '_', '-');
  return "--" + setting;
}

/// Returns how many bytes the snapshot takes that a file begins with, as it says itself (kernel/README.md).
/// Of another file it is all.
std::size_t snapshot_size(std::string_view file) {
  constexpr std::size_t stands_at = 24;
  std::uint64_t size = file.size();
  if (file.starts_with("plumbsnp") && file.size() >= stands_at + sizeof size)
    std::memcpy(&size, file.data() + stands_at, sizeof size);
  return static_cast<std::size_t>(std::min<std::uint64_t>(size, file.size()));
}

/// Refuses the text of another run than that of the plan.
void require_same_run(std::string_view text, const RunPlan& plan) {
  const auto then = members_of(text);
  const auto version = then.find("plumb_run");
  if (version == then.end())
    throw InputError("is cut off, or damaged: what stands behind the snapshot does not say what was run");
  if (version->second != std::to_string(text_version))
    throw InputError("has version " + version->second +
                     " of what stands behind the snapshot, and this plumb reads " +
                     std::to_string(text_version));
  const Json now = settings_json(plan);
  const auto values = members_of(now.dump());
  // What others follow from, as the gradient does from the method, stands before them.
  for (const std::string& name : now.keys()) {
    if (may_differ(name)) continue;
    const auto it = then.find(name);
    if (it == then.end()) throw InputError("is damaged: it does not say what " + name + " was");
    if (it->second != values.at(name))
      throw InputError("is of a run with another " + option_of(name) + ": " + it->second + ", and not " +
                       values.at(name));
  }
}

}  // namespace

std::string run_text(std::string_view scene, const RunPlan& plan) {
  Json json{{"plumb_run", text_version}, {"scene", scene}};
  json.update(settings_json(plan));
  return json.dump_indented() + "\n";
}

void restore_run(World& world, const RunPlan& plan) {
  const std::string file = read_file(plan.resume);
  const std::string_view text = std::string_view(file).substr(snapshot_size(file));
  const auto refuse = [&](const std::string& reason) { throw InputError(plan.resume + ": " + reason); };
  try {
    if (!text.empty()) require_same_run(text, plan);
    world.restore(std::as_bytes(std::span(file)));
  } catch (const InputError& error) {
    const auto then = members_of(text);
    const auto scene = then.find("scene");
    refuse(error.what() + (scene == then.end() ? "" : "; it was saved of the scene " + scene->second));
  }
}

}  // namespace plumb::scenes
