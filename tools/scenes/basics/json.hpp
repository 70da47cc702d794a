#pragma once

#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace plumb::scenes {

/// This is a JSON value that is to be written. It keeps members in the order in which they were added.
/// nlohmann's library spells numbers and strings. As it takes seconds to compile, json.cpp alone includes it.
class Json {
 public:
  struct Member;

  Json(std::nullptr_t = nullptr);
  Json(bool value);
  /// JSON has no NaN and no infinity, so they are written as null.
  Json(double value);
  template <std::signed_integral Number>
  Json(Number value) : Json(whole(static_cast<std::int64_t>(value))) {}
  template <std::unsigned_integral Number>
  Json(Number value) : Json(whole(static_cast<std::uint64_t>(value))) {}
  /// Bytes of a text that are not UTF-8 are written as U+FFFD.
  Json(std::string_view value);
  Json(const std::string& value) : Json(std::string_view(value)) {}
  Json(const char* value) : Json(std::string_view(value)) {}
  /// Makes a value, or null if there is none.
  template <class Value>
  Json(const std::optional<Value>& value) : Json(value ? Json(*value) : Json()) {}
  /// Makes an object.
  Json(std::initializer_list<Member> members);

  static Json array();
  template <class Items>
  static Json array_of(const Items& items) {
    Json out = array();
    for (const auto& item : items) out.push_back(item);
    return out;
  }

  static Json array_of(std::initializer_list<double> numbers) {
    return array_of<std::initializer_list<double>>(numbers);
  }

  /// Returns the member of that name. A new one is null, and what was null becomes an object.
  Json& operator[](std::string_view key);
  /// Returns the names of an object's members, in their order.
  const std::vector<std::string>& keys() const { return keys_; }
  /// Takes over all members of another object.
  void update(const Json& object);
  /// Appends an item. What was null becomes an array.
  void push_back(Json item);

  /// Returns the text on one line.
  std::string dump() const;
  /// Returns the text with every item and member on a line of its own, indented by two spaces.
  std::string dump_indented() const;

 private:
  enum class Kind : std::uint8_t { null, scalar, array, object };

  static Json whole(std::int64_t value);
  static Json whole(std::uint64_t value);
  static Json scalar(std::string text);
  /// Appends the text. `indent` is the number of spaces before the value's end, or none for one line.
  void append_to(std::string& out, std::optional<std::size_t> indent) const;

  Kind kind_ = Kind::null;
  std::string text_;               ///< Text of a scalar.
  std::vector<std::string> keys_;  ///< Keys of an object, as many as items.
  std::vector<Json> items_;
};

struct Json::Member {
  std::string key;
  Json value;
};

/// Spells a hash as "0x" and sixteen digits.
std::string hash_text(std::uint64_t hash);

/// Returns the text of a JSON file.
std::string format_json(const Json& value);

/// Returns the members of an object by their keys, each as Json::dump() spells it. Other text has none.
std::map<std::string, std::string> members_of(std::string_view text);

}  // namespace plumb::scenes
