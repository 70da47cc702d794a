#pragma once

#include <linux/perf_event.h>

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace plumb::tools {

enum class HardwareEvent : std::uint8_t { instructions, cycles, l1d_read_misses, ll_misses };
inline constexpr std::size_t hardware_events = 4;
std::string_view to_string(HardwareEvent);

/// This is what a counter showed, and for how long (ns) it was asked to count and did, as Linux gives it.
struct CounterValue {
  std::uint64_t count = 0, enabled_ns = 0, running_ns = 0;
};

/// Returns the count over an interval. It is scaled up if the counter shared its place with others for a part
/// of it. It is none if the counter did not run at all.
std::optional<double> scaled_count(const CounterValue& before, const CounterValue& after);

/// Reads the processor's own counters for the calling thread, in user space only, through perf_event_open
/// (Linux). A counter that the machine or its system does not give is missing, with the reason.
class PerfCounters {
 public:
  /// Opens an event for this thread in the group of another; -1 makes a group of its own. Returns a file
  /// descriptor, or -errno.
  using Open = std::function<int(perf_event_attr&, int group)>;

  /// Opens all events in one group, so that they count over the same instructions. An event that no longer
  /// fits into the group counts alone. A refusal never throws.
  PerfCounters();
  explicit PerfCounters(const Open& open);
  ~PerfCounters();
  PerfCounters(const PerfCounters&) = delete;
  PerfCounters& operator=(const PerfCounters&) = delete;

  bool has(HardwareEvent event) const;
  bool has_any() const;
  /// Says why an event is not there. It is empty for one that is.
  const std::string& refusal(HardwareEvent event) const;
  /// Lists all refusals in a line, those with the same reason together. It is empty if there are none.
  std::string refusals() const;

  void start();
  /// Returns the counts since start(). A count is none if its counter is missing or did not run.
  std::array<std::optional<double>, hardware_events> stop();

 private:
  struct Counter {
    int fd = -1;
    bool leads = false;  ///< Whether it leads a group: one of its own, or that of all.
    std::string refusal;
    CounterValue before;
  };
  Counter& at(HardwareEvent event) { return counters_[static_cast<std::size_t>(event)]; }
  const Counter& at(HardwareEvent event) const { return counters_[static_cast<std::size_t>(event)]; }
  void switch_groups(unsigned long request);

  std::array<Counter, hardware_events> counters_;
};

}  // namespace plumb::tools
