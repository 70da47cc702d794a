#pragma once

#include <stdexcept>
#include <string>

#include "plumb/export.hpp"

namespace plumb {

/// Reports bad input. The message names the particle, rod or setting and the reason. It is thrown before
/// anything changes.
class PLUMB_VISIBLE InputError : public std::invalid_argument {
 public:
  /// Keeps the message, one sentence or more.
  explicit InputError(const std::string& what) : std::invalid_argument(what) {}
};

}  // namespace plumb
