#pragma once

#include <locale>
#include <sstream>

#include "plumb/error.hpp"

namespace plumb::detail {

/// Throws InputError with the parts written one after the other.
template <class... Parts>
[[noreturn]] void refuse(const Parts&... parts) {
  std::ostringstream message;
  message.imbue(std::locale::classic());  // a program's locale must not change the numbers in messages
  (message << ... << parts);
  throw InputError(message.str());
}

}  // namespace plumb::detail
