#include "scenes/files/scene_json.hpp"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "plumb/error.hpp"
#include "scenes/basics/lists.hpp"
#include "scenes/basics/nearest.hpp"

namespace plumb::scenes {
namespace {

std::string join(const std::string& path, const char* key) {
  return path.empty() ? key : path + "." + key;
}

/// Names a kind of value for messages, such as "an array".
std::string kind_of(const json& value) {
  const std::string name = value.type_name();
  return name == "object" || name == "array" ? "an " + name : name == "null" ? name : "a " + name;
}

/// Spells a number as it is, and anything else by its kind.
std::string text_of(const json& value) {
  return value.is_number() ? value.dump() : kind_of(value);
}

json parse_strictly(std::string_view text) {
  std::vector<std::set<std::string>> open;
  const auto check = [&](int, json::parse_event_t event, json& value) {
    if (event == json::parse_event_t::object_start) open.emplace_back();
    if (event == json::parse_event_t::object_end) open.pop_back();
    if (event == json::parse_event_t::key && !open.back().insert(value.get<std::string>()).second) {
      refuse("the key " + value.dump(), "appears twice in one object");
    }
    return true;
  };
  try {
    return json::parse(text, check);
  } catch (const json::exception& error) {
    std::string reason = error.what();
    if (const std::size_t end = reason.find("] "); end != std::string::npos) reason.erase(0, end + 2);
    refuse("not JSON:", reason);
  }
}

}  // namespace

void read_json(std::string_view text, const std::function<void(const json&)>& read) {
  read(parse_strictly(text));
}

void refuse(const std::string& path, const std::string& reason) {
  throw InputError(path + " " + reason);
}

Object::Object(const json& value, std::string path, std::initializer_list<const char*> known)
    : value_(value), path_(std::move(path)) {
  if (!value.is_object())
    refuse(path_.empty() ? "the scene" : path_, "must be an object, not " + kind_of(value));
  for (const auto& item : value.items()) {
    if (std::find(known.begin(), known.end(), item.key()) != known.end()) continue;
    const std::vector<std::string> list(known.begin(), known.end());
    refuse(join(path_, item.key().c_str()),
           "is not a known key; known are " + joined(list) + did_you_mean(item.key(), list));
  }
}

const json* Object::find(const char* key) const {
  const auto it = value_.find(key);
  return it == value_.end() ? nullptr : &*it;
}
const json& Object::at(const char* key) const {
  if (const json* found = find(key)) return *found;
  refuse(path_of(key), "is missing");
}
std::string Object::path_of(const char* key) const {
  return join(path_, key);
}

double number(const json& value, const std::string& path) {
  if (!value.is_number()) refuse(path, "must be a number, not " + kind_of(value));
  return value.get<double>();
}
double number(const Object& object, const char* key) {
  return number(object.at(key), object.path_of(key));
}
double number_or(const Object& object, const char* key, double otherwise) {
  const json* value = object.find(key);
  return value ? number(*value, object.path_of(key)) : otherwise;
}

Vec3 vector(const json& value, const std::string& path) {
  if (!value.is_array() || value.size() != 3) {
    refuse(path, "must be three numbers [x, y, z], not " +
                     (value.is_array() ? "an array of " + std::to_string(value.size()) : kind_of(value)));
  }
  return {number(value[0], path + "[0]"), number(value[1], path + "[1]"), number(value[2], path + "[2]")};
}
Vec3 vector(const Object& object, const char* key) {
  return vector(object.at(key), object.path_of(key));
}
Vec3 vector_or(const Object& object, const char* key, Vec3 otherwise) {
  const json* value = object.find(key);
  return value ? vector(*value, object.path_of(key)) : otherwise;
}

bool truth_or(const Object& object, const char* key, bool otherwise) {
  const json* value = object.find(key);
  if (!value) return otherwise;
  if (!value->is_boolean()) refuse(object.path_of(key), "must be true or false, not " + kind_of(*value));
  return value->get<bool>();
}

std::uint32_t id_of(const char* what, const json& value, const std::string& path) {
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() > std::numeric_limits<std::uint32_t>::max())
    refuse(path, std::string("must be the number of a ") + what + ", counted from 0, not " + text_of(value));
  return value.get<std::uint32_t>();
}
std::uint32_t particle_id(const json& value, const std::string& path) {
  return id_of("particle", value, path);
}
std::uint32_t particle_id(const Object& object, const char* key) {
  return particle_id(object.at(key), object.path_of(key));
}

std::uint64_t count(const Object& object, const char* key) {
  const json& value = object.at(key);
  if (!value.is_number_unsigned()) refuse(object.path_of(key), "must be a count, not " + text_of(value));
  return value.get<std::uint64_t>();
}

void require_version(const Object& object, const char* key, std::uint64_t expected) {
  if (!object.find(key))
    throw InputError("the key '" + object.path_of(key) + "' (version of the format, " +
                     std::to_string(expected) + ") is missing");
  const json& version = object.at(key);
  if (!version.is_number_integer() || version != expected)
    refuse(object.path_of(key), "is the version of the format and must be " + std::to_string(expected) +
                                    ", not " + version.dump());
}

bool is_object(const json& value) {
  return value.is_object();
}

Array::Array(const json& value, std::string path) : value_(value), path_(std::move(path)) {
  if (!value.is_array()) refuse(path_, "must be an array, not " + kind_of(value));
}
Array::Array(const Object& object, const char* key) : Array(object.at(key), object.path_of(key)) {}

std::size_t Array::size() const {
  return value_.size();
}
const json& Array::operator[](std::size_t i) const {
  return value_[i];
}
std::string Array::path_of(std::size_t i) const {
  return path_ + "[" + std::to_string(i) + "]";
}

}  // namespace plumb::scenes
