#pragma once

#include <cstdint>

namespace plumb::tools {

/// Steps so many random hangings, of `seed` and the seeds after it, for `duration` seconds each, and prints
/// what became of them. Throws CheckFailed if one is not finite, stands still, or has a frame that was
/// neither solved nor named by World::problems().
void report_hangings(std::uint32_t count, std::uint32_t seed, double duration);

}  // namespace plumb::tools
