#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <memory>

#include "plumb/executor.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// Runs threads through a sequence of parallel phases with a spinning wait between them, on any Executor.
///
/// Whichever task of Executor::run starts first becomes the leader and runs a straight program, which calls
/// for_parts() where there is work to share. Other tasks help while it lasts and claim parts that nobody has
/// begun. The leader takes what is left. What a part throws, for_parts() throws in the program once all are
/// done, and what the program throws, lead() does.
///
/// Nobody ever waits for a task that has not started, so an executor that runs its tasks one after the other
/// only loses speed. Inside lead(), denormal numbers count as zero on every thread.
class Team {
 public:
  static constexpr unsigned max_size = 64;

  explicit Team(unsigned size);

  unsigned size() const { return size_; }

  /// Runs `program()` with up to size() threads of `executor`, or alone on this thread if `executor` is null.
  template <class Program>
  void lead(Executor* executor, Program&& program) {
    using P = std::remove_reference_t<Program>;
    lead_erased(
        executor, [](void* context) { (*static_cast<P*>(context))(); }, &program);
  }

  /// Throws what the executor threw in the last lead(), in which the program ran all the same.
  void rethrow_failure();

  /// Calls f(part) for every part in [0, parts()), in parallel, and returns when all are done. It may be
  /// called inside lead() only.
  template <class F>
  void for_parts(F&& f) {
    using G = std::remove_reference_t<F>;
    for_parts_erased([](void* context, unsigned part) { (*static_cast<G*>(context))(part); }, &f);
  }
  unsigned parts() const { return active_ ? size_ : 1; }

  /// Calls f(i, part) for every i in [0, n). Each part works through a range of its own, then helps others.
  /// No two calls with the same part run at once. It may be called inside lead() only.
  template <class F>
  void for_each(std::uint32_t n, F&& f) {
    const unsigned count = parts();
    for (unsigned part = 0; part < count; ++part)
      lanes_[part].next.store(begin_of(n, part, count), std::memory_order_relaxed);
    for_parts([&](unsigned part) {
      for (unsigned k = 0; k < count; ++k) {
        const unsigned victim = (part + k) % count;
        const std::uint32_t end = begin_of(n, victim + 1, count);
        for (std::uint32_t i; (i = lanes_[victim].next.fetch_add(1, std::memory_order_relaxed)) < end;)
          f(i, part);
      }
    });
  }

  /// Returns the first of n items that belongs to `part` of `count`.
  static std::uint32_t begin_of(std::uint32_t n, unsigned part, unsigned count) {
    return static_cast<std::uint32_t>(std::uint64_t{n} * part / count);
  }

 private:
  using Job = void (*)(void* context, unsigned part);
  using Program = void (*)(void* context);

  void lead_erased(Executor* executor, Program program, void* context);
  void for_parts_erased(Job job, void* context);
  void task();
  void help(unsigned helper);
  bool try_part(unsigned part, std::uint64_t phase);

  struct alignas(64) Lane {
    std::atomic<std::uint64_t> claimed{0};  ///< number of the last phase in which this part was taken
    std::atomic<std::uint32_t> next{0};     ///< next item of this part's range in for_each()
  };

  unsigned size_;
  std::exception_ptr failure_;         ///< what the executor threw
  std::exception_ptr thrown_;          ///< what the program threw
  std::exception_ptr thrown_by_part_;  ///< what the first part threw that did
  std::atomic<bool> has_thrown_{false};
  bool active_ = false;
  std::unique_ptr<Lane[]> lanes_;
  Memory* memory_ = nullptr;  ///< that of who leads, for all tasks
  Program program_ = nullptr;
  void* program_context_ = nullptr;
  Job job_ = nullptr;
  void* job_context_ = nullptr;
  std::atomic<bool> has_leader_{false};
  std::atomic<bool> finished_{false};
  std::atomic<unsigned> helpers_{0};
  alignas(64) std::atomic<std::uint64_t> phase_{0};
  alignas(64) std::atomic<std::uint64_t> parts_done_{0};
};

}  // namespace plumb::detail
