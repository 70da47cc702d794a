#include "view/inputs/request.hpp"

#include <array>
#include <nlohmann/json.hpp>

#include "plumb/error.hpp"
#include "scenes/files/scene_json.hpp"

namespace plumb::view {
namespace {

struct VerbName {
  Verb verb;
  std::string_view name;
};
constexpr std::array verbs{VerbName{Verb::set, "set"},         VerbName{Verb::pull, "pull"},
                           VerbName{Verb::release, "release"}, VerbName{Verb::cut, "cut"},
                           VerbName{Verb::fix, "fix"},         VerbName{Verb::free, "free"},
                           VerbName{Verb::reel, "reel"},       VerbName{Verb::throw_ball, "throw"},
                           VerbName{Verb::play, "play"},       VerbName{Verb::pause, "pause"},
                           VerbName{Verb::step, "step"},       VerbName{Verb::speed, "speed"},
                           VerbName{Verb::reset, "reset"},     VerbName{Verb::defaults, "defaults"},
                           VerbName{Verb::load, "load"},       VerbName{Verb::compare, "compare"},
                           VerbName{Verb::add_side, "add"},    VerbName{Verb::drop_side, "drop"},
                           VerbName{Verb::values, "values"},   VerbName{Verb::record, "record"}};

Verb verb_of(const std::string& name) {
  for (const VerbName& each : verbs)
    if (each.name == name) return each.verb;
  throw InputError("do: '" + name + "' is nothing that can be asked for");
}

std::string text_or_none(const scenes::Object& object, const char* key) {
  const scenes::json* value = object.find(key);
  if (!value) return {};
  if (!value->is_string()) throw InputError(object.path_of(key) + " must be a text");
  return value->get<std::string>();
}

scenes::Json place_json(Vec3 place) {
  return scenes::Json::array_of({place.x, place.y, place.z});
}

}  // namespace

std::string_view to_string(Verb verb) {
  for (const VerbName& each : verbs)
    if (each.verb == verb) return each.name;
  return "";
}

Request parse_request(std::string_view text) {
  Request out;
  scenes::read_json(text, [&](const scenes::json& value) {
    // A recorded request has the number of its frame, too, which who reads the record looks at.
    const scenes::Object object(value, "",
                                {"do", "side", "name", "value", "number", "at", "velocity", "frame"});
    object.at("do");
    out.verb = verb_of(text_or_none(object, "do"));
    if (const scenes::json* side = object.find("side")) out.side = scenes::id_of("a world", *side, "side");
    if (const scenes::json* number = object.find("number"))
      out.number = scenes::id_of("a particle or rod", *number, "number");
    out.name = text_or_none(object, "name");
    out.value = text_or_none(object, "value");
    out.at = scenes::vector_or(object, "at", {});
    out.velocity = scenes::vector_or(object, "velocity", {});
  });
  return out;
}

scenes::Json request_json(const Request& request) {
  scenes::Json out{{"do", to_string(request.verb)}};
  if (request.side) out["side"] = *request.side;
  if (!request.name.empty()) out["name"] = request.name;
  if (!request.value.empty()) out["value"] = request.value;
  if (request.number != 0) out["number"] = request.number;
  if (request.at != Vec3{}) out["at"] = place_json(request.at);
  if (request.velocity != Vec3{}) out["velocity"] = place_json(request.velocity);
  return out;
}

}  // namespace plumb::view
