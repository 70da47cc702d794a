#include "math/byte_sum.hpp"

#include <algorithm>
#include <cstring>

#include "simd/inline.hpp"

namespace plumb::detail {
namespace {

constexpr std::size_t row = ByteSum::lanes * sizeof(std::uint64_t);  // bytes; a block has two rows

/// Holds two words, as every processor has them that plumb has vectors for.
struct Narrow {
  typedef std::uint64_t Words __attribute__((vector_size(16)));
  typedef std::uint32_t Halves __attribute__((vector_size(16)));
  static PLUMB_INLINE void swap_halves(Words& of) {
    const auto halves = reinterpret_cast<Halves>(of);
    of = reinterpret_cast<Words>(__builtin_shufflevector(halves, halves, 1, 0, 3, 2));
  }
};
struct Wide {
  typedef std::uint64_t Words __attribute__((vector_size(32)));
  typedef std::uint32_t Halves __attribute__((vector_size(32)));
  static PLUMB_INLINE void swap_halves(Words& of) {
    const auto halves = reinterpret_cast<Halves>(of);
    of = reinterpret_cast<Words>(__builtin_shufflevector(halves, halves, 1, 0, 3, 2, 5, 4, 7, 6));
  }
};

/// Adds up `blocks` blocks of bytes, by vectors that give the same sums whatever their width is. Copies them
/// if asked to.
template <class Vector, bool copies>
PLUMB_INLINE void add_blocks(std::uint64_t* sums, const std::byte* from, std::size_t blocks, std::byte* to) {
  using Words = typename Vector::Words;
  Words in_turn[row / sizeof(Words)];  // kept in registers
  std::memcpy(in_turn, sums, sizeof in_turn);
  std::size_t at = 0;
  const auto add_next = [&](Words& sum) {
    Words words;
    std::memcpy(&words, from + at, sizeof words);
    if constexpr (copies) std::memcpy(to + at, &words, sizeof words);
    at += sizeof words;
    sum += words;
  };
  while (at < blocks * ByteSum::block) {
    for (Words& each : in_turn) {
      add_next(each);
      each ^= each >> 3;
    }
    for (Words& each : in_turn) {
      add_next(each);
      Vector::swap_halves(each);
    }
  }
  std::memcpy(sums, in_turn, sizeof in_turn);
}

using AddBlocks = void (*)(std::uint64_t* sums, const std::byte* from, std::size_t blocks, std::byte* to);

template <bool copies>
void add_narrow(std::uint64_t* sums, const std::byte* from, std::size_t blocks, std::byte* to) {
  add_blocks<Narrow, copies>(sums, from, blocks, to);
}

#if defined(__x86_64__) || defined(__i386__)
template <bool copies>
__attribute__((target("avx2"))) void add_wide(std::uint64_t* sums, const std::byte* from, std::size_t blocks,
                                              std::byte* to) {
  add_blocks<Wide, copies>(sums, from, blocks, to);
}
/// Returns what is as fast as memory. Vectors of 16 bytes take a quarter longer.
template <bool copies>
AddBlocks best() {
  return __builtin_cpu_supports("avx2") ? add_wide<copies> : add_narrow<copies>;
}
#else
template <bool copies>
AddBlocks best() {
  return add_narrow<copies>;
}
#endif

std::uint64_t with_words(std::uint64_t sum, std::span<const std::byte> bytes) {
  for (std::size_t i = 0; i < bytes.size(); i += sizeof(std::uint64_t)) {
    std::uint64_t word = 0;
    std::memcpy(&word, &bytes[i], std::min(sizeof word, bytes.size() - i));
    sum = mixed(sum, word);
  }
  return sum;
}

}  // namespace

std::size_t ByteSum::add(std::span<const std::byte> bytes) {
  const std::size_t blocks = bytes.size() / block;
  best<false>()(sums_.data(), bytes.data(), blocks, nullptr);
  count_ += blocks * block;
  return blocks * block;
}

std::size_t ByteSum::copy(std::span<const std::byte> bytes, std::byte* to) {
  const std::size_t blocks = bytes.size() / block;
  best<true>()(sums_.data(), bytes.data(), blocks, to);
  count_ += blocks * block;
  return blocks * block;
}

std::uint64_t ByteSum::with(std::span<const std::byte> rest, std::span<const std::byte> others) const {
  std::uint64_t sum = count_ + rest.size();
  for (const std::uint64_t each : sums_) sum = mixed(sum, each);
  return with_words(with_words(sum, rest), others);
}

std::uint64_t sum_of(std::span<const std::byte> bytes, std::span<const std::byte> others) {
  ByteSum sum;
  return sum.with(bytes.subspan(sum.add(bytes)), others);
}

}  // namespace plumb::detail
