// The server lets nobody in but its own page, listens on 127.0.0.1 alone, and outlives torn connections and
// sleepers.
#include "view/server/server.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "view/exhibits.hpp"
#include "view/server/access.hpp"

namespace plumb::view::PLUMB_TEST_FILE {
namespace {

TEST(ViewAccess, NeedsTokenHostAndOrigin) {
  const Door door{.token = make_token(), .port = 8123};
  EXPECT_EQ(door.token.size(), 32U);
  EXPECT_NE(make_token(), door.token);
  const std::string target = "/" + door.token + "/main.js";
  const auto reason = [&](const std::string& path, std::string_view host, std::string_view origin) {
    return refusal(door, {path, host, origin});
  };
  EXPECT_EQ(reason(target, "127.0.0.1:8123", ""), "");
  EXPECT_EQ(reason(target, "localhost:8123", "http://localhost:8123"), "");
  EXPECT_EQ(file_of(door, target), "main.js");
  EXPECT_EQ(file_of(door, "/" + door.token + "/"), "index.html");
  for (const std::string& path : {std::string("/"), std::string(), "/" + door.token, "/x" + target,
                                  "/" + std::string(32, '0') + "/main.js", door.token + "/"})
    EXPECT_NE(reason(path, "127.0.0.1:8123", ""), "") << path;
  for (const char* host :
       {"", "evil.example", "evil.example:8123", "127.0.0.1", "127.0.0.1:8124", "127.0.0.2:8123"})
    EXPECT_NE(reason(target, host, ""), "") << host;
  for (const char* origin : {"null", "http://evil.example", "https://127.0.0.1:8123", "http://127.0.0.1:80"})
    EXPECT_NE(reason(target, "127.0.0.1:8123", origin), "") << origin;
}

/// A connection by hand, so that it may misbehave.
class Visitor {
 public:
  explicit Visitor(unsigned port, const char* at = "127.0.0.1") : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    const timeval patience{10, 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    ::inet_pton(AF_INET, at, &address.sin_addr);
    connected_ = ::connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
  }
  ~Visitor() { leave(); }
  Visitor(const Visitor&) = delete;
  Visitor& operator=(const Visitor&) = delete;

