// This file writes and reads deltas of snapshots. kernel/README.md says what their bytes mean.

#include "plumb/embedding/deltas.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

#include "scene/refuse.hpp"
#include "step/snapshot/header.hpp"

namespace plumb {

using detail::Archive;
using detail::Header;
using detail::refuse;

namespace {

using Bytes = std::span<const std::byte>;
constexpr std::size_t word = 8;

/// Every delta begins with this. The sum is over all bytes behind it, as that of a snapshot.
struct DeltaHeader {
  std::array<char, 8> begin{'p', 'l', 'u', 'm', 'b', 'd', 'l', 't'};
  std::uint64_t sum = 0;
  std::uint64_t format_of = 2;
  std::uint64_t size = 0;  ///< of the whole delta, in bytes
  std::uint64_t base_sum = 0, base_size = 0;
  std::uint64_t of_size = 0;  ///< of the snapshot that it leads to, in bytes
  std::uint64_t split = 0;    ///< words of the snapshot before those that are as far from the base's end
};
static_assert(sizeof(DeltaHeader) == 64);

void visit_members(Archive& archive, DeltaHeader& of) {
  auto& [begin, sum, format_of, size, base_sum, base_size, of_size, split] = of;
  archive(begin, sum, format_of, size, base_sum, base_size, of_size, split);
}

/// Says how many words are those of the base, and how many follow that are not.
struct Run {
  std::uint32_t same = 0, other = 0;
};
static_assert(sizeof(Run) == word);
/// Fewer equal words than this are held with the others, since a run takes a word itself.
constexpr std::size_t least_same = 2;

/// Returns the snapshot at the beginning of `from`, and its header.
Bytes snapshot_in(Bytes from, const char* what, Header& header) {
  if (from.size() < sizeof(Header))
    refuse("delta: ", what, " is no snapshot: it has ", from.size(), " bytes");
  Archive archive = Archive::restore(from);
  archive(header);
  if (header.begin != detail::snapshot_magic) refuse("delta: ", what, " does not begin as a snapshot");
  if (header.size < sizeof(Header) || header.size > from.size())
    refuse("delta: ", what, " is cut off: it says that it has ", header.size, " bytes, and ", from.size(),
           " are here");
  return from.first(static_cast<std::size_t>(header.size));
}

std::uint64_t word_at(const std::byte* from) {
  std::uint64_t out = 0;
  std::memcpy(&out, from, word);
  return out;
}

/// Finds words of a snapshot in its base: those before `split` as far from the beginning, the others as far
/// from the end.
class Comparison {
 public:
  Comparison(Bytes base, Bytes of) : base_(base), of_(of), words_(of.size() / word), split_(words_) {
    if (base.size() != of.size()) split_ = best_split();
  }

  std::size_t words() const { return words_; }
  std::size_t split() const { return split_; }

  bool is_same(std::size_t i) const { return i < split_ ? is_same(i, i * word) : is_same(i, from_end(i)); }
  /// Returns the first word from `i` on that is another one.
  std::size_t skip_same(std::size_t i) const {
    // Most of a world that sleeps is equal, so that this goes as fast as memory is compared.
    constexpr std::size_t stride = 32;
    for (const std::size_t end : {split_, words_})
      while (i + stride <= end && is_equal(i, stride)) i += stride;
    while (i < words_ && is_same(i)) ++i;
    return i;
  }

 private:
  /// Beyond the base this is no place, or a very large one.
  std::size_t from_end(std::size_t i) const { return i * word + base_.size() - of_.size(); }
  bool is_same(std::size_t i, std::size_t at) const {
    return at < base_.size() && word <= base_.size() - at &&
           word_at(of_.data() + i * word) == word_at(base_.data() + at);
  }
  bool is_equal(std::size_t i, std::size_t count) const {
    if (i < split_ && i + count > split_) return false;
    const std::size_t at = i < split_ ? i * word : from_end(i);
    return at < base_.size() && count * word <= base_.size() - at &&
           std::memcmp(of_.data() + i * word, base_.data() + at, count * word) == 0;
  }
  /// Returns the split that finds most words.
  std::size_t best_split() const {
    std::int64_t more = 0, most = 0;
    std::size_t out = 0;
    for (std::size_t i = 0; i < words_; ++i) {
      more += is_same(i, i * word) ? 1 : 0;
      more -= is_same(i, from_end(i)) ? 1 : 0;
      if (more <= most) continue;
      most = more;
      out = i + 1;
    }
    return out;
  }

