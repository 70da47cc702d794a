#pragma once

#include <stdexcept>

namespace plumb::bench {

/// What was timed is not what should have been timed: its numbers mean nothing.
class CheckFailed : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace plumb::bench
