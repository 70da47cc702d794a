#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <new>
#include <optional>
#include <utility>

#include "plumb/embedding/memory.hpp"
#include "plumb/layouts/memory.hpp"
#include "scene/refuse.hpp"
#include "step/step.hpp"

namespace plumb::detail {

/// Gets the memory of a world where its settings say, and counts it. Several threads may use it at once.
class WorldMemory final : public Memory {
 public:
  explicit WorldMemory(MemoryResource* from) : from_(from) {}

  void* allocate(std::size_t bytes, std::size_t alignment) override {
    const std::size_t held = held_.fetch_add(bytes, std::memory_order_relaxed) + bytes;
    try {
      if (most_ && held > *most_)
        refuse("the world takes more than most_memory, ", *most_, " bytes: about ", needed_, " are needed");
      return from_ ? from_->allocate(bytes, alignment) : ::operator new (bytes, std::align_val_t{alignment});
    } catch (...) {
      held_.fetch_sub(bytes, std::memory_order_relaxed);
      throw;
    }
  }
  void deallocate(void* at, std::size_t bytes, std::size_t alignment) noexcept override {
    held_.fetch_sub(bytes, std::memory_order_relaxed);
    if (from_) return from_->deallocate(at, bytes, alignment);
    ::operator delete (at, std::align_val_t{alignment});
  }

  std::size_t held() const { return held_.load(std::memory_order_relaxed); }  ///< bytes
  /// Refuses to hold more bytes than `most` from now on, and says that about `needed` would be needed.
  void bound(std::size_t most, std::size_t needed) {
    most_ = most;
    needed_ = needed;
  }
  void end_bound() { most_ = {}; }

 private:
  MemoryResource* const from_;
  std::atomic<std::size_t> held_{0};
  std::optional<std::size_t> most_{};
  std::size_t needed_ = 0;
};

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
  void make(std::shared_ptr<const Scene> scene, const Settings& settings) {
    const MemoryScope scope(&memory_);
    step_ = std::make_unique<Step>(std::move(scene), settings);
  }
  void operator=(std::unique_ptr<Step> step) { step_ = std::move(step); }

 private:
  Memory& memory_;
  std::unique_ptr<Step> step_;
};

}  // namespace plumb::detail
