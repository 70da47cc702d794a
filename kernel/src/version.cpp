#include "plumb/version.hpp"

#define PLUMB_TEXT_OF(number) #number
#define PLUMB_TEXT(number) PLUMB_TEXT_OF(number)

namespace plumb {

std::string_view version() {
  return PLUMB_TEXT(PLUMB_VERSION_MAJOR) "." PLUMB_TEXT(PLUMB_VERSION_MINOR) "." PLUMB_TEXT(
      PLUMB_VERSION_PATCH);
}

}  // namespace plumb
