#include "view/inputs/replay.hpp"

#include <nlohmann/json.hpp>

#include "plumb/error.hpp"
#include "scenes/files/scene_file.hpp"
#include "scenes/files/scene_json.hpp"

namespace plumb::view {
namespace {

using scenes::Json;

Json sides_json(const Start& start) {
  Json out = Json::array();
  for (const SideStart& side : start.sides)
    out.push_back({{"name", side.name}, {"settings", all_settings_json(side.settings)}});
  return out;
}

SideStart side_of(const scenes::json& value, const std::string& path) {
  const scenes::Object object(value, path, {"name", "settings"});
  SideStart out{.name = object.at("name").get<std::string>()};
  for (const auto& [name, text] : object.at("settings").items())
    read_setting(out.settings, name, text.get<std::string>());
  return out;
}

Taken taken_of(const scenes::json& value, const std::string& path) {
  if (!value.is_object() || !value.contains("frame")) throw InputError(path + " needs a frame");
  if (!value.at("frame").is_number_unsigned()) throw InputError(path + ".frame must be a whole number");
  return {value.at("frame").get<std::uint64_t>(), parse_request(value.dump())};
}

void read(const scenes::json& value, Replay& out) {
  const scenes::Object object(value, "",
                              {"plumb_replay", "scene", "sides", "frames", "hashes", "inputs", "scene_file"});
  scenes::require_version(object, "plumb_replay", 1);
  out.start.name = object.at("scene").get<std::string>();
  out.start.scene = scenes::parse_scene(object.at("scene_file").get<std::string>(), "scene_file");
  for (const scenes::json& side : object.at("sides"))
    out.start.sides.push_back(side_of(side, "sides[" + std::to_string(out.start.sides.size()) + "]"));
  out.frames = scenes::count(object, "frames");
  for (const scenes::json& hash : object.at("hashes")) out.hashes.push_back(hash.get<std::string>());
  for (const scenes::json& input : object.at("inputs")) {
    const std::string path = "inputs[" + std::to_string(out.inputs.size()) + "]";
    out.inputs.push_back(taken_of(input, path));
    if (!is_input(out.inputs.back().request.verb))
      throw InputError(path + " does not change how worlds move");
  }
}

}  // namespace

std::vector<std::string> hashes_of(const Exhibit& exhibit) {
  std::vector<std::string> out;
  for (const Side& side : exhibit.sides()) out.push_back(scenes::hash_text(side.world().state_hash()));
  return out;
}

std::string format_replay(const Exhibit& exhibit) {
  Json inputs = Json::array();
  for (const Taken& taken : exhibit.taken()) {
    Json input{{"frame", taken.frame}};
    input.update(request_json(taken.request));
    inputs.push_back(input);
  }
  return scenes::format_json({{"plumb_replay", 1},
                              {"scene", exhibit.start().name},
                              {"sides", sides_json(exhibit.start())},
                              {"frames", exhibit.frame()},
                              {"hashes", Json::array_of(hashes_of(exhibit))},
                              {"inputs", inputs},
                              {"scene_file", scenes::format_scene(exhibit.start().scene)}});
}

Replay parse_replay(std::string_view text, std::string_view name) {
  Replay out;
  try {
    scenes::read_json(text, [&](const scenes::json& value) { read(value, out); });
  } catch (const InputError& error) {
    throw InputError(std::string(name) + ": " + error.what());
  } catch (const nlohmann::json::exception& error) {
    throw InputError(std::string(name) + ": is no replay: " + error.what());
  }
  return out;
}

Exhibit repeat(const Replay& replay) {
  Exhibit out(replay.start);
  Repeater repeater(replay);
  while (!repeater.is_over(out)) {
    repeater.give(out);
    out.step();
  }
  repeater.give(out);
  return out;
}

void Repeater::give(Exhibit& exhibit) {
  for (; next_ < replay_.inputs.size() && replay_.inputs[next_].frame <= exhibit.frame(); ++next_)
    exhibit.take(replay_.inputs[next_].request);
}

}  // namespace plumb::view
