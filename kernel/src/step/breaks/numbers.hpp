#pragma once

#include <cstdint>
#include <span>
#include <utility>

#include "plumb/layouts/memory.hpp"
#include "scene/lists/by_kind.hpp"

namespace plumb::detail {

/// Gives numbers to what is added to a world, and takes back those of what is removed. They depend on what
/// was added and removed before alone.
///
/// The generation of a number is odd while something has it. It goes up by one as that is removed, and by one
/// as something else gets the number.
class Numbers {
 public:
  explicit Numbers(std::size_t count = 0) : count_(static_cast<std::uint32_t>(count)) {}

  /// Returns how many numbers there are, with those that nothing has.
  std::uint32_t count() const { return count_; }
  std::uint32_t generation(std::uint32_t number) const {
    return generations_.empty() ? 1 : generations_[number];
  }
  /// Returns those of all numbers; none while all are the first ones.
  std::span<const std::uint32_t> generations() const { return generations_; }
  bool has(std::uint32_t number) const { return generation(number) % 2 == 1; }
  /// Returns whether the first that ever had a number has it still.
  bool is_first(std::uint32_t number) const { return generation(number) == 1; }
  /// Calls f(number) for those that nothing has.
  template <class F>
  void for_free(F&& f) const {
    for (const auto& [first, size] : free_)
      for (std::uint32_t number = first; number < first + size; ++number) f(number);
  }

  /// Returns the first of so many numbers that nothing has, the lowest ones. The last may be new.
  std::uint32_t find(std::uint32_t size) const;
  /// Takes the numbers that find() has found.
  void take(std::uint32_t first, std::uint32_t size);
  /// Lets there be so many more numbers, which nothing has yet.
  void reserve(std::uint32_t size);
  /// Takes back numbers, which ascend.
  void give_back(std::span<const std::uint32_t> numbers);

  template <class Archive>
  void archive(Archive& archive) {
    auto& [count, generations, free] = *this;
    archive(count, generations);
    if (archive.restores()) list_free();
  }
  friend bool operator==(const Numbers& a, const Numbers& b) {
    return a.count_ == b.count_ && a.generations_ == b.generations_;
  }

 private:
  void list_free();

  std::uint32_t count_;
  Array<std::uint32_t> generations_;                     ///< by number; empty while all are the first ones
  Array<std::pair<std::uint32_t, std::uint32_t>> free_;  ///< ranges that ascend: first and size
};

/// Holds the numbers of all that may be added.
using Population = ByKind<Numbers>;
/// Returns the numbers of all that a scene has.
inline Population population_of(const Scene& scene) {
  const ByKind<std::uint32_t> sizes = sizes_of(scene);
  Population out;
  for (std::size_t kind = 0; kind < out.kinds; ++kind) *out.all()[kind] = Numbers(*sizes.all()[kind]);
  return out;
}

}  // namespace plumb::detail
