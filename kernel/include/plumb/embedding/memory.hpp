#pragma once

#include <cstddef>
#include <version>
#if defined(__cpp_lib_memory_resource)
#include <memory_resource>
#endif

#include "plumb/export.hpp"

namespace plumb {

struct Scene;
struct Settings;

#if defined(__cpp_lib_memory_resource)
/// What a world may get its memory from (Settings::memory).
using MemoryResource = std::pmr::memory_resource;
#else  // libc++ has none before its version 16
/// What a world may get its memory from (Settings::memory): std::pmr::memory_resource, where there is none.
class PLUMB_VISIBLE MemoryResource {
 public:
  virtual ~MemoryResource() = default;
  void* allocate(std::size_t bytes, std::size_t alignment) { return do_allocate(bytes, alignment); }
  void deallocate(void* at, std::size_t bytes, std::size_t alignment) { do_deallocate(at, bytes, alignment); }

 private:
  virtual void* do_allocate(std::size_t bytes, std::size_t alignment) = 0;
  virtual void do_deallocate(void* at, std::size_t bytes, std::size_t alignment) = 0;
  virtual bool do_is_equal(const MemoryResource& other) const noexcept = 0;
};
#endif

/// Returns about how many bytes the arrays of a world take when it begins (WorldInfo::memory), without making
/// it, under methods relax, direct and automatic. Worlds of the generators take from a fifth of it to all.
PLUMB_API std::size_t estimate_memory(const Scene& scene, const Settings& settings);

}  // namespace plumb
