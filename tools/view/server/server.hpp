#pragma once

#include <memory>
#include <optional>
#include <string>

#include "view/exhibit/exhibit.hpp"
#include "view/inputs/replay.hpp"

namespace plumb::view {

/// Serves the page and its WebSocket on 127.0.0.1, for one page at a time.
class Server {
 public:
  /// Listens. `port` 0 takes one that is free. Throws InputError if the port cannot be had.
  Server(Exhibit exhibit, unsigned port, std::optional<Replay> replay = {});
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
