#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "interface/archive.hpp"
#include "math/byte_sum.hpp"
#include "plumb/version.hpp"
#include "step/snapshot/fingerprint.hpp"

namespace plumb::detail {

inline constexpr std::array<char, 8> snapshot_magic{'p', 'l', 'u', 'm', 'b', 's', 'n', 'p'};
/// Goes up with any change of what archives list, and of the sum.
inline constexpr std::uint32_t snapshot_format = 26;
inline constexpr std::uint32_t library_version =
    PLUMB_VERSION_MAJOR << 16 | PLUMB_VERSION_MINOR << 8 | PLUMB_VERSION_PATCH;

/// Every snapshot begins with this. The sum is over all bytes behind it: those of the state, and then those
/// of the header.
struct Header {
  std::array<char, 8> begin = snapshot_magic;
  std::uint64_t sum = 0;
  std::uint32_t format_of = snapshot_format, library_of = library_version;
  std::uint64_t size = 0;  ///< of the whole snapshot, in bytes
  Fingerprint fits_to{};
};
static_assert(sizeof(Header) == 48);
/// Headers of snapshots and of deltas are summed up from here on.
inline constexpr std::size_t summed_from = sizeof(snapshot_magic) + sizeof(std::uint64_t);

inline void visit_members(Archive& archive, Header& of) {
  auto& [begin, sum, format_of, library_of, size, fits_to] = of;
  archive(begin, sum, format_of, library_of, size, fits_to.scene, fits_to.settings);
}

/// Returns the part of a header, of a snapshot or a delta, that is summed up with what is behind it.
template <class Begin>
std::span<const std::byte> summed_part(const Begin&, std::span<const std::byte> whole) {
  return whole.first(sizeof(Begin)).subspan(summed_from);
}
/// Returns the sum over a whole snapshot or delta, which begins with this header.
template <class Begin>
std::uint64_t sum_over(const Begin& header, std::span<const std::byte> whole) {
  return sum_of(whole.subspan(sizeof header), summed_part(header, whole));
}

/// Writes the header of a snapshot or a delta at its beginning. `sum` returns the sum over what is behind it,
/// and then over some of its own bytes.
template <class Begin, class Sum>
void write_header(Begin header, std::span<std::byte> whole, Sum&& sum) {
  const auto write = [&] {
    Archive archive = Archive::save(whole.first(sizeof header));
    archive(header);
  };
  write();
  header.sum = sum(summed_part(header, whole));
  write();
}

}  // namespace plumb::detail
