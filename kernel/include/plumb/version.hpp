/// @file
/// This file says which plumb this is. Before 1.0, minor versions may change the interface and patches do
/// not.
#pragma once

#include <string_view>

#include "plumb/export.hpp"

/// This is the first number of these headers' version.
#define PLUMB_VERSION_MAJOR 0
/// This is the second number of these headers' version.
#define PLUMB_VERSION_MINOR 2
/// This is the third number of these headers' version.
#define PLUMB_VERSION_PATCH 0

namespace plumb {

/// Returns the version of the library that runs, such as "0.2.0". A shared one may be newer than these
/// headers.
PLUMB_API std::string_view version();

}  // namespace plumb
