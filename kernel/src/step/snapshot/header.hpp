#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "interface/archive.hpp"
#include "plumb/version.hpp"
#include "step/snapshot/fingerprint.hpp"

namespace plumb::detail {

inline constexpr std::array<char, 8> snapshot_magic{'p', 'l', 'u', 'm', 'b', 's', 'n', 'p'};
/// Goes up with any change of what archives list, and of the sum.
inline constexpr std::uint32_t snapshot_format = 11;
inline constexpr std::uint32_t library_version =
    PLUMB_VERSION_MAJOR << 16 | PLUMB_VERSION_MINOR << 8 | PLUMB_VERSION_PATCH;

/// Every snapshot begins with this. The sum is over all bytes behind it.
struct Header {
  std::array<char, 8> begin = snapshot_magic;
  std::uint64_t sum = 0;
  std::uint32_t format_of = snapshot_format, library_of = library_version;
  std::uint64_t size = 0;  ///< of the whole snapshot, in bytes
  Fingerprint fits_to{};
};
static_assert(sizeof(Header) == 48);
/// Sums of snapshots and of deltas are over all bytes from here on.
inline constexpr std::size_t summed_from = sizeof(snapshot_magic) + sizeof(std::uint64_t);

inline void visit_members(Archive& archive, Header& of) {
  auto& [begin, sum, format_of, library_of, size, fits_to] = of;
  archive(begin, sum, format_of, library_of, size, fits_to.scene, fits_to.settings);
}

/// Writes the header of a snapshot or a delta at its beginning, with the sum over all bytes of `whole` that
/// sums are over. What is behind the header stands there already.
template <class Begin>
void write_summed(Begin header, std::span<std::byte> whole) {
  const auto write = [&] {
    Archive archive = Archive::save(whole);
    archive(header);
  };
  write();
  header.sum = checksum(whole.subspan(summed_from));
  write();
}

}  // namespace plumb::detail
