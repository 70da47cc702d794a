#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "math/byte_sum.hpp"
#include "plumb/layouts/aligned_buffer.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/vec3.hpp"

namespace plumb::detail {

class Archive;

/// A dense type has no padding and no pointers: its bytes are its numbers.
template <class T>
inline constexpr bool is_dense = (std::is_arithmetic_v<T> || std::is_enum_v<T>)&&!std::is_same_v<T, bool>;
template <>
inline constexpr bool is_dense<Vec3> = true;
template <class T, std::size_t n>
inline constexpr bool is_dense<std::array<T, n>> = is_dense<T>;

/// Measures, writes or reads the numbers that a snapshot holds.
///
/// A class lists its members once, for all three ways. A struct has a function visit_members(archive, of)
/// next to it, and a class with private members a function archive(archive). Both bind all members by name,
/// so that a new one does not compile before somebody decides about it. What a list leaves out follows from
/// the scene, from what is listed, or has no meaning between steps.
///
/// Numbers are little-endian, one after the other without padding. Containers begin with their size (8
/// bytes).
class Archive {
 public:
  /// Counts bytes only.
  static Archive measure() { return Archive(Way::measure, nullptr, nullptr, 0); }
  /// Writes to memory that must have room. Throws InputError otherwise.
  static Archive save(std::span<std::byte> to) { return Archive(Way::save, to.data(), nullptr, to.size()); }
  /// Reads what was written. Throws InputError if it ends early.
  static Archive restore(std::span<const std::byte> from) {
    return Archive(Way::restore, nullptr, from.data(), from.size());
  }

  bool restores() const { return way_ == Way::restore; }
  std::size_t size() const { return done_; }  ///< Bytes so far.
  /// Returns the sum over all that was saved, and after it `others`.
  std::uint64_t sum_with(std::span<const std::byte> others) {
    add_to_sum();
    return sum_.with({to_ + summed_, done_ - summed_}, others);
  }

  template <class... T>
  void operator()(T&... values) {
    if constexpr ((is_dense<T> && ...))
      numbers(values...);
    else
      (one(values), ...);
  }
  /// Lists flags, and returns whether restoring has changed some.
  bool changes(Array<std::uint8_t>& flags) {
    const std::size_t size = count(flags.size());
    const bool are_other = restores() && (size != flags.size() ||
                                          (size > 0 && std::memcmp(flags.data(), from_ + done_, size) != 0));
    if (are_other) flags.resize(size);
    elements(flags.data(), size);
    return are_other;
  }

 private:
  enum class Way : std::uint8_t { measure, save, restore };
  static_assert(std::endian::native == std::endian::little, "numbers are stored as they lie in memory");
  static_assert(sizeof(Vec3) == 3 * sizeof(double));

  Archive(Way way, std::byte* to, const std::byte* from, std::size_t room)
      : way_(way), to_(to), from_(from), room_(room) {}

  /// Lists some numbers at once, which takes no call.
  template <class... T>
  void numbers(T&... of) {
    constexpr std::size_t count = (sizeof(T) + ...);
    if (way_ != Way::measure && count > room_ - done_) refuse_end();
    std::size_t at = done_;
    const auto list = [this, &at](auto& number) {
      if (way_ == Way::save) std::memcpy(to_ + at, &number, sizeof number);
      if (way_ == Way::restore) std::memcpy(&number, from_ + at, sizeof number);
      at += sizeof number;
    };
    (list(of), ...);
    done_ = at;
  }
  void bytes(void* of, std::size_t count);
  [[noreturn]] void refuse_end() const;

  /// So many bytes at once are summed up as they are copied. Fewer are summed up with the next that are many.
  static constexpr std::size_t many = 4 * ByteSum::block;
  void save_many(const std::byte* from, std::size_t count);
  void add_to_sum() { summed_ += sum_.add({to_ + summed_, done_ - summed_}); }

  template <class T>
  void one(T& value) {
    if constexpr (is_dense<T>)
      numbers(value);
    else if constexpr (requires { value.archive(*this); })
      value.archive(*this);
    else
      visit_members(*this, value);
  }
  void one(bool& value) {
    std::uint8_t byte = value ? 1 : 0;
    numbers(byte);
    value = byte != 0;
  }
  /// Counts never exceed the bytes that are left, so that nothing absurd is allocated.
  std::size_t count(std::size_t present) {
    std::uint64_t number = present;
    one(number);
    if (restores() && number > room_ - done_) refuse_end();
    return static_cast<std::size_t>(number);
  }
  template <class T>
  void elements(T* of, std::size_t size) {
    if constexpr (is_dense<T>) {
      if (size > 0) bytes(of, size * sizeof(T));
    } else {
      for (std::size_t i = 0; i < size; ++i) one(of[i]);
    }
  }
  template <class T, class Allocator>
  void one(std::vector<T, Allocator>& values) {
    const std::size_t size = count(values.size());
    if (restores() && size != values.size()) values.resize(size);
    elements(values.data(), size);
  }
  template <class T>
  void one(layouts::AlignedBuffer<T>& values) {
    const std::size_t size = count(values.size());
    if (restores() && size != values.size()) values = layouts::AlignedBuffer<T>(size);
    elements(values.data(), size);
  }
  template <class T, std::size_t n>
  void one(std::array<T, n>& values) {
    elements(values.data(), n);
  }
  template <class T>
  void one(std::optional<T>& value) {
    bool has = value.has_value();
    one(has);
    if (restores() && has != value.has_value()) has ? void(value.emplace()) : value.reset();
    if (has) one(*value);
  }
  template <class A, class B>
  void one(std::pair<A, B>& value) {
    one(value.first);
    one(value.second);
  }

  Way way_;
  std::byte* to_;
  const std::byte* from_;
  std::size_t room_, done_ = 0, summed_ = 0;
  ByteSum sum_;
};

/// Returns the bytes of what an archive lists of something.
template <class T>
Array<std::byte> saved(const T& from) {
  auto& of = const_cast<T&>(from);  // which is read alone
  Archive measured = Archive::measure();
  measured(of);
  Array<std::byte> bytes(measured.size());
  Archive save = Archive::save(bytes);
  save(of);
  return bytes;
}

/// Copies what an archive lists of something.
template <class T>
void copy_listed(const T& from, T& to) {
  const Array<std::byte> bytes = saved(from);
  Archive restored = Archive::restore(bytes);
  restored(to);
}

}  // namespace plumb::detail
