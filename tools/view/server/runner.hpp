#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "view/exhibit/exhibit.hpp"
#include "view/exhibit/replay.hpp"
#include "view/server/messages.hpp"
#include "view/server/pacing.hpp"

namespace plumb::view {

/// Takes what goes to the page. Both are called from the runner's thread.
struct Outlet {
  std::function<void(std::string)> text;   ///< A message, of which none may be lost.
  std::function<void(std::string)> frame;  ///< A frame, which the next may replace.
};

/// Runs an exhibit in real time in a thread of its own while a page watches it.
class Runner {
 public:
  Runner(Exhibit exhibit, Outlet outlet, std::optional<Replay> replay = {});
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
  using Clock = std::chrono::steady_clock;

  void run();
  bool wait(std::deque<std::string>& messages, bool& has_come);
  void greet();
  void obey(const std::string& message);
  void obey(const Request& request);
  void change(const Request& request);
  void show_worlds();
  void begin_again(Start start);
  void load(const Request& request);
  void set_speed(const Request& request);
  void change_sides(const Request& request);
  void step();
  void advance();
  void publish();
  bool is_replaying() const { return repeater_ && !repeater_->is_over(exhibit_); }

  Exhibit exhibit_;
  Outlet outlet_;
  std::optional<Repeater> repeater_;
  bool playing_ = true;
  Values values_ = Values::none;
  std::vector<Measured> measured_;
  std::uint64_t published_ = 0;
  double frame_us_ = 0;
  Pacing pacing_{frame_length, 1, Clock::now()};

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::string> messages_;  ///< Under mutex_, as the next three.
  bool is_watched_ = false;
  bool has_come_ = false;
  bool ends_ = false;
  std::thread thread_;  ///< It is the last member, so that all others are there when it starts.
};

}  // namespace plumb::view
