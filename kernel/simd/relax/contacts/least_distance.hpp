#pragma once

#include <limits>

namespace plumb::simd {

/// Distances (m) below this are none. It keeps quotients of zeros from being no numbers.
template <class T>
inline constexpr T least_distance = std::numeric_limits<T>::min();

/// What moves padding by a metre (kg), so that quotients stay numbers.
template <class T>
inline constexpr T least_over = T(1e-30);

}  // namespace plumb::simd
