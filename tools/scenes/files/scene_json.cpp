#include "scenes/files/scene_json.hpp"

#include <limits>

#include "plumb/error.hpp"
#include "scenes/basics/lists.hpp"

namespace plumb::scenes {
namespace {

std::string join(const std::string& path, const char* key) {
  return path.empty() ? key : path + "." + key;
}

}  // namespace

void refuse(const std::string& path, const std::string& reason) {
  throw InputError(path + " " + reason);
}

std::string kind_of(const json& value) {
  const std::string name = value.type_name();
  return name == "object" || name == "array" ? "an " + name : name == "null" ? name : "a " + name;
}

Object::Object(const json& value, std::string path, std::initializer_list<const char*> known)
    : value_(value), path_(std::move(path)) {
  if (!value.is_object())
    refuse(path_.empty() ? "the scene" : path_, "must be an object, not " + kind_of(value));
  for (const auto& item : value.items()) {
    bool found = false;
    std::string list;
    for (const char* key : known) {
      found = found || item.key() == key;
      append_item(list, key);
    }
    if (!found) refuse(join(path_, item.key().c_str()), "is not a known key; known are " + list);
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

std::uint32_t particle_id(const json& value, const std::string& path) {
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() > std::numeric_limits<std::uint32_t>::max()) {
    refuse(path, "must be the number of a particle, counted from 0, not " +
                     (value.is_number() ? value.dump() : kind_of(value)));
  }
  return value.get<std::uint32_t>();
}
std::uint32_t particle_id(const Object& object, const char* key) {
  return particle_id(object.at(key), object.path_of(key));
}

const json& array(const json& value, const std::string& path) {
  if (!value.is_array()) refuse(path, "must be an array, not " + kind_of(value));
  return value;
}
const json& array(const Object& object, const char* key) {
  return array(object.at(key), object.path_of(key));
}

std::string item_path(const std::string& list, std::size_t i) {
  return list + "[" + std::to_string(i) + "]";
}

json to_json(Vec3 v) {
  return json::array({v.x, v.y, v.z});
}

}  // namespace plumb::scenes
