#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

namespace plumb::detail {

/// Takes in a word. For a given word different sums stay different, and for a given sum different words do.
constexpr std::uint64_t mixed(std::uint64_t sum, std::uint64_t word) {
  constexpr std::uint64_t prime = 0x9e3779b185ebca87;  // without a pattern that multiplies or adds (xxHash)
  return std::rotl((sum ^ word) * prime, 31);
}

/// Is a sum over bytes, as fast as memory is read. It changes with any byte, since every step of it can be
/// undone. It is the same on every processor that is little-endian.
///
/// Sums of 8 bytes stand side by side. Each takes in every 16th word. After that it is shifted over itself,
/// or has its halves swapped, in turn, so that what one word changes lies elsewhere when the next comes.
class ByteSum {
 public:
  static constexpr std::size_t lanes = 16;
  static constexpr std::size_t block = 2 * lanes * sizeof(std::uint64_t);  ///< bytes

  /// Takes in whole blocks of bytes, as many as there are. Returns how many bytes these were.
  std::size_t add(std::span<const std::byte> bytes);
  /// Copies them, too.
  std::size_t copy(std::span<const std::byte> bytes, std::byte* to);
  /// Returns the sum when what is left, less than a block, is taken in, and after that `others`.
  std::uint64_t with(std::span<const std::byte> rest, std::span<const std::byte> others) const;

 private:
  std::array<std::uint64_t, lanes> sums_{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16};
  std::uint64_t count_ = 0;  ///< bytes so far
};

/// Returns the sum over `bytes`, and after them `others`.
std::uint64_t sum_of(std::span<const std::byte> bytes, std::span<const std::byte> others);

}  // namespace plumb::detail
