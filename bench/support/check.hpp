#pragma once

#include <stdexcept>

namespace plumb::bench {

/// Reports that what was timed is not what should have been timed, so that its numbers mean nothing.
class CheckFailed : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace plumb::bench
