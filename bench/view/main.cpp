// What plumb view costs beside the kernel, with a client in place of a browser: frames a second, the kernel's
// share against that of the same steps without a page, and the time of a frame from the kernel through the
// socket.
#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "scenes/basics/clock.hpp"
#include "scenes/spec.hpp"
#include "view/exhibit/exhibit.hpp"
#include "view/server/messages.hpp"
#include "view/server/server.hpp"

namespace plumb::view {
namespace {

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

/// A WebSocket's client, as far as measuring needs one.
class Client {
 public:
  explicit Client(const Server& server) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(server.port()));
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (::connect(socket_, reinterpret_cast<sockaddr*>(&to), sizeof to) != 0)
      throw std::runtime_error("connect");
    const std::string address = server.address();
    const std::string request =
        "GET /" + address.substr(address.size() - 33) +
        "socket HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(server.port()) +
        "\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n";
    if (::send(socket_, request.data(), request.size(), 0) < 0) throw std::runtime_error("send");
    std::string head;
    while (!head.ends_with("\r\n\r\n")) {
      head.push_back(0);
      receive(head.data() + head.size() - 1, 1);
    }
  }
  ~Client() { ::close(socket_); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  /// Returns the next frame, and the seconds from its first byte to its last. Says that it took the frame, as
  /// a page does.
  std::string frame(double& seconds) {
    for (;;) {
      std::array<unsigned char, 2> head{};
      receive(head.data(), head.size());
      const scenes::Clock::time_point start = scenes::Clock::now();
      std::string message(length(head[1] & 127U), '\0');
      receive(message.data(), message.size());
      seconds = scenes::seconds_since(start);
      if ((head[0] & 15U) != 2) continue;
      static constexpr std::array<unsigned char, 6> empty_binary_message = {0x82, 0x80};
      if (::send(socket_, empty_binary_message.data(), empty_binary_message.size(), 0) < 0)
        throw std::runtime_error("send");
      return message;
    }
  }

 private:
  std::size_t length(unsigned short_length) {
    if (short_length < 126) return short_length;
    std::array<unsigned char, 8> bytes{};
    const std::size_t count = short_length == 126 ? 2 : 8;
    receive(bytes.data(), count);
    std::size_t out = 0;
    for (std::size_t i = 0; i < count; ++i) out = out * 256 + bytes[i];
    return out;
  }
  void receive(void* to, std::size_t count) const {
    if (count > 0 && ::recv(socket_, to, count, MSG_WAITALL) != static_cast<ssize_t>(count))
      throw std::runtime_error("the server is gone");
  }

  int socket_;
};

template <class Number>
Number read(const std::string& frame, std::size_t at) {
  Number out{};
  std::memcpy(&out, frame.data() + at, sizeof out);
  return out;
}

struct Seen {
  double frames_per_second = 0;
  double pace = 0;       ///< Simulated seconds per second.
  double step_ms = 0;    ///< Median of steps, as frames have it.
  double encode_ms = 0;  ///< Median from the end of a step to its bytes.
  double socket_ms = 0;  ///< Median from a frame's first byte to its last, at the client.
  double bytes = 0;
  std::uint32_t frames = 0;  ///< Steps until the last frame.
};

Seen watch(const Start& start, double seconds) {
  Server server(Exhibit(start), 0);
  std::thread thread([&] { server.run(false); });
  Seen out;
  try {
    Client client(server);
    std::vector<double> steps, encoded, sent;
    scenes::Clock::time_point begin = scenes::Clock::now();
    std::uint32_t first = 0;
    double count = 0;
    while (first == 0 || scenes::seconds_since(begin) < seconds) {
      double socket = 0;
      const std::string frame = client.frame(socket);
      out.frames = read<std::uint32_t>(frame, 4);
      if (out.frames == 0) continue;
      if (first == 0) {
        begin = scenes::Clock::now();
        first = out.frames;
        continue;
      }
      steps.push_back(read<float>(frame, 28) * 1e-3);
      encoded.push_back(read<float>(frame, 32) * 1e-3);
      sent.push_back(socket * 1e3);
      out.bytes = static_cast<double>(frame.size());
      ++count;
    }
    const double passed = scenes::seconds_since(begin);
    out.frames_per_second = count / passed;
    out.pace = (out.frames - first) * frame_length / passed;
    out.step_ms = median(steps);
    out.encode_ms = median(encoded);
    out.socket_ms = median(sent);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
  }
  server.stop();
  thread.join();
  return out;
}

/// Returns the median of the same steps without a page, in ms: one after the other as plumb run takes them,
/// or each at its time. Caches and processors cool down in between.
double alone(const Start& start, std::uint32_t frames, bool at_its_time) {
  World world(start.scene, start.sides.front().settings);
  std::vector<double> steps;
  for (std::uint32_t i = 0; i < frames; ++i) {
    const scenes::Clock::time_point begin = scenes::Clock::now();
    world.step(frame_length);
    steps.push_back(1e3 * scenes::seconds_since(begin));
    if (at_its_time) std::this_thread::sleep_until(begin + std::chrono::duration<double>(frame_length));
  }
  return median(steps);
}

void show(const char* name, const Settings& settings, double seconds) {
  const Start start{.name = name, .scene = scenes::load_scene(name), .sides = {{"world", settings}}};
  const Seen seen = watch(start, seconds);
  const double paced = alone(start, seen.frames, true);
  std::printf("| `%s` | %zu | %.1f | %.3f | %.3f | %.3f | %+.1f %% | %.3f | %.3f | %.3f |\n", name,
              start.scene.particles.size(), seen.frames_per_second, seen.pace, seen.step_ms, paced,
              100 * (seen.step_ms / paced - 1), alone(start, seen.frames, false), seen.encode_ms,
              seen.socket_ms);
  std::fflush(stdout);
}

}  // namespace
}  // namespace plumb::view

int main(int count, char** arguments) {
  using plumb::Method;
  const double seconds = count > 1 ? std::stod(arguments[1]) : 6;
  std::printf(
      "| scene | particles | frames/s | simulated s per s | step, ms | at 60 Hz without a page, ms | "
      "difference | without pauses, ms | to bytes, ms | socket, ms "
      "|\n|---|---|---|---|---|---|---|---|---|---|\n");
  const plumb::Settings relaxed{.method = Method::relax, .substeps = 4, .stop = {.sweeps = 10}};
  const plumb::Settings automatic{};
  plumb::view::show("crowd:humanoids=1000,hit=1000", automatic, seconds);
  plumb::view::show("ensemble:chains=1000,links=32", relaxed, seconds);
  plumb::view::show("ensemble:chains=1000,links=32", automatic, seconds);
  plumb::view::show("ensemble:chains=3125,links=31", relaxed, seconds);
  return 0;
}
