#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <memory>
#include <new>
#include <optional>
#include <utility>

#include "plumb/embedding/memory.hpp"
#include "plumb/layouts/memory.hpp"
#include "scene/refuse.hpp"
#include "step/memory/small_blocks.hpp"
#include "step/step.hpp"

namespace plumb::detail {

/// Gets the memory of a world where its settings say, and counts it. Small blocks stay with it until the
/// world ends. Several threads may use it at once.
class WorldMemory final : public Memory {
 public:
  explicit WorldMemory(MemoryResource* from) : from_(from) {}

  ~WorldMemory() {
    small_.end([&](void* at, std::size_t bytes) { give_back(at, bytes, SmallBlocks::grain); });
  }
  WorldMemory(const WorldMemory&) = delete;
  WorldMemory& operator=(const WorldMemory&) = delete;

  void* allocate(std::size_t bytes, std::size_t alignment) override {
    if (!SmallBlocks::has(bytes, alignment)) return get(bytes, alignment);
    bytes = SmallBlocks::rounded(bytes);
    for (;;) {
      if (void* const found = small_.take(bytes)) return found;
      add_large();
    }
  }
  void deallocate(void* at, std::size_t bytes, std::size_t alignment) noexcept override {
    if (!SmallBlocks::has(bytes, alignment)) return give_back(at, bytes, alignment);
    small_.put(at, SmallBlocks::rounded(bytes));
  }

  /// Returns how many bytes it has got, those included that are free at the moment.
  std::size_t held() const { return held_.load(std::memory_order_relaxed); }

  /// Refuses more bytes than `most` beside those that it holds, as long as this lives, and says that about
  /// `needed` would be needed.
  class Bound {
   public:
    Bound(WorldMemory& of, std::size_t most, std::size_t needed) : of_(of) {
      of.bound_ = {of.held(), most, needed};
    }
    ~Bound() { of_.bound_ = {}; }
    Bound(const Bound&) = delete;
    Bound& operator=(const Bound&) = delete;

   private:
    WorldMemory& of_;
  };

 private:
  void* get(std::size_t bytes, std::size_t alignment) {
    const std::size_t held = held_.fetch_add(bytes, std::memory_order_relaxed) + bytes;
    try {
      if (bound_ && held > bound_->held + bound_->most)
        refuse("the world takes more than most_memory, ", bound_->most, " bytes: about ", bound_->needed,
               " are needed");
      return from_ ? from_->allocate(bytes, alignment) : ::operator new (bytes, std::align_val_t{alignment});
    } catch (...) {
      held_.fetch_sub(bytes, std::memory_order_relaxed);
      throw;
    }
  }
  void give_back(void* at, std::size_t bytes, std::size_t alignment) noexcept {
    held_.fetch_sub(bytes, std::memory_order_relaxed);
    if (from_) return from_->deallocate(at, bytes, alignment);
    ::operator delete (at, std::align_val_t{alignment});
  }

  /// Gets a large block to cut small ones from: a share of what the world has, since little of it may be
  /// used.
  void add_large() {
    const std::size_t bytes =
        std::clamp(SmallBlocks::rounded(held() / 32), 2 * SmallBlocks::most, 32 * SmallBlocks::most);
    small_.add(get(bytes, SmallBlocks::grain), bytes);
  }

  MemoryResource* const from_;
  SmallBlocks small_;
  std::atomic<std::size_t> held_{0};
  struct Bytes {
    std::size_t held, most, needed;
  };
  std::optional<Bytes> bound_{};
};

/// Makes a step in a world's memory, of which it takes no more than Settings::most_memory.
inline std::unique_ptr<Step> make_step(WorldMemory& memory, std::shared_ptr<const Scene> scene,
                                       const Settings& settings) {
  const MemoryScope scope(&memory);
  std::optional<WorldMemory::Bound> bound;
  if (settings.most_memory) bound.emplace(memory, *settings.most_memory, estimate_memory(*scene, settings));
  return std::make_unique<Step>(std::move(scene), settings);
}

/// Owns a step of a world. What is called through it, and the step itself, have their memory from the
/// world's.
class StepInMemory {
 public:
  explicit StepInMemory(Memory& memory) : memory_(memory) {}

  class Call {
   public:
    Call(Step* step, Memory& memory) : scope_(&memory), step_(step) {}
    Step* operator->() const { return step_; }

   private:
    MemoryScope scope_;
    Step* step_;
  };

  Call operator->() const { return {step_.get(), memory_}; }
  const Step& operator*() const { return *step_; }  ///< for what reads alone and allocates nothing
  void operator=(std::unique_ptr<Step> step) { step_ = std::move(step); }

 private:
  Memory& memory_;
  std::unique_ptr<Step> step_;
};

}  // namespace plumb::detail
