#pragma once

#include <concepts>
#include <cstdint>

#include "plumb/layouts/aligned_buffer.hpp"

namespace plumb::layouts {

/// Where the three components of a particle lie in a flat array of numbers. A store is only this arithmetic:
/// positions, displacements and kicks of one block are arrays that share it.
///
/// - offset(i) is the element of particle i's x.
/// - component_stride() counts elements from x to y and from y to z.
/// - elements() is the length of the array: particles and padding, a whole number of cache lines.
///
/// All are 32-bit: a block holds at most 2^32 numbers.
template <class S>
concept ParticleStore = requires(const S& store, std::uint32_t i) {
  { store.offset(i) } -> std::same_as<std::uint32_t>;
  { store.component_stride() } -> std::same_as<std::uint32_t>;
  { store.elements() } -> std::same_as<std::uint32_t>;
};

/// Array of structures: x y z 0 | x y z 0 | ... One particle takes a quarter (float) or half (double) of a
/// cache line.
class AosStore {
 public:
  /// For so many particles, padded to vectors of `lanes` numbers.
  AosStore(std::uint32_t particles, std::uint32_t lanes) : particles_(particles), lanes_(lanes) {}
  /// @{
  /// As ParticleStore asks.
  std::uint32_t offset(std::uint32_t i) const { return 4 * i; }
  std::uint32_t component_stride() const { return 1; }
  std::uint32_t elements() const { return round_up(4 * particles_, lanes_); }
  /// @}

 private:
  std::uint32_t particles_;
  std::uint32_t lanes_;
};

/// Structure of arrays: x x x ... | y y y ... | z z z ... in `parts` interleaved parts. Two parts hold
/// particles of even and odd rank in streams of their own, so that neighbours along a line sit in the same
/// lane.
class SoaStore {
 public:
  /// For so many particles, padded to vectors of `lanes` numbers of `element_bytes` each.
  SoaStore(std::uint32_t particles, std::uint32_t lanes, std::uint32_t element_bytes, std::uint32_t parts = 1)
      : parts_(parts) {
    // One spare vector so that a load shifted by one lane stays inside its stream.
    pitch_ = round_up((particles + parts - 1) / parts, lanes) + lanes;
    // Streams a multiple of 4 KiB apart fight for the same cache sets and make loads wait for unrelated
    // stores; 704 bytes is far from every small multiple of the line size modulo 4 KiB.
    constexpr std::uint32_t page = 4096, skew = 704;
    if (std::uint64_t{pitch_} * element_bytes >= page) {
      while ((std::uint64_t{pitch_} * element_bytes) % page != skew) pitch_ += lanes;
    }
  }
  /// @{
  /// As ParticleStore asks.
  std::uint32_t offset(std::uint32_t i) const { return (i % parts_) * 3 * pitch_ + i / parts_; }
  std::uint32_t component_stride() const { return pitch_; }
  std::uint32_t elements() const { return 3 * parts_ * pitch_; }
  /// @}
  /// Streams of the array: three components of every part.
  std::uint32_t streams() const { return 3 * parts_; }

 private:
  std::uint32_t parts_;
  std::uint32_t pitch_;
};

/// Array of structures of arrays: x*lanes y*lanes z*lanes | ... Particle i is lane i % lanes of row i /
/// lanes.
class AosoaStore {
 public:
  /// For so many particles, in rows of `lanes` numbers.
  AosoaStore(std::uint32_t particles, std::uint32_t lanes) : particles_(particles), lanes_(lanes) {}
  /// Element of particle i's x.
  std::uint32_t offset(std::uint32_t i) const { return row_offset(i / lanes_) + i % lanes_; }
  /// Element of the first x of a row.
  std::uint32_t row_offset(std::uint32_t row) const { return row * 3 * lanes_; }
  /// Elements from x to y and from y to z.
  std::uint32_t component_stride() const { return lanes_; }
  /// Length of the array. One spare row keeps a load inside it that is shifted by one lane from the last row.
  std::uint32_t elements() const { return (round_up(particles_, lanes_) / lanes_ + 1) * 3 * lanes_; }

 private:
  std::uint32_t particles_;
  std::uint32_t lanes_;
};

static_assert(ParticleStore<AosStore> && ParticleStore<SoaStore> && ParticleStore<AosoaStore>);

/// One particle array, by the offsets of its store.
template <class T>
struct StoreView {
  T* data;                         ///< The array.
  std::uint32_t component_stride;  ///< Elements from x to y and from y to z.
  /// @{
  /// A component of the particle at `offset`.
  T& x(std::uint32_t offset) const { return data[offset]; }
  T& y(std::uint32_t offset) const { return data[offset + component_stride]; }
  T& z(std::uint32_t offset) const { return data[offset + 2 * component_stride]; }
  /// @}
};

}  // namespace plumb::layouts