  Bytes base_, of_;
  std::size_t words_, split_;
};

/// Calls f(run, first other word) for all runs.
template <class F>
void for_runs(const Comparison& compared, F&& f) {
  constexpr std::size_t most = 0xffffffff;
  for (std::size_t i = 0; i < compared.words();) {
    const std::size_t first = std::min(compared.skip_same(i), i + most);
    std::size_t end = first, same = 0;
    for (; end < compared.words() && end - first < most && same < least_same; ++end)
      same = compared.is_same(end) ? same + 1 : 0;
    if (same >= least_same) end -= same;
    f(Run{static_cast<std::uint32_t>(first - i), static_cast<std::uint32_t>(end - first)}, first);
    i = end;
  }
}

std::size_t size_of(const Comparison& compared, Bytes of) {
  std::size_t size = sizeof(DeltaHeader) + of.size() % word;
  for_runs(compared, [&](Run run, std::size_t) { size += sizeof(Run) + run.other * word; });
  return size;
}

DeltaHeader checked(Bytes delta) {
  if (delta.size() < sizeof(DeltaHeader))
    refuse("delta: has ", delta.size(), " bytes, and its header alone takes ", sizeof(DeltaHeader));
  DeltaHeader header;
  Archive archive = Archive::restore(delta);
  archive(header);
  if (header.begin != DeltaHeader{}.begin) refuse("delta: does not begin as one");
  if (header.format_of != DeltaHeader{}.format_of)
    refuse("delta: has format ", header.format_of, ", and this plumb reads ", DeltaHeader{}.format_of);
  if (header.size < sizeof(DeltaHeader) || header.size > delta.size())
    refuse("delta: is cut off, or damaged: it says that it has ", header.size, " bytes, and ", delta.size(),
           " are here");
  const Bytes whole = delta.first(static_cast<std::size_t>(header.size));
  if (header.sum != detail::sum_over(header, whole))
    refuse("delta: is damaged: the sum over its bytes is not what it was");
  return header;
}

/// Calls put(to, from, count) for all bytes that a delta takes from the base, and put_new(to, from, count)
/// for those that it holds. Refuses what leads beyond the base, the delta or the snapshot.
template <class Put, class PutNew>
void for_pieces(const DeltaHeader& header, Bytes delta, Put&& put, PutNew&& put_new) {
  const std::uint64_t words = header.of_size / word, rest = header.of_size % word;
  const auto require = [](bool fits) {
    if (!fits) refuse("delta: leads beyond what it was made of");
  };
  const auto take = [&](std::uint64_t first, std::uint64_t end, std::uint64_t shift) {
    if (first >= end) return;
    const std::uint64_t at = first * word + shift, count = (end - first) * word;
    require(at < header.base_size && count <= header.base_size - at);
    put(first * word, at, count);
  };
  std::uint64_t at = sizeof(DeltaHeader), i = 0;
  while (i < words) {
    require(header.size - at >= sizeof(Run));
    Run run;
    std::memcpy(&run, delta.data() + at, sizeof run);
    at += sizeof run;
    require(run.same + std::uint64_t{run.other} <= words - i && run.other * word <= header.size - at);
    require(run.same > 0 || run.other > 0);
    take(i, std::min(i + run.same, header.split), 0);
    take(std::max(i, header.split), i + run.same, header.base_size - header.of_size);
    i += run.same;
    put_new(i * word, at, run.other * word);
    i += run.other;
    at += run.other * word;
  }
  require(header.size - at == rest);
  put_new(words * word, at, rest);
}

}  // namespace

std::size_t most_delta_size(std::size_t snapshot_size) {
  return sizeof(DeltaHeader) + sizeof(Run) + snapshot_size;
}

std::size_t delta_size(Bytes base, Bytes snapshot) {
  Header from, to;
  const Bytes old = snapshot_in(base, "the base", from), now = snapshot_in(snapshot, "the snapshot", to);
  return size_of(Comparison(old, now), now);
}

std::size_t save_delta(Bytes base, Bytes snapshot, std::span<std::byte> out) {
  Header from, to;
  const Bytes old = snapshot_in(base, "the base", from), now = snapshot_in(snapshot, "the snapshot", to);
  const Comparison compared(old, now);
  // What surely fits need not be measured.
  if (out.size() < most_delta_size(now.size()))
    if (const std::size_t size = size_of(compared, now); size > out.size())
      refuse("delta: takes ", size, " bytes and does not fit into ", out.size());
  std::byte* to_write = out.data() + sizeof(DeltaHeader);
  const auto write = [&](const void* bytes, std::size_t count) {
    if (count > 0) std::memcpy(to_write, bytes, count);
    to_write += count;
  };
  for_runs(compared, [&](Run run, std::size_t first) {
    write(&run, sizeof run);
    write(now.data() + first * word, run.other * word);
  });
  write(now.data() + compared.words() * word, now.size() % word);
  const auto size = static_cast<std::size_t>(to_write - out.data());
  const DeltaHeader header{.size = size,
                           .base_sum = from.sum,
                           .base_size = old.size(),
                           .of_size = now.size(),
                           .split = compared.split()};
  const Bytes behind = out.first(size).subspan(sizeof header);
  detail::write_header(header, out, [&](Bytes own) { return detail::sum_of(behind, own); });
  return size;
}

std::size_t restored_size(Bytes delta) {
  return static_cast<std::size_t>(checked(delta).of_size);
}

std::size_t restore_delta(Bytes base, Bytes delta, std::span<std::byte> out) {
  const DeltaHeader header = checked(delta);
  Header from;
  const Bytes old = snapshot_in(base, "the base", from);
  if (from.sum != header.base_sum || old.size() != header.base_size)
    refuse("delta: was made against another snapshot than this base");
  if (out.size() < header.of_size)
    refuse("delta: leads to ", header.of_size, " bytes, which do not fit into ", out.size());
  const auto nothing = [](std::uint64_t, std::uint64_t, std::uint64_t) {};
  for_pieces(header, delta, nothing, nothing);
  const auto copy_from = [&](Bytes bytes) {
    return [&out, bytes](std::uint64_t to, std::uint64_t at, std::uint64_t count) {
      if (count > 0) std::memcpy(out.data() + to, bytes.data() + at, count);
    };
  };
  for_pieces(header, delta, copy_from(old), copy_from(delta));
  return static_cast<std::size_t>(header.of_size);
}

}  // namespace plumb
