#pragma once

#include <cstddef>
#include <iterator>
#include <memory>
#include <vector>

namespace plumb::detail {

/// A list of large things. It grows by a chunk of them, so that it never moves them, and never holds two
/// copies or room for half as many again. Chunks stay when it is cleared.
template <class T>
class Chunks {
 public:
  bool empty() const { return size_ == 0; }
  std::size_t size() const { return size_; }
  void clear() { size_ = 0; }
  /// Appends a thing as it is when made, and returns it.
  T& add() {
    if (size_ == in_chunk * chunks_.size()) chunks_.push_back(std::make_unique<T[]>(in_chunk));
    T& out = at(size_++);
    out = T{};
    return out;
  }

  template <class Of, class Value>
  class Iterator {
   public:
    using iterator_category = std::forward_iterator_tag;
    using value_type = T;
    using difference_type = std::ptrdiff_t;
    using pointer = Value*;
    using reference = Value&;

    Iterator(Of* of, std::size_t at) : of_(of), at_(at) {}
    Value& operator*() const { return of_->at(at_); }
    Iterator& operator++() {
      ++at_;
      return *this;
    }
    bool operator==(const Iterator&) const = default;

   private:
    Of* of_;
    std::size_t at_;
  };
  Iterator<Chunks, T> begin() { return {this, 0}; }
  Iterator<Chunks, T> end() { return {this, size_}; }
  Iterator<const Chunks, const T> begin() const { return {this, 0}; }
  Iterator<const Chunks, const T> end() const { return {this, size_}; }

 private:
  static constexpr std::size_t in_chunk = 16;

  T& at(std::size_t i) { return chunks_[i / in_chunk][i % in_chunk]; }
  const T& at(std::size_t i) const { return chunks_[i / in_chunk][i % in_chunk]; }

  std::vector<std::unique_ptr<T[]>> chunks_;
  std::size_t size_ = 0;
};

}  // namespace plumb::detail
