#pragma once

#include <stdexcept>
#include <string>

#include "plumb/export.hpp"

namespace plumb {

/// Bad input: the message names the particle, rod or setting and the reason. Thrown before anything changes.
class PLUMB_VISIBLE InputError : public std::invalid_argument {
 public:
  explicit InputError(const std::string& what) : std::invalid_argument(what) {}
};

}  // namespace plumb
