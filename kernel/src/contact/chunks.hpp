#pragma once

#include <cstddef>
#include <iterator>
#include <memory>
#include <type_traits>

#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// A list of large things. It grows by a chunk of them, so that it never moves them, and never holds two
/// copies or room for half as many again. Chunks stay when it is cleared.
template <class T>
class Chunks {
  static_assert(std::is_trivially_destructible_v<T>, "what is cleared is written over");

 public:
  bool empty() const { return size_ == 0; }
  std::size_t size() const { return size_; }
  void clear() { size_ = 0; }
  /// Appends a thing as it is when made, and returns it.
  T& add() {
    if (size_ == in_chunk * chunks_.size()) chunks_.push_back(std::make_unique<T[]>(in_chunk));
    T* const out = &chunks_[size_ / in_chunk][size_ % in_chunk];
    ++size_;
    return *std::construct_at(out);
  }

  template <class Value>
  class Iterator {
   public:
    using iterator_category = std::forward_iterator_tag;
    using value_type = T;
    using difference_type = std::ptrdiff_t;
    using pointer = Value*;
    using reference = Value&;

    Iterator(const std::unique_ptr<T[]>* chunk, std::size_t left) : next_(chunk), left_(left) { enter(); }
    Value& operator*() const { return *here_; }
    Iterator& operator++() {
      --left_;
      if (++here_ == end_) enter();
      return *this;
    }
    /// Iterators over one list are compared by how much is left.
    bool operator==(const Iterator& other) const { return left_ == other.left_; }

   private:
    void enter() {
      if (left_ == 0) return;
      here_ = next_++->get();
      end_ = here_ + in_chunk;
    }

    const std::unique_ptr<T[]>* next_;
    std::size_t left_;
    T *here_ = nullptr, *end_ = nullptr;
  };
  Iterator<T> begin() { return {chunks_.data(), size_}; }
  Iterator<T> end() { return {nullptr, 0}; }
  Iterator<const T> begin() const { return {chunks_.data(), size_}; }
  Iterator<const T> end() const { return {nullptr, 0}; }

 private:
  static constexpr std::size_t in_chunk = 16;

  Array<std::unique_ptr<T[]>> chunks_;
  std::size_t size_ = 0;
};

}  // namespace plumb::detail
