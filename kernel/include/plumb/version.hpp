/// @file
/// Which plumb this is. Before 1.0, minor versions may change the interface and patches do not.
#pragma once

#include <string_view>

#include "plumb/export.hpp"

/// The first number of these headers' version.
#define PLUMB_VERSION_MAJOR 0
/// The second number of these headers' version.
#define PLUMB_VERSION_MINOR 2
/// The third number of these headers' version.
#define PLUMB_VERSION_PATCH 0

namespace plumb {

/// The version of the library that runs, such as "0.2.0"; a shared one may be newer than these headers.
PLUMB_API std::string_view version();

}  // namespace plumb
