#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <thread>
#include <utility>

#if defined(__SANITIZE_ADDRESS__)
#define PLUMB_ADDRESSES_ARE_WATCHED 1
#elif defined(__has_feature)
#define PLUMB_ADDRESSES_ARE_WATCHED __has_feature(address_sanitizer)
#else
#define PLUMB_ADDRESSES_ARE_WATCHED 0
#endif

namespace plumb::detail {

/// Cuts small blocks from large ones, and keeps those that nobody needs for who needs some next, by their
/// sizes. Edits make and end small arrays again and again, which cost more to get from the heap than to
/// fill.
///
/// Several threads may use it at once. One waits for another, which holds it for some ten instructions.
class SmallBlocks {
 public:
  static constexpr std::size_t grain = 64;  ///< B: sizes are rounded up to it, and blocks aligned to it
#if PLUMB_ADDRESSES_ARE_WATCHED
  static constexpr std::size_t most = 0;  ///< What was given back is to be watched, not used again.
#else
  static constexpr std::size_t most = 4096;  ///< B: the largest of them
#endif

  static bool has(std::size_t bytes, std::size_t alignment) {
    return bytes <= most && alignment <= grain;
  }
  static std::size_t rounded(std::size_t bytes) {
    return (bytes + grain - 1) / grain * grain;
  }

  /// Returns a block of `bytes`, rounded, or nullptr if it has no more.
  void* take(std::size_t bytes) noexcept {
    const Hold hold(*this);
    Free*& first = first_[bytes / grain];
    if (Free* const found = first) {
      first = found->next;
      return found;
    }
    if (bytes > left_) return nullptr;
    left_ -= bytes;
    return std::exchange(rest_, rest_ + bytes);
  }
  /// Keeps a block of `bytes`, rounded, that take() gave.
  void put(void* at, std::size_t bytes) noexcept {
    const Hold hold(*this);
    keep(at, bytes);
  }
  /// Cuts from a large block from now on, whose first grain it needs itself, and keeps what is left of the
  /// last one.
  void add(void* large, std::size_t bytes) noexcept {
    const Hold hold(*this);
    large_ = ::new (large) Large{large_, bytes};
    while (left_ > 0) {
      const std::size_t piece = std::min(left_, most);
      keep(rest_, piece);
      rest_ += piece;
      left_ -= piece;
    }
    rest_ = static_cast<std::byte*>(large) + grain;
    left_ = bytes - grain;
  }
  /// Returns the large blocks to who gave them, of whose small ones none may be in use.
  template <typename GiveBack>
  void end(const GiveBack& give_back) {
    while (large_) {
      const Large large = *large_;
      give_back(large_, large.bytes);
      large_ = large.before;
    }
  }

 private:
  struct Free {
    Free* next;
  };
  struct Large {
    Large* before;
    std::size_t bytes;
  };
  class Hold {
   public:
    explicit Hold(SmallBlocks& of) : of_(of) {
      while (of.is_held_.test_and_set(std::memory_order_acquire)) std::this_thread::yield();
    }
    ~Hold() { of_.is_held_.clear(std::memory_order_release); }
    Hold(const Hold&) = delete;
    Hold& operator=(const Hold&) = delete;

   private:
    SmallBlocks& of_;
  };

  void keep(void* at, std::size_t bytes) noexcept {
    Free*& first = first_[bytes / grain];
    first = ::new (at) Free{first};
  }

  std::atomic_flag is_held_;
  std::array<Free*, most / grain + 1> first_{};  ///< [size / grain]
  Large* large_ = nullptr;                       ///< the large block that was added last
  std::byte* rest_ = nullptr;                    ///< of that
  std::size_t left_ = 0;                         ///< B of it
};

}  // namespace plumb::detail
