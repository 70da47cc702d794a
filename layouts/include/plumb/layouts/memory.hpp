#pragma once

#include <cstddef>
#include <vector>

namespace plumb {

/// Gives memory, and takes it back. What several threads fill must be safe to use from them.
class Memory {
 public:
  /// Gives `bytes` on a boundary of `alignment`, a power of two. May throw, std::bad_alloc as a rule.
  virtual void* allocate(std::size_t bytes, std::size_t alignment) = 0;
  /// Takes back what allocate() gave for the same numbers.
  virtual void deallocate(void* at, std::size_t bytes, std::size_t alignment) noexcept = 0;

 protected:
  ~Memory() = default;
};

/// Returns where arrays of this thread get their memory: that of the innermost scope, or none for the heap.
Memory* current_memory();

/// Lets arrays that this thread fills while the scope lives get their memory from `memory`, or from the heap
/// if it is none. Every array gives back what it has to where that came from, wherever it ends.
class MemoryScope {
 public:
  explicit MemoryScope(Memory* memory);
  ~MemoryScope();
  MemoryScope(const MemoryScope&) = delete;
  MemoryScope& operator=(const MemoryScope&) = delete;

 private:
  Memory* const before_;
};

/// Gives room for `bytes`, preceded by a note of where it came from. Throws std::bad_alloc, or what
/// Memory::allocate() throws.
void* allocate_noted(std::size_t bytes, std::size_t alignment);
/// Takes back what allocate_noted() gave for the same numbers, from any thread.
void deallocate_noted(void* at, std::size_t bytes, std::size_t alignment) noexcept;

/// Allocates from current_memory(). It holds nothing itself, so that arrays of different memory move and
/// swap.
template <class T>
struct NotingAllocator {
  using value_type = T;

  NotingAllocator() = default;
  template <class U>
  NotingAllocator(const NotingAllocator<U>&) noexcept {}  // NOLINT(google-explicit-constructor)

  T* allocate(std::size_t count) { return static_cast<T*>(allocate_noted(bytes(count), alignof(T))); }
  void deallocate(T* at, std::size_t count) noexcept { deallocate_noted(at, bytes(count), alignof(T)); }

  static std::size_t bytes(std::size_t count) {
    return count * sizeof(T);  // NOLINT(bugprone-sizeof-expression): of pointers, too
  }

  friend bool operator==(NotingAllocator, NotingAllocator) { return true; }
};

/// A std::vector whose memory is that of a world, or of whoever opened a MemoryScope.
template <class T>
using Array = std::vector<T, NotingAllocator<T>>;

/// Base of classes whose objects lie where arrays do. They may hold the widest vectors.
struct InMemory {
  static constexpr std::size_t boundary = 64;  ///< B
  static void* operator new(std::size_t bytes) { return allocate_noted(bytes, boundary); }
  static void operator delete(void* at, std::size_t bytes) noexcept { deallocate_noted(at, bytes, boundary); }
};

}  // namespace plumb
