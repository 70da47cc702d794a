#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

#include "plumb/export.hpp"

namespace plumb {

/// Reports bad input. The message names the particle, rod or setting and the reason. It is thrown before
/// anything changes.
class PLUMB_VISIBLE InputError : public std::invalid_argument {
 public:
  /// Keeps the message, one sentence or more.
  explicit InputError(const std::string& what) : std::invalid_argument(what) {}
};

/// Reports a setting that differs from its default and that nothing of a scene would read.
class PLUMB_VISIBLE UnreadSetting : public InputError {
 public:
  /// Keeps the name of the setting, which must last, and the message.
  UnreadSetting(std::string_view setting, const std::string& what) : InputError(what), setting_(setting) {}

  /// Returns its name, as MethodInfo::reads has it. It lasts as long as the program.
  std::string_view setting() const { return setting_; }

 private:
  std::string_view setting_;
};

}  // namespace plumb
