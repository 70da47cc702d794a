#include "scene/refuse.hpp"

#include <charconv>

#include "plumb/error.hpp"

namespace plumb::detail {
namespace {

template <class... Format>
std::string written(auto number, Format... format) {
  char characters[32];
  const auto [end, error] = std::to_chars(std::begin(characters), std::end(characters), number, format...);
  return std::string(characters, end);
}

/// Writes a number with six digits, as streams do by default.
std::string written_briefly(double number) {
  return written(number, std::chars_format::general, 6);
}

}  // namespace

MessagePart::MessagePart(double number) : text_(written_briefly(number)) {}

MessagePart::MessagePart(std::uint64_t number) : text_(written(number)) {}

MessagePart::MessagePart(Vec3 place)
    : text_('(' + written_briefly(place.x) + ", " + written_briefly(place.y) + ", " +
            written_briefly(place.z) + ')') {}

namespace {

std::string joined(std::initializer_list<MessagePart> parts) {
  std::string message;
  for (const MessagePart& part : parts) message += part.text();
  return message;
}

}  // namespace

void throw_input_error(std::initializer_list<MessagePart> parts) {
  throw InputError(joined(parts));
}

void throw_unread(std::string_view setting, std::initializer_list<MessagePart> parts) {
  throw UnreadSetting(setting, joined(parts));
}

}  // namespace plumb::detail
