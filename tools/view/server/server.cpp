#include "view/server/server.hpp"

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <deque>
#include <utility>

#include "plumb/error.hpp"
#include "view/server/access.hpp"
#include "view/server/page_files.hpp"
#include "view/server/runner.hpp"

namespace plumb::view {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using Error = boost::system::error_code;

/// A dropped file may be so large, in bytes.
constexpr std::size_t largest_message = 32 << 20;
/// Requests that may be under way to the worlds; the next are read when these are done.
constexpr unsigned most_requests = 64;

/// The socket of a page that takes the place of the one that is there.
constexpr std::string_view takeover = "takeover";

std::string_view view_of(beast::string_view text) {
  return {text.data(), text.size()};
}

std::string_view type_of(std::string_view file) {
  if (file.ends_with(".html")) return "text/html; charset=utf-8";
  if (file.ends_with(".css")) return "text/css; charset=utf-8";
  if (file.ends_with(".js")) return "text/javascript; charset=utf-8";
  if (file.ends_with(".svg")) return "image/svg+xml";
  return "application/octet-stream";
}

/// The page as a WebSocket. One message is written at a time; of frames that wait only the latest is kept. A
/// tab that sleeps reads nothing: few frames are on their way to it, so that it goes on at the present when
/// it wakes.
class Page : public std::enable_shared_from_this<Page> {
 public:
  Page(tcp::socket socket, const Limits& limits, std::function<void(std::string)> heard,
       std::function<void(Page*)> gone)
      : socket_(std::move(socket)), limits_(limits), heard_(std::move(heard)), gone_(std::move(gone)) {}

  template <class Opened>
  void open(const http::request<http::string_body>& request, Opened opened) {
    // There are no pings: a tab that sleeps cannot answer them, and on one machine a torn connection says so.
    socket_.set_option(
        websocket::stream_base::timeout{std::chrono::seconds(10), websocket::stream_base::none(), false});
    socket_.read_message_max(largest_message);
    socket_.auto_fragment(false);  // else a large frame goes out 4 kB at a time
    socket_.async_accept(request, [self = shared_from_this(), opened](Error error) {
      if (error) return;
      opened(self);
      self->listen();
    });
  }

  void send_text(std::string text) {
    waiting_bytes_ += text.size();
    texts_.push_back(std::move(text));
    write();
  }
  void send_frame(std::string frame) {
    frame_ = std::move(frame);
    write();
  }
  /// A request has been done.
  void count_done() {
    if (requests_ > 0) --requests_;
    listen();
  }
  /// Whether frames lie untaken for so long that the page is taken for one that sleeps.
  bool sleeps() const { return untaken_ > 0 && Clock::now() - untaken_since_ > limits_.until_asleep; }
  void refuse(const std::string& reason) {
    is_refused_ = true;
    socket_.async_close(websocket::close_reason(websocket::close_code::try_again_later, reason),
                        [self = shared_from_this()](Error) {});
  }
  void close() {
    Error ignored;
    beast::get_lowest_layer(socket_).socket().close(ignored);
  }

 private:
  using Clock = std::chrono::steady_clock;

  /// Whoever asks and does not read is not heard until it has read, so that answers do not pile up.
  void listen() {
    if (is_listening_ || requests_ >= most_requests || waiting_bytes_ > limits_.most_waiting_bytes) return;
    is_listening_ = true;
    socket_.async_read(buffer_, [self = shared_from_this()](Error error, std::size_t) {
      if (error) return self->end();
      self->is_listening_ = false;
      self->hear();
      self->listen();
    });
  }

  /// Takes what was read. A binary message says that the page took a frame.
  void hear() {
    if (socket_.got_binary()) {
      if (untaken_ > 0) --untaken_;
      untaken_since_ = Clock::now();
      write();
    } else if (!is_refused_) {
      ++requests_;
      heard_(beast::buffers_to_string(buffer_.data()));
    }
    buffer_.consume(buffer_.size());
  }

