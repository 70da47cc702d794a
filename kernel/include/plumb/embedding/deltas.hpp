#pragma once

#include <cstddef>
#include <span>

#include "plumb/export.hpp"

/// @file
/// This file says by how much a snapshot (World::save()) differs from an earlier one, for whoever keeps many
/// of them or sends them. What sleeps takes next to nothing.
///
///     plumb::save_delta(base, now, delta);      // `base` and `now` are snapshots
///     plumb::restore_delta(base, delta, then);  // later: `then` is `now` again
///     world.restore(then);
///
/// All memory is the caller's, and nothing is allocated. A delta holds what differs in words of 8 bytes.
/// Where lists grew or shrank in one place, what lies behind it is still found; where they did in several,
/// what lies between them is held anew.
namespace plumb {

/// Returns how many bytes save_delta() takes at most, for a snapshot of so many bytes.
PLUMB_API std::size_t most_delta_size(std::size_t snapshot_size);
/// Returns how many bytes save_delta() takes. Throws InputError as it does. It takes as long as that.
PLUMB_API std::size_t delta_size(std::span<const std::byte> base, std::span<const std::byte> snapshot);

/// Writes into `out` by how much the snapshot at the beginning of `snapshot` differs from that at the
/// beginning of `base`, and returns the size of that in bytes. They may be of different times, sizes and
/// worlds; the less they have in common, the larger it is. Throws InputError, and writes nothing, if one of
/// them is no snapshot or cut off, or if `out` is too small. Sums of snapshots are not checked here.
PLUMB_API std::size_t save_delta(std::span<const std::byte> base, std::span<const std::byte> snapshot,
                                 std::span<std::byte> out);

/// Returns the size in bytes of the snapshot that a delta leads to. Throws InputError if it is no delta.
PLUMB_API std::size_t restored_size(std::span<const std::byte> delta);
/// Writes into `out` the snapshot that a delta leads to from its base, bit for bit, and returns its size in
/// bytes. `out` must not overlap `base`.
///
/// Throws InputError with a reason, and writes nothing, if the delta is cut off or changed, or `out` is too
/// small. So it does if `base` is another snapshot than the delta was made against. The base's own bytes are
/// not summed up: World::restore() refuses what comes of a damaged one.
PLUMB_API std::size_t restore_delta(std::span<const std::byte> base, std::span<const std::byte> delta,
                                    std::span<std::byte> out);

}  // namespace plumb
