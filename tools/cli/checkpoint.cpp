#include "cli/checkpoint.hpp"

#include <csignal>
#include <span>
#include <utility>

#include "scenes/basics/files.hpp"

namespace plumb::tools {
namespace {

constexpr auto period = std::chrono::seconds(10);

volatile std::sig_atomic_t interrupted = 0;

/// The next such signal ends the program, in case a frame takes long.
void interrupt(int signal) {
  interrupted = 1;
  std::signal(signal, SIG_DFL);
}

}  // namespace

Checkpoint::Checkpoint(std::string file, std::string run, std::optional<double> every)
    : file_(std::move(file)), run_(std::move(run)), every_(every) {
  interrupted = 0;
  std::signal(SIGINT, interrupt);
  std::signal(SIGTERM, interrupt);
}

Checkpoint::~Checkpoint() {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

bool Checkpoint::is_due(const World& world) const {
  if (!every_) return Clock::now() >= next_;
  // Times are sums of frames, which are rounded.
  return written_ < 0 || world.time() - written_ >= *every_ * (1 - 1e-9);
}

bool Checkpoint::see(const World& world) {
  const bool goes_on = interrupted == 0;
  if (!goes_on || is_due(world)) write(world);
  return goes_on;
}

void Checkpoint::write(const World& world) {
  if (written_ == world.time()) return;
  bytes_.resize(world.snapshot_size());
  world.save(std::as_writable_bytes(std::span(bytes_)));
  bytes_ += run_;
  scenes::write_file(file_, bytes_);
  written_ = world.time();
  next_ = Clock::now() + period;
}

}  // namespace plumb::tools
