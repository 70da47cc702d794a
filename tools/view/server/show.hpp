#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "view/exhibit/exhibit.hpp"
#include "view/inputs/replay.hpp"
#include "view/server/messages.hpp"
#include "view/server/pacing.hpp"

namespace plumb::view {

/// Takes what goes to the page.
struct Outlet {
  std::function<void(std::string)> text;   ///< A message, of which none may be lost.
  std::function<void(std::string)> frame;  ///< A frame, which the next may replace.
};

/// Shows an exhibit to a page in real time: it answers messages and steps worlds when frames are due. It has
/// no thread. A server's runner gives it one, and in WebAssembly the page does.
class Show {
 public:
  Show(Exhibit exhibit, Outlet outlet, std::optional<Replay> replay = {});

  /// A page has come. It is told everything.
  void greet();
  /// Does what a message asks for. What is wrong with it is told to the page.
  void obey(const std::string& message);
  /// Takes the next frame and publishes it, if worlds run and it is due. Returns whether it did.
  bool step_if_due();
  /// Sends a frame of now.
  void publish();

  bool is_playing() const { return playing_; }
  Pacing::Time due() const { return pacing_.due(); }  ///< When the next frame is due, if worlds run.

 private:
  using Clock = std::chrono::steady_clock;
  struct Worlds {
    std::vector<SideStart> now, at_first;  ///< With the settings of now, and before any was set.
  };

  void obey(const Request& request);
  void change(const Request& request);
  void show_worlds();
  void begin_again(Start start);
  void begin_with(Start start);
  void load(const Request& request);
  void set_speed(const Request& request);
  void change_sides(const Request& request);
  void step();
  void advance();
  bool is_replaying() const { return repeater_ && !repeater_->is_over(exhibit_); }

  Exhibit exhibit_;
  Start original_ = exhibit_.start();  ///< Of the scene and the comparison, before anything was set.
  /// Worlds that were chosen, while a scene is shown by one world since it cannot well be by them.
  std::optional<Worlds> aside_{};
  Outlet outlet_;
  std::optional<Repeater> repeater_;
  bool playing_ = true;
  Values values_ = Values::none;
  std::vector<Measured> measured_;
  std::uint64_t published_ = 0;
  double frame_us_ = 0;  ///< What the last frame took to be measured and encoded.
  Pacing pacing_{frame_length, 1, Clock::now()};
};

}  // namespace plumb::view