  bool connected() const { return connected_; }
  void send(const std::string& text) const { (void)!::send(socket_, text.data(), text.size(), MSG_NOSIGNAL); }
  /// Reads until `end` has come, or nothing more does.
  std::string read(const std::string& end) const {
    std::string out;
    char byte = 0;
    while (out.find(end) == std::string::npos && ::recv(socket_, &byte, 1, 0) == 1) out += byte;
    return out;
  }
  /// Reads up to the next frame, and returns its number.
  std::uint32_t read_frame() const {
    (void)read("PLV2");
    std::uint32_t number = 0;
    EXPECT_EQ(::recv(socket_, &number, sizeof number, MSG_WAITALL), static_cast<ssize_t>(sizeof number));
    return number;
  }
  /// Says that it took a frame: an empty binary message, masked as all that a browser sends.
  void take() const { send({"\x82\x80\0\0\0\0", 6}); }
  /// Sends a request of fewer than 126 bytes.
  void ask(const std::string& text) const {
    send(std::string("\x81") + static_cast<char>(0x80 + text.size()) + std::string(4, '\0') + text);
  }
  /// Reads all that comes until nothing does for a while, and counts a text in it.
  std::size_t count(const std::string& text) const {
    const timeval patience{0, 500'000};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    std::string all;
    std::vector<char> bytes(1 << 16);
    for (ssize_t n = 0; (n = ::recv(socket_, bytes.data(), bytes.size(), 0)) > 0;)
      all.append(bytes.data(), static_cast<std::size_t>(n));
    std::size_t out = 0;
    for (std::size_t at = all.find(text); at != all.npos; at = all.find(text, at + 1)) ++out;
    return out;
  }
  /// Tears the connection, with a reset in place of a farewell.
  void leave() {
    if (socket_ < 0) return;
    const linger at_once{1, 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
    ::close(socket_);
    socket_ = -1;
  }

 private:
  int socket_;
  bool connected_ = false;
};

class ViewServer : public testing::Test {
 protected:
  explicit ViewServer(const Limits& limits = {})
      : server_(Exhibit(test::start_of("chain:links=4", {{.method = Method::direct}})), 0, {}, limits),
        thread_([this] { server_.run(false); }) {}
  ~ViewServer() override {
    server_.stop();
    thread_.join();
  }

  std::string token() const {
    const std::string address = server_.address();
    return address.substr(address.size() - 33, 32);
  }
  std::string host() const { return "127.0.0.1:" + std::to_string(server_.port()); }
  std::string get(const std::string& file, const std::string& headers = "") const {
    return "GET /" + token() + "/" + file + " HTTP/1.1\r\nHost: " + host() + "\r\n" + headers + "\r\n";
  }
  std::string upgrade() const {
    return get("socket",
               "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
               "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nOrigin: http://" +
                   host() + "\r\n");
  }
  /// Becomes the page, once whoever was it before is known to be gone.
  bool becomes_page() const {
    for (int i = 0; i < 100; ++i) {
      Visitor visitor(server_.port());
      visitor.send(upgrade());
      if (visitor.read("\r\n\r\n").find(" 101 ") == std::string::npos) return false;
      if (visitor.read("\"kind\":\"menu\"").find("menu") != std::string::npos) return true;
      ::usleep(20'000);
    }
    return false;
  }

  Server server_;
  std::thread thread_;
};

TEST_F(ViewServer, ServesItsPageAndRefusesOthers) {
  const auto status = [&](const std::string& request) {
    Visitor visitor(server_.port());
    visitor.send(request);
    return visitor.read("\r\n").substr(9, 3);
  };
  EXPECT_EQ(status(get("")), "200");
  EXPECT_EQ(status(get("main.js")), "200");
  EXPECT_EQ(status(get("../CMakeLists.txt")), "404");
  EXPECT_EQ(status(get("", "Origin: http://evil.example\r\n")), "403");
  EXPECT_EQ(status("GET / HTTP/1.1\r\nHost: " + host() + "\r\n\r\n"), "403");
  EXPECT_EQ(status("GET /" + token() + "/ HTTP/1.1\r\nHost: evil.example\r\n\r\n"), "403");
  EXPECT_EQ(status("POST /" + token() + "/ HTTP/1.1\r\nHost: " + host() + "\r\nContent-Length: 0\r\n\r\n"),
            "405");
  std::string foreign = upgrade();
  foreign.replace(foreign.find("Origin: http://127.0.0.1"), 24, "Origin: http://10.0.0.10");
  EXPECT_EQ(status(foreign), "403");
}

TEST_F(ViewServer, ListensOnOneAddressAlone) {
  EXPECT_TRUE(Visitor(server_.port()).connected());
  EXPECT_FALSE(Visitor(server_.port(), "127.0.0.2").connected());
  std::ifstream table("/proc/net/tcp");
  if (!table) GTEST_SKIP() << "there is no /proc/net/tcp";
  char port[8];
  std::snprintf(port, sizeof port, ":%04X", server_.port());
  int listening = 0;
  for (std::string line; std::getline(table, line);) {
    if (line.find(port) == std::string::npos || line.find(" 0A ") == std::string::npos) continue;
    ++listening;
    EXPECT_NE(line.find(std::string("0100007F") + port), std::string::npos) << line;
  }
  EXPECT_EQ(listening, 1);
}

TEST_F(ViewServer, OutlivesTornConnectionsAndTurnsSecondPagesAway) {
  {
    Visitor page(server_.port());
    page.send(upgrade());
    EXPECT_NE(page.read("\"kind\":\"menu\"").find(" 101 "), std::string::npos);
    Visitor second(server_.port());
    second.send(upgrade());
    EXPECT_NE(second.read("Another page").find("Another page"), std::string::npos);
    EXPECT_NE(page.read("PLV2").find("PLV2"), std::string::npos) << "the first page goes on";
    Visitor half(server_.port());
    half.send("GET /" + token());
    half.leave();
    Visitor noise(server_.port());
    noise.send("\x16\x03\x01\r\n\r\n");
    page.leave();
  }
  EXPECT_TRUE(becomes_page()) << "a page may come after one that was torn away";
  Visitor visitor(server_.port());
  visitor.send(get(""));
  EXPECT_NE(visitor.read("</html>").find("<canvas"), std::string::npos);
}

TEST_F(ViewServer, HandsWorldsToAPageThatTakesOver) {
  std::string request = upgrade();
  request.replace(request.find("/socket"), 7, "/takeover");
  std::string foreign = request;
  foreign.replace(foreign.find(token()), 32, std::string(32, '0'));
  Visitor first(server_.port());
  first.send(upgrade());
  (void)first.read("PLV2");
  Visitor stranger(server_.port());
  stranger.send(foreign);
  EXPECT_EQ(stranger.read("\r\n").substr(9, 3), "403");
  EXPECT_NE(first.read("PLV2").find("PLV2"), std::string::npos) << "it is not disturbed";
  Visitor second(server_.port());
  second.send(request);
  EXPECT_NE(second.read("\"kind\":\"menu\"").find(" 101 "), std::string::npos);
  EXPECT_NE(second.read("PLV2").find("PLV2"), std::string::npos) << "it is the page now";
  EXPECT_NE(first.read("another tab now").find("another tab now"), std::string::npos) << "the first is told";
  Visitor third(server_.port());
  third.send(upgrade());
  EXPECT_NE(third.read("Another page").find("Another page"), std::string::npos);
}

// A reader of JSON quotes what it could not read, which may be a part of a character.
TEST_F(ViewServer, TellsWhyAFileOfAnotherKindIsNoScene) {
  Visitor page(server_.port());
  page.send(upgrade());
  (void)page.read("\"kind\":\"menu\"");
  for (const std::string file : {"\ufffdPNG\ufffd", "\u00e9lan", "GIF89a"}) {
    page.ask(R"({"do":"load","name":"x","value":")" + file + "\"}");
    EXPECT_NE(page.read("not JSON").find("x: not JSON"), std::string::npos) << file;
  }
}

constexpr Limits of_sleepers{
    .most_untaken = 4, .most_waiting_bytes = 16'384, .until_asleep = std::chrono::milliseconds(200)};

class ViewServerOfSleepers : public ViewServer {
 protected:
  ViewServerOfSleepers() : ViewServer(of_sleepers) {}
};

// A page that takes nothing for half a second, 30 frames, is sent four of them. Then the latest comes, not
// the fifth.
TEST_F(ViewServerOfSleepers, AreSentFewFramesAndThenThePresent) {
  Visitor page(server_.port());
  page.send(upgrade());
  std::uint32_t last = 0;
  for (unsigned i = 0; i < of_sleepers.most_untaken; ++i) last = page.read_frame();
  ::usleep(500'000);
  page.take();
  const std::uint32_t present = page.read_frame();
  EXPECT_GT(present, last + 5) << "frames came that it had not asked for";
  for (unsigned i = 0; i < of_sleepers.most_untaken; ++i) page.take();
  EXPECT_LE(page.read_frame(), present + 30) << "it goes on frame by frame";
}

TEST_F(ViewServerOfSleepers, MakeRoomForOthers) {
  Visitor asleep(server_.port());
  asleep.send(upgrade());
  for (unsigned i = 0; i < of_sleepers.most_untaken; ++i) (void)asleep.read_frame();
  ::usleep(400'000);
  Visitor other(server_.port());
  other.send(upgrade());
  EXPECT_NE(other.read("PLV2").find("\"kind\":\"menu\""), std::string::npos) << "it is the page now";
  EXPECT_EQ(asleep.count("PLV2"), 0u);
}

// Answers of some 17 MB are more than connections hold, and far more than may wait.
TEST_F(ViewServerOfSleepers, GetAllAnswersOnceTheyRead) {
  Visitor page(server_.port());
  page.send(upgrade());
  (void)page.read_frame();
  constexpr std::size_t asked = 10'000;
  for (std::size_t i = 0; i < asked; ++i) page.ask(R"({"do": "record"})");
  ::usleep(500'000);
  EXPECT_EQ(page.count("\"kind\":\"replay\""), asked);
}

}  // namespace
}  // namespace plumb::view::PLUMB_TEST_FILE
