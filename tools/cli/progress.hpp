#pragma once

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <string>

namespace plumb::tools {

/// Shows a bar on stderr for what takes more than a second. It appears on a terminal only, is drawn at most
/// ten times a second, and is gone when the work is done.
class Progress {
 public:
  Progress(std::string label, bool quiet)
      : label_(std::move(label)), shown_(!quiet && ::isatty(STDERR_FILENO)) {}
  ~Progress() {
    if (drawn_) std::fputs("\r\033[K", stderr);
  }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(std::uint64_t done, std::uint64_t all) {
    if (!shown_) return;
    const auto now = Clock::now();
    if (now - start_ < std::chrono::seconds(1) || now - last_ < std::chrono::milliseconds(100)) return;
    last_ = now;
    drawn_ = true;
    const double share = all ? std::min(1.0, static_cast<double>(done) / static_cast<double>(all)) : 1;
    constexpr int width = 30;
    const int filled = static_cast<int>(share * width);
    const double elapsed = std::chrono::duration<double>(now - start_).count();
    std::fprintf(stderr, "\r\033[K%s [%s%s] %3.0f %%", label_.c_str(),
                 std::string(static_cast<std::size_t>(filled), '#').c_str(),
                 std::string(static_cast<std::size_t>(width - filled), ' ').c_str(), 100 * share);
    if (share > 0.02) std::fprintf(stderr, "  %.0f s left", elapsed * (1 - share) / share);
    std::fflush(stderr);
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::string label_;
  bool shown_;
  bool drawn_ = false;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_{};
};

}  // namespace plumb::tools