  void write() {
    const bool is_text = !texts_.empty();
    const bool is_frame = !is_text && !frame_.empty() && untaken_ < limits_.most_untaken;
    if (is_writing_ || is_refused_ || !(is_text || is_frame)) return;
    is_writing_ = true;
    if (is_text) {
      written_ = std::move(texts_.front());
      texts_.pop_front();
      waiting_bytes_ -= written_.size();
    } else {
      written_ = std::exchange(frame_, {});
      if (untaken_++ == 0) untaken_since_ = Clock::now();
    }
    socket_.text(is_text);
    socket_.async_write(asio::buffer(written_), [self = shared_from_this()](Error error, std::size_t) {
      if (error) return self->end();
      self->is_writing_ = false;
      self->write();
      self->listen();
    });
  }

  void end() {
    if (!std::exchange(has_ended_, true)) gone_(this);
  }

  websocket::stream<beast::tcp_stream> socket_;
  Limits limits_;
  std::function<void(std::string)> heard_;
  std::function<void(Page*)> gone_;
  beast::flat_buffer buffer_;
  std::deque<std::string> texts_;
  std::size_t waiting_bytes_ = 0;  ///< Size of all texts that wait.
  std::string frame_, written_;
  unsigned requests_ = 0;  ///< Requests that worlds have not done.
  unsigned untaken_ = 0;   ///< Frames that were written and of which the page has not said that it took them.
  Clock::time_point untaken_since_{};  ///< When it took one, or when the first of them was written.
  bool is_writing_ = false, is_listening_ = false, is_refused_ = false, has_ended_ = false;
};

/// A connection that asks for a file, or to become the page's WebSocket.
class Visitor : public std::enable_shared_from_this<Visitor> {
 public:
  using Upgrade = std::function<void(tcp::socket, http::request<http::string_body>)>;

  Visitor(tcp::socket socket, const Door& door, Upgrade upgrade)
      : stream_(std::move(socket)), door_(door), upgrade_(std::move(upgrade)) {}

  void read() {
    request_ = {};
    stream_.expires_after(std::chrono::seconds(30));
    http::async_read(stream_, buffer_, request_, [self = shared_from_this()](Error error, std::size_t) {
      if (!error) self->answer();
    });
  }

 private:
  void answer() {
    const std::string target(view_of(request_.target()));
    const std::string reason = refusal(door_, {.target = target,
                                               .host = view_of(request_[http::field::host]),
                                               .origin = view_of(request_[http::field::origin])});
    if (!reason.empty()) return send(http::status::forbidden, reason + "\n", "text/plain; charset=utf-8");
    if (request_.method() != http::verb::get)
      return send(http::status::method_not_allowed, "Files are read only.\n", "text/plain; charset=utf-8");
    const std::string_view name = file_of(door_, target);
    if ((name == "socket" || name == takeover) && websocket::is_upgrade(request_)) {
      stream_.expires_never();
      return upgrade_(stream_.release_socket(), std::move(request_));
    }
    for (const PageFile& file : page_files())
      if (file.name == name) return send(http::status::ok, file.text, type_of(name));
    send(http::status::not_found, "There is no such file here.\n", "text/plain; charset=utf-8");
  }

  void send(http::status status, std::string_view body, std::string_view type) {
    response_ = {status, request_.version()};
    response_.set(http::field::content_type, beast::string_view(type.data(), type.size()));
    response_.set(http::field::cache_control, "no-store");
    response_.set("Referrer-Policy", "no-referrer");
    response_.set("X-Content-Type-Options", "nosniff");
    response_.set("Content-Security-Policy",
                  "default-src 'self'; img-src 'self' data:; connect-src 'self' ws://127.0.0.1:" +
                      std::to_string(door_.port) + " ws://localhost:" + std::to_string(door_.port) +
                      "; style-src 'self' 'unsafe-inline'");
    response_.keep_alive(request_.keep_alive());
    response_.body() = std::string(body);
    response_.prepare_payload();
    http::async_write(stream_, response_, [self = shared_from_this()](Error error, std::size_t) {
      if (!error && self->response_.keep_alive()) self->read();
    });
  }

