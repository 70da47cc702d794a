#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>

#include "plumb/layouts/memory.hpp"

namespace plumb::layouts {

/// Size of a cache line and of the widest vector register, in bytes. Every store starts on such a boundary.
inline constexpr std::size_t alignment = 64;

/// Lanes of the logical vector: 16 floats or 8 doubles, whatever the registers of the machine. Padding,
/// grouping and therefore results do not depend on the instruction set.
template <class T>
inline constexpr std::uint32_t lane_width = alignment / sizeof(T);

/// The least multiple of `multiple` that is not below `n`.
constexpr std::uint32_t round_up(std::uint32_t n, std::uint32_t multiple) {
  return (n + multiple - 1) / multiple * multiple;
}

/// A zeroed array of numbers on a 64-byte boundary. It moves and does not copy.
template <class T>
class AlignedBuffer {
  static_assert(std::is_trivial_v<T>);

 public:
  AlignedBuffer() = default;
  /// Allocates `size` numbers, all zero. Throws std::bad_alloc if there is no room.
  explicit AlignedBuffer(std::size_t size)
      : data_(size ? static_cast<T*>(allocate_noted(size * sizeof(T), alignment)) : nullptr), size_(size) {
    for (std::size_t i = 0; i < size_; ++i) data_[i] = T{};
  }
  /// Takes the numbers of another, which is left empty.
  AlignedBuffer(AlignedBuffer&& other) noexcept
      : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)) {}
  /// Swaps numbers with another.
  AlignedBuffer& operator=(AlignedBuffer&& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    return *this;
  }
  ~AlignedBuffer() { deallocate_noted(data_, size_ * sizeof(T), alignment); }

  /// @{
  /// The numbers, their count, and one of them. Indices are not checked.
  T* data() { return data_; }
  const T* data() const { return data_; }
  std::size_t size() const { return size_; }
  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }
  /// @}
  /// @{
  /// All numbers as a span, valid while the buffer lives and is not moved.
  operator std::span<T>() { return {data_, size_}; }
  operator std::span<const T>() const { return {data_, size_}; }
  /// @}

 private:
  T* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace plumb::layouts
