#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "view/server/show.hpp"

namespace plumb::view {

/// Runs a show in a thread of its own while a page watches it. The outlet is called from that thread, and so
/// is `done` after each message.
class Runner {
 public:
  Runner(Exhibit exhibit, Outlet outlet, std::function<void()> done, std::optional<Replay> replay = {});
  ~Runner();
  Runner(const Runner&) = delete;
  Runner& operator=(const Runner&) = delete;

  /// A page has come. It is told everything; then worlds run on if they did.
  void attach();
  /// It has gone. Worlds stand still until another comes.
  void detach();
  /// Takes a message of the page. What is wrong with it is told to the page.
  void take(std::string message);

 private:
  void run();
  bool wait(std::deque<std::string>& messages, bool& has_come);

  Show show_;  ///< Of the thread alone.
  std::function<void()> done_;

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::string> messages_;  ///< Under mutex_, as the next three.
  bool is_watched_ = false;
  bool has_come_ = false;
  bool ends_ = false;
  std::thread thread_;  ///< It is the last member, so that all others are there when it starts.
};

}  // namespace plumb::view
