#include "plumb/layouts/memory.hpp"

#include <algorithm>
#include <utility>

namespace plumb {

static thread_local constinit Memory* current = nullptr;

namespace {

/// Bytes before what is given. They keep its alignment, and end with a note.
constexpr std::size_t margin_of(std::size_t alignment) {
  return std::max(alignment, alignof(std::max_align_t));
}

Memory*& note_of(void* given) {
  return static_cast<Memory**>(given)[-1];
}

}  // namespace

Memory* current_memory() {
  return current;
}

MemoryScope::MemoryScope(Memory* memory) : before_(std::exchange(current, memory)) {}
MemoryScope::~MemoryScope() {
  current = before_;
}

void* allocate_noted(std::size_t bytes, std::size_t alignment) {
  const std::size_t margin = margin_of(alignment);
  Memory* const from = current;
  void* const all = from ? from->allocate(margin + bytes, margin)
                         : ::operator new (margin + bytes, std::align_val_t{margin});
  void* const given = static_cast<std::byte*>(all) + margin;
  note_of(given) = from;
  return given;
}

void deallocate_noted(void* at, std::size_t bytes, std::size_t alignment) noexcept {
  if (!at) return;
  const std::size_t margin = margin_of(alignment);
  Memory* const from = note_of(at);
  void* const all = static_cast<std::byte*>(at) - margin;
  if (from) return from->deallocate(all, margin + bytes, margin);
  ::operator delete (all, std::align_val_t{margin});
}

}  // namespace plumb
