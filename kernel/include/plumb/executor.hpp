#pragma once

#include <memory>

#include "plumb/export.hpp"

namespace plumb {

/// Runs a task on several threads. An engine passes its own job system by deriving from this class.
///
/// Contract: `run(n, task, context)` calls task(context, i) exactly once for every i in [0, n), in any order,
/// on any threads. It returns when all calls have returned. The calls may run one after the other: plumb's
/// tasks never wait for a task that has not started, so an executor with one thread cannot deadlock them.
/// `run` is never called from inside a task. Results do not depend on the executor.
///
/// A world calls its executor from the thread that steps it. Worlds that step at the same time may share one
/// executor only if its `run` may be called from several threads at once; the built-in one may.
class PLUMB_API Executor {
 public:
  /// This is the type of what is run: a function of a context and of an index.
  using Task = void (*)(void* context, unsigned index);

  virtual ~Executor() = default;
  /// Returns the number of tasks that are expected to run at once, at least 1.
  virtual unsigned concurrency() const = 0;
  /// Calls `task` for every index below `n`, as the contract says.
  virtual void run(unsigned n, Task task, void* context) = 0;
};

/// Makes the built-in executor. It has `threads` workers, the caller included; 0 takes all hardware threads.
/// It runs on oneTBB. A plumb that was built without (CMake's PLUMB_TBB=OFF) keeps threads of its own, which
/// sleep between runs, and takes the runs of several callers one after the other.
PLUMB_API std::unique_ptr<Executor> make_default_executor(unsigned threads = 0);

}  // namespace plumb
