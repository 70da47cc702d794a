#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include "view/exhibit/exhibit.hpp"
#include "view/inputs/replay.hpp"

namespace plumb::view {

/// Says what a page may leave undone, as of a tab that sleeps, which reads nothing.
struct Limits {
  /// Frames that are on their way to it. More of them let a slow connection show every frame, and let a page
  /// that wakes begin longer ago.
  unsigned most_untaken = 8;
  /// Answers that wait until it reads, in bytes. It is not heard while there are more.
  std::size_t most_waiting_bytes = 16 << 20;
  /// A page that takes no frame for so long makes room for another one.
  std::chrono::milliseconds until_asleep{20'000};
};

/// Serves the page and its WebSocket on 127.0.0.1, for one page at a time.
class Server {
 public:
  /// Listens. `port` 0 takes one that is free. Throws InputError if the port cannot be had.
  Server(Exhibit exhibit, unsigned port, std::optional<Replay> replay = {}, const Limits& limits = {});
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  std::string address() const;
  unsigned port() const;
  /// Serves until stop(), or until Ctrl-C or SIGTERM where `ends_by_signal`.
  void run(bool ends_by_signal);
  /// Ends run(). Any thread may call it.
  void stop();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace plumb::view
