#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <vector>

#include "interface/archive.hpp"
#include "math/byte_sum.hpp"
#include "plumb/layouts/memory.hpp"
#include "scene/lists/scene_members.hpp"

namespace plumb::detail {

/// Every digest begins with a number without a pattern, as xxHash has it.
inline constexpr std::uint64_t begin_of_digests = 0xc2b2ae3d27d4eb4f;

inline std::uint64_t word_at(const std::byte* from, std::size_t count = 8) {
  std::uint64_t word = 0;
  std::memcpy(&word, from, count);
  return word;
}

/// Takes in all members of what describes scenes and settings. Functions visit_members() list them, so that a
/// new one does not compile before it is listed.
class Digest {
 public:
  std::uint64_t value() const { return sum_; }

  template <class... T>
  void operator()(const T&... values) {
    (one(values), ...);
  }

 private:
  template <class T>
  void one(const T& value) {
    if constexpr (is_dense<T>)
      take({reinterpret_cast<const std::byte*>(&value), sizeof value});
    else
      visit_members(*this, const_cast<T&>(value));  // which is read alone
  }
  void one(const bool& value) { sum_ = mixed(sum_, value ? 1 : 0); }
  template <class T, class Allocator>
  void one(const std::vector<T, Allocator>& values) {
    sum_ = mixed(sum_, values.size());
    for (const T& each : values) one(each);
  }
  template <class T>
  void one(const std::optional<T>& value) {
    one(value.has_value());
    if (value) one(*value);
  }
  void take(std::span<const std::byte> bytes) {
    for (std::size_t i = 0; i < bytes.size(); i += 8)
      sum_ = mixed(sum_, word_at(&bytes[i], std::min<std::size_t>(8, bytes.size() - i)));
  }

  std::uint64_t sum_ = begin_of_digests;
};

}  // namespace plumb::detail
