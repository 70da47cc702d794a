#pragma once

#include <limits>

namespace plumb::simd {

/// Pushes (kg m), masses (kg) and distances (m) below this are none. It keeps quotients of zeros from being
/// no numbers.
template <class T>
inline constexpr T least_push = std::numeric_limits<T>::min();

}  // namespace plumb::simd
