#pragma once

#include <string>
#include <string_view>

namespace plumb::view {

/// What a server goes by when it lets a request in.
struct Door {
  std::string token;  ///< Secret that is part of the address.
  unsigned port = 0;
};

/// What of a request decides whether it is let in.
struct Visit {
  std::string_view target;  ///< Path, such as /TOKEN/main.js.
  std::string_view host;    ///< Header Host.
  std::string_view origin;  ///< Header Origin; empty if there is none.
};

/// Returns a new secret of 128 random bits, in hexadecimal digits.
std::string make_token();

/// Returns the address that a browser opens.
std::string address(const Door& door);

/// Returns why a visit is refused; empty if it is not. A page of another site can make a browser ask, by its
/// own name for this machine (Host) or from its own page (Origin), but it knows no token either.
std::string refusal(const Door& door, const Visit& visit);

/// Returns what follows the token in a visit that is not refused; `index.html` if nothing does.
std::string_view file_of(const Door& door, std::string_view target);

}  // namespace plumb::view
