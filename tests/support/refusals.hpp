#pragma once

#include <string>
#include <utility>

#include "plumb/error.hpp"

namespace plumb::test {

/// Returns the message of the InputError that f() throws, or nothing if it throws none.
template <class F>
std::string refusal(F&& f) {
  try {
    std::forward<F>(f)();
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

}  // namespace plumb::test
