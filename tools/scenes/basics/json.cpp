#include "scenes/basics/json.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

namespace plumb::scenes {
namespace {

/// Spells a text. What is not UTF-8, as part of a file of another kind that a message quotes, becomes U+FFFD.
std::string spelled(std::string_view text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace

Json::Json(std::nullptr_t) {}
Json::Json(bool value) : Json(scalar(value ? "true" : "false")) {}
Json::Json(double value) : Json(std::isfinite(value) ? scalar(nlohmann::json(value).dump()) : Json()) {}
Json::Json(std::string_view value) : Json(scalar(spelled(value))) {}

Json::Json(std::initializer_list<Member> members) : kind_(Kind::object) {
  for (const Member& member : members) (*this)[member.key] = member.value;
}

Json Json::array() {
  Json out;
  out.kind_ = Kind::array;
  return out;
}

Json Json::whole(std::int64_t value) {
  return scalar(std::to_string(value));
}
Json Json::whole(std::uint64_t value) {
  return scalar(std::to_string(value));
}

Json Json::scalar(std::string text) {
  Json out;
  out.kind_ = Kind::scalar;
  out.text_ = std::move(text);
  return out;
}

Json& Json::operator[](std::string_view key) {
  kind_ = Kind::object;
  const auto it = std::find(keys_.begin(), keys_.end(), key);
  if (it != keys_.end()) return items_[static_cast<std::size_t>(it - keys_.begin())];
  keys_.emplace_back(key);
  return items_.emplace_back();
}

void Json::update(const Json& object) {
  for (std::size_t i = 0; i < object.keys_.size(); ++i) (*this)[object.keys_[i]] = object.items_[i];
}

void Json::push_back(Json item) {
  kind_ = Kind::array;
  items_.push_back(std::move(item));
}

std::string Json::dump() const {
  std::string out;
  append_to(out, {});
  return out;
}

std::string Json::dump_indented() const {
  std::string out;
  append_to(out, 0);
  return out;
}

void Json::append_to(std::string& out, std::optional<std::size_t> indent) const {
  if (kind_ == Kind::null) out += "null";
  if (kind_ == Kind::scalar) out += text_;
  if (kind_ == Kind::null || kind_ == Kind::scalar) return;
  const bool is_object = kind_ == Kind::object;
  out += is_object ? '{' : '[';
  const auto break_line = [&](std::size_t spaces) {
    if (indent && !items_.empty()) out += '\n' + std::string(*indent + spaces, ' ');
  };
  for (std::size_t i = 0; i < items_.size(); ++i) {
    if (i > 0) out += ',';
    break_line(2);
    if (is_object) out += spelled(keys_[i]) + (indent ? ": " : ":");
    items_[i].append_to(out, indent ? std::optional(*indent + 2) : std::nullopt);
  }
  break_line(0);
  out += is_object ? '}' : ']';
}

std::map<std::string, std::string> members_of(std::string_view text) {
  const nlohmann::json object = nlohmann::json::parse(text, nullptr, false);
  std::map<std::string, std::string> out;
  if (!object.is_object()) return out;
  for (const auto& [key, value] : object.items()) out[key] = value.dump();
  return out;
}

std::string hash_text(std::uint64_t hash) {
  constexpr char digits[] = "0123456789abcdef";
  std::string out = "0x";
  for (int shift = 60; shift >= 0; shift -= 4) out += digits[(hash >> shift) & 15];
  return out;
}

std::string format_json(const Json& value) {
  return value.dump_indented() + "\n";
}

}  // namespace plumb::scenes