  beast::tcp_stream stream_;
  const Door& door_;
  Upgrade upgrade_;
  beast::flat_buffer buffer_;
  http::request<http::string_body> request_;
  http::response<http::string_body> response_;
};

}  // namespace

struct Server::Impl {
  explicit Impl(const Limits& limits_of_pages) : limits(limits_of_pages) {}

  Limits limits;
  asio::io_context context{1};
  tcp::acceptor acceptor{context};
  Door door;
  std::shared_ptr<Page> page;
  std::unique_ptr<Runner> runner;

  void listen(unsigned port) {
    Error error;
    const tcp::endpoint at(asio::ip::address_v4::loopback(), static_cast<unsigned short>(port));
    acceptor.open(at.protocol(), error);
    if (!error) acceptor.set_option(asio::socket_base::reuse_address(true), error);
    if (!error) acceptor.bind(at, error);
    if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
    if (error)
      throw InputError("cannot listen on port " + std::to_string(port) + " of 127.0.0.1: " + error.message());
    door = {make_token(), acceptor.local_endpoint().port()};
  }

  void accept() {
    acceptor.async_accept([this](Error error, tcp::socket socket) {
      if (error) return;
      std::make_shared<Visitor>(std::move(socket), door,
                                [this](tcp::socket from, http::request<http::string_body> request) {
                                  upgrade(std::move(from), std::move(request));
                                })
          ->read();
      accept();
    });
  }

  void upgrade(tcp::socket socket, http::request<http::string_body> request) {
    const auto comer = std::make_shared<Page>(
        std::move(socket), limits, [this](std::string message) { runner->take(std::move(message)); },
        [this](const Page* who) {
          if (page.get() != who) return;
          page.reset();
          runner->detach();
        });
    const bool takes_over = file_of(door, view_of(request.target())) == takeover;
    comer->open(request, [this, takes_over](const std::shared_ptr<Page>& opened) {
      if (page && !takes_over && !page->sleeps()) {
        opened->refuse("Another page shows these worlds.");
        return;
      }
      if (page) leave(page->sleeps());
      page = opened;
      runner->attach();
    });
  }

  /// The page makes room for another one, and is told so unless it sleeps.
  void leave(bool sleeps) {
    if (sleeps)
      page->close();
    else
      page->refuse("These worlds are shown in another tab now.");
    page.reset();
    runner->detach();
  }

  /// Returns a function that a runner's thread hands messages to.
  std::function<void(std::string)> to_page(void (Page::*send)(std::string)) {
    return [this, send](std::string message) {
      asio::post(context, [this, send, text = std::move(message)]() mutable {
        if (page) ((*page).*send)(std::move(text));
      });
    };
  }
};

Server::Server(Exhibit exhibit, unsigned port, std::optional<Replay> replay, const Limits& limits)
    : impl_(std::make_unique<Impl>(limits)) {
  impl_->listen(port);
  impl_->runner = std::make_unique<Runner>(
      std::move(exhibit), Outlet{impl_->to_page(&Page::send_text), impl_->to_page(&Page::send_frame)},
      [impl = impl_.get()] {
        asio::post(impl->context, [impl] {
          if (impl->page) impl->page->count_done();
        });
      },
      std::move(replay));
  impl_->accept();
}

Server::~Server() {
  impl_->runner.reset();  // its thread posts to the context
  impl_->page.reset();
}

std::string Server::address() const {
  return view::address(impl_->door);
}

unsigned Server::port() const {
  return impl_->door.port;
}

void Server::run(bool ends_by_signal) {
  asio::signal_set signals(impl_->context);
  if (ends_by_signal) {
    signals.add(SIGINT);
    signals.add(SIGTERM);
    signals.async_wait([this](Error error, int) {
      if (!error) impl_->context.stop();
    });
  }
  impl_->context.run();
}

void Server::stop() {
  impl_->context.stop();
}

}  // namespace plumb::view
