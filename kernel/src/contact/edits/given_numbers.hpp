#pragma once

#include <cstdint>
#include <set>
#include <span>

#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// Gives numbers to islands that begin while a world runs: those that are given, or the lowest that are free.
class GivenNumbers {
 public:
  /// Lets the next islands have these numbers in turn, and what ended until now be free: places named it.
  void give(std::span<const std::uint32_t> numbers) {
    given_.assign(numbers.rbegin(), numbers.rend());
    made_.clear();
    free_.insert(ended_.begin(), ended_.end());
    ended_.clear();
  }
  /// Returns the numbers that were taken since.
  const Array<std::uint32_t>& made() const { return made_; }
  /// Takes the next number, of `count` islands that there are or that ended.
  std::uint32_t take(std::uint32_t count) {
    std::uint32_t number = free_.empty() ? count : *free_.begin();
    if (!given_.empty()) {
      number = given_.back();
      given_.pop_back();
    }
    for (; count < number; ++count) free_.insert(count);
    free_.erase(number);
    made_.push_back(number);
    return number;
  }
  /// Lets a number be free from the next give() on, or that of an island which never was.
  void end(std::uint32_t number) { ended_.push_back(number); }
  void add_free(std::uint32_t number) { free_.insert(number); }

 private:
  std::set<std::uint32_t> free_;
  Array<std::uint32_t> ended_, given_, made_;  ///< of those given the last comes first
};

}  // namespace plumb::detail
