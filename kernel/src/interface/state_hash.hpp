#pragma once

#include <bit>
#include <cstdint>
#include <type_traits>

#include "plumb/vec3.hpp"

namespace plumb::detail {

/// Hashes the bits of numbers by FNV-1a, byte after byte.
class StateHash {
 public:
  template <class T>
  void add(T value) {
    using Bits = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;
    const auto bits = std::bit_cast<Bits>(value);
    for (unsigned byte = 0; byte < sizeof bits; ++byte)
      value_ = (value_ ^ ((bits >> (8 * byte)) & 0xff)) * 0x100000001b3;
  }
  /// Adds the components of a vector in precision T.
  template <class T>
  void add(Vec3 v) {
    for (const double component : {v.x, v.y, v.z}) add(static_cast<T>(component));
  }

  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325;
};

}  // namespace plumb::detail
