#include "view/server/runner.hpp"

#include <utility>

namespace plumb::view {

Runner::Runner(Exhibit exhibit, Outlet outlet, std::function<void()> done, std::optional<Replay> replay)
    : show_(std::move(exhibit), std::move(outlet), std::move(replay)),
      done_(std::move(done)),
      thread_([this] { run(); }) {}

Runner::~Runner() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void Runner::attach() {
  {
    const std::lock_guard lock(mutex_);
    is_watched_ = has_come_ = true;
  }
  changed_.notify_all();
}

void Runner::detach() {
  const std::lock_guard lock(mutex_);
  is_watched_ = false;
  messages_.clear();
}

void Runner::take(std::string message) {
  {
    const std::lock_guard lock(mutex_);
    messages_.push_back(std::move(message));
  }
  changed_.notify_all();
}

bool Runner::wait(std::deque<std::string>& messages, bool& has_come) {
  std::unique_lock lock(mutex_);
  const auto has_news = [&] { return ends_ || (is_watched_ && (has_come_ || !messages_.empty())); };
  if (is_watched_ && show_.is_playing())
    changed_.wait_until(lock, show_.due(), has_news);
  else
    changed_.wait(lock, has_news);
  messages.swap(messages_);
  has_come = std::exchange(has_come_, false);
  return !ends_;
}

void Runner::run() {
  std::deque<std::string> messages;
  bool has_come = false;
  while (wait(messages, has_come)) {
    const bool has_news = has_come || !messages.empty();
    if (has_come) show_.greet();
    for (const std::string& message : messages) {
      show_.obey(message);
      done_();
    }
    messages.clear();
    if (!show_.step_if_due() && has_news) show_.publish();
  }
}

}  // namespace plumb::view
