#include "threads/team.hpp"

#include <algorithm>
#include <thread>
#include <utility>

#include "threads/flush_denormals.hpp"

namespace plumb::detail {
namespace {

/// Waits a little longer at every call. It first pauses inside the processor, then gives the core away, for
/// machines with fewer cores than threads.
class Spin {
 public:
  void wait() {
    if (++count_ < 4000) {
#if defined(__x86_64__) || defined(__i386__)
      __builtin_ia32_pause();
#elif defined(__aarch64__)
      asm volatile("yield");
#endif
    } else {
      std::this_thread::yield();
    }
  }

 private:
  unsigned count_ = 0;
};

}  // namespace

Team::Team(unsigned size) : size_(std::clamp(size, 1u, max_size)), lanes_(std::make_unique<Lane[]>(size_)) {}

void Team::lead_erased(Executor* executor, Program program, void* context) {
  if (executor == nullptr || size_ == 1) {
    const FlushDenormals flush;
    program(context);
    return;
  }
  program_ = program;
  program_context_ = context;
  memory_ = current_memory();
  has_leader_.store(false, std::memory_order_relaxed);
  finished_.store(false, std::memory_order_relaxed);
  helpers_.store(0, std::memory_order_relaxed);
  active_ = true;
  try {
    executor->run(
        size_, [](void* team, unsigned) { static_cast<Team*>(team)->task(); }, this);
  } catch (...) {
    failure_ = std::current_exception();
    if (!has_leader_.load(std::memory_order_acquire))
      task();  // the executor failed to run a task, and the program runs alone
  }
  active_ = false;
  if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
}

void Team::rethrow_failure() {
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

void Team::task() {
  const FlushDenormals flush;
  const MemoryScope scope(memory_);
  if (!has_leader_.exchange(true, std::memory_order_acq_rel)) {
    try {
      program_(program_context_);
    } catch (...) {
      thrown_ = std::current_exception();
    }
    finished_.store(true, std::memory_order_release);
  } else {
    help(helpers_.fetch_add(1, std::memory_order_relaxed) + 1);
  }
}

void Team::help(unsigned helper) {
  std::uint64_t seen = 0;
  Spin spin;
  while (!finished_.load(std::memory_order_acquire)) {
    const std::uint64_t phase = phase_.load(std::memory_order_acquire);
    if (phase == seen) {
      spin.wait();
      continue;
    }
    seen = phase;
    spin = {};
    for (unsigned k = 0; k < size_; ++k) try_part((helper + k) % size_, phase);
  }
}

bool Team::try_part(unsigned part, std::uint64_t phase) {
  // A claim succeeds only in the phase that is under way. Once a phase is over, all its parts bear its
  // number.
  std::uint64_t last = lanes_[part].claimed.load(std::memory_order_relaxed);
  if (last >= phase || !lanes_[part].claimed.compare_exchange_strong(last, phase, std::memory_order_acq_rel))
    return false;
  try {
    job_(job_context_, part);
  } catch (...) {
    if (!has_thrown_.exchange(true, std::memory_order_acq_rel)) thrown_by_part_ = std::current_exception();
  }
  parts_done_.fetch_add(1, std::memory_order_release);
  return true;
}

void Team::for_parts_erased(Job job, void* context) {
  if (!active_) {
    job(context, 0);
    return;
  }
  job_ = job;
  job_context_ = context;
  const std::uint64_t target = parts_done_.load(std::memory_order_relaxed) + size_;
  const std::uint64_t phase = phase_.load(std::memory_order_relaxed) + 1;
  phase_.store(phase, std::memory_order_release);
  for (unsigned part = 0; part < size_; ++part) try_part(part, phase);
  for (Spin spin; parts_done_.load(std::memory_order_acquire) != target;) spin.wait();
  if (has_thrown_.exchange(false, std::memory_order_acquire))
    std::rethrow_exception(std::exchange(thrown_by_part_, nullptr));
}

}  // namespace plumb::detail
