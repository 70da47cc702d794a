#pragma once

#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>

#include "plumb/vec3.hpp"

namespace plumb::detail {

/// This is a part of a message: text, or a number as a stream would write it in the classic locale. A
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

}  // namespace plumb::detail
