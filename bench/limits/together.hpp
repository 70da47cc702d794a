#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

namespace plumb::bench {

/// Runs prepare(thread) and then work(thread) on `threads` threads, this one included. Returns the seconds
/// from when the first begins its work until the last is through. They begin together: waits spin, as waking
/// a thread may take longer than what is timed.
template <class Prepare, class Work>
double run_together(unsigned threads, Prepare&& prepare, Work&& work) {
  using Clock = std::chrono::steady_clock;
  std::atomic<unsigned> ready{0};
  std::vector<Clock::time_point> begin(threads), end(threads);
  const auto one = [&](unsigned thread) {
    prepare(thread);
    ready.fetch_add(1);
    for (unsigned spins = 0; ready.load() < threads; ++spins)
      if (spins > 10000) std::this_thread::yield();
    begin[thread] = Clock::now();
    work(thread);
    end[thread] = Clock::now();
  };
  std::vector<std::thread> others;
  for (unsigned thread = 1; thread < threads; ++thread) others.emplace_back(one, thread);
  one(0);
  for (std::thread& other : others) other.join();
  const auto first = *std::min_element(begin.begin(), begin.end());
  const auto last = *std::max_element(end.begin(), end.end());
  return std::chrono::duration<double>(last - first).count();
}

}  // namespace plumb::bench
