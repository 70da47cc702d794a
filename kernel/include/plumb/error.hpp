#pragma once

#include <stdexcept>
#include <string>

namespace plumb {

/// Bad input: the message names the particle, rod or setting and the reason. Thrown before anything changes.
class InputError : public std::invalid_argument {
 public:
  explicit InputError(const std::string& what) : std::invalid_argument(what) {}
};

/// A request for something this build does not hold yet, such as a method that is planned but not built.
class NotBuiltError : public std::runtime_error {
 public:
  explicit NotBuiltError(const std::string& what) : std::runtime_error(what) {}
};

}  // namespace plumb
