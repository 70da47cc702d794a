#pragma once

#include <memory>
#include <utility>

#include "plumb/executor.hpp"
#include "plumb/settings.hpp"
#include "threads/team.hpp"

namespace plumb::detail {

/// Holds the threads that settings ask for: a team on the caller's executor, or on one of its own if there is
/// more than one thread.
class Workers {
 public:
  explicit Workers(const Settings& settings)
      : own_(settings.executor || settings.threads == 1 ? nullptr : make_default_executor(settings.threads)),
        executor_(settings.executor ? settings.executor : own_.get()),
        team_(executor_ == nullptr ? 1
              : settings.threads   ? settings.threads
                                   : executor_->concurrency()) {}

  unsigned size() const { return team_.size(); }
  Team& team() { return team_; }

  /// Runs `program()`, which may share its work in team(). The other threads take part if `together`; else it
  /// runs alone.
  template <class Program>
  void lead(bool together, Program&& program) {
    team_.lead(together ? executor_ : nullptr, std::forward<Program>(program));
  }

 private:
  std::unique_ptr<Executor> own_;
  Executor* executor_;
  Team team_;
};

}  // namespace plumb::detail
