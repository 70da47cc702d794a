#pragma once

#include <cstdint>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "plumb/vec3.hpp"

/// JSON values with the path of each, for messages. All functions throw InputError with it.
namespace plumb::scenes {

using nlohmann::json;
using nlohmann::ordered_json;

[[noreturn]] void refuse(const std::string& path, const std::string& reason);

/// Such as "an array", for messages.
std::string kind_of(const json& value);

/// An object whose keys are all known; `path` names it in messages ("" is the whole file).
class Object {
 public:
  Object(const json& value, std::string path, std::initializer_list<const char*> known);

  const json* find(const char* key) const;
  const json& at(const char* key) const;
  std::string path_of(const char* key) const;

 private:
  const json& value_;
  std::string path_;
};

double number(const json& value, const std::string& path);
double number(const Object& object, const char* key);
double number_or(const Object& object, const char* key, double otherwise);

Vec3 vector(const json& value, const std::string& path);
Vec3 vector(const Object& object, const char* key);
Vec3 vector_or(const Object& object, const char* key, Vec3 otherwise);

bool truth_or(const Object& object, const char* key, bool otherwise);

std::uint32_t particle_id(const json& value, const std::string& path);
std::uint32_t particle_id(const Object& object, const char* key);

const json& array(const json& value, const std::string& path);
const json& array(const Object& object, const char* key);

/// Such as rods[3].
std::string item_path(const std::string& list, std::size_t i);

json to_json(Vec3 v);

/// One item to a line.
template <class Items, class ToJson>
void append_list(std::string& out, const char* key, const Items& items, ToJson to_object) {
  out += std::string(",\n  \"") + key + "\": [";
  for (const auto& item : items) {
    out += &item == &items.front() ? "\n    " : ",\n    ";
    out += to_object(item).dump();
  }
  out += items.empty() ? "]" : "\n  ]";
}

}  // namespace plumb::scenes
