#pragma once

#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>

#include "plumb/vec3.hpp"

namespace plumb::detail {

/// This is a part of a message: text, or a number with the fewest digits that tell it from all others. A
/// program's own locale must not change messages, and streams in every file would cost much to compile.
class MessagePart {
 public:
  MessagePart(std::string_view text) : text_(text) {}
  MessagePart(const std::string& text) : text_(text) {}
  MessagePart(const char* text) : text_(text) {}
  MessagePart(char character) : text_(1, character) {}
  MessagePart(double number);
  MessagePart(std::uint64_t number);
  MessagePart(std::unsigned_integral auto number) : MessagePart(std::uint64_t{number}) {}
  MessagePart(Vec3 place);

  std::string_view text() const { return text_; }

 private:
  std::string text_;
};

[[noreturn]] void throw_input_error(std::initializer_list<MessagePart> parts);

/// Throws InputError with the parts written one after the other.
template <class... Parts>
[[noreturn]] void refuse(const Parts&... parts) {
  throw_input_error({MessagePart(parts)...});
}

[[noreturn]] void throw_unread(std::string_view setting, std::initializer_list<MessagePart> parts);

/// Throws UnreadSetting: that nothing reads a setting, and the reason, whose parts are written likewise. The
/// setting is named as a SettingRow names it.
template <class... Parts>
[[noreturn]] void refuse_unread(std::string_view setting, const Parts&... reason) {
  throw_unread(setting, {MessagePart("nothing reads "), MessagePart(setting), MessagePart(": "),
                         MessagePart(reason)...});
}

}  // namespace plumb::detail
