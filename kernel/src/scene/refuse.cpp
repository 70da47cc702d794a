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

/// Writes a number with the fewest digits that tell it from all others: two that differ never read alike.
std::string written_exactly(double number) {
  return written(number, std::chars_format::general);
}

}  // namespace

MessagePart::MessagePart(double number) : text_(written_exactly(number)) {}

MessagePart::MessagePart(std::uint64_t number) : text_(written(number)) {}

MessagePart::MessagePart(Vec3 place)
    : text_('(' + written_exactly(place.x) + ", " + written_exactly(place.y) + ", " +
            written_exactly(place.z) + ')') {}

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
