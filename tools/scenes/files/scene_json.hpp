#pragma once

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <utility>

#include "plumb/vec3.hpp"

/// These functions read JSON and keep the path of each value for messages. All throw InputError with it. Only
/// scene_json.cpp includes nlohmann's library, which takes seconds to compile.
namespace plumb::scenes {

using nlohmann::json;

[[noreturn]] void refuse(const std::string& path, const std::string& reason);

/// Hands the value of `text` to `read`. Two equal keys are an error. The library would keep the last of them
/// and ignore the other silently.
void read_json(std::string_view text, const std::function<void(const json&)>& read);

/// An object has keys that are all known. Messages name it by `path`, where "" is the whole file.
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

/// Reads the number of something that messages call `what`.
std::uint32_t id_of(const char* what, const json& value, const std::string& path);
std::uint32_t particle_id(const json& value, const std::string& path);
std::uint32_t particle_id(const Object& object, const char* key);

/// Reads a count of up to 64 bits.
std::uint64_t count(const Object& object, const char* key);

/// Refuses all versions of the format but `expected`.
void require_version(const Object& object, const char* key, std::uint64_t expected);

bool is_object(const json& value);

/// Reads an array, with the path of each item, such as rods[3].
class Array {
 public:
  Array(const json& value, std::string path);
  Array(const Object& object, const char* key);

  std::size_t size() const;
  const json& operator[](std::size_t i) const;
  std::string path_of(std::size_t i) const;

 private:
  const json& value_;
  std::string path_;
};

}  // namespace plumb::scenes
