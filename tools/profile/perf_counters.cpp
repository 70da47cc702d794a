#include "profile/perf_counters.hpp"

#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <utility>
#include <vector>

#include "scenes/basics/lists.hpp"

namespace plumb::tools {
namespace {

/// Returns errno as the system call gives it, without the C library's -1.
int open_event(perf_event_attr& attributes, int group) {
  const long fd = ::syscall(SYS_perf_event_open, &attributes, 0, -1, group,
                            static_cast<unsigned long>(PERF_FLAG_FD_CLOEXEC));
  return fd >= 0 ? static_cast<int>(fd) : -errno;
}

perf_event_attr attributes_of(HardwareEvent event) {
  perf_event_attr a;
  std::memset(&a, 0, sizeof a);
  a.size = sizeof a;
  a.type = PERF_TYPE_HARDWARE;
  switch (event) {
    case HardwareEvent::instructions:
      a.config = PERF_COUNT_HW_INSTRUCTIONS;
      break;
    case HardwareEvent::cycles:
      a.config = PERF_COUNT_HW_CPU_CYCLES;
      break;
    case HardwareEvent::l1d_read_misses:
      a.type = PERF_TYPE_HW_CACHE;
      a.config = PERF_COUNT_HW_CACHE_L1D | (PERF_COUNT_HW_CACHE_OP_READ << 8) |
                 (PERF_COUNT_HW_CACHE_RESULT_MISS << 16);
      break;
    case HardwareEvent::ll_misses:
      a.config = PERF_COUNT_HW_CACHE_MISSES;
      break;
  }
  a.disabled = 1;
  a.exclude_kernel = 1;
  a.exclude_hv = 1;
  a.read_format = PERF_FORMAT_TOTAL_TIME_ENABLED | PERF_FORMAT_TOTAL_TIME_RUNNING;
  return a;
}

/// Says what errno of perf_event_open means for a user.
std::string reason_of(int error) {
  const std::string said = std::strerror(error);
  switch (error) {
    case ENOENT:
    case ENODEV:
    case EOPNOTSUPP:
      return "this processor, or the virtual machine around it, has no such counter (" + said + ")";
    case EACCES:
    case EPERM: {
      std::string level;
      std::ifstream("/proc/sys/kernel/perf_event_paranoid") >> level;
      return "the system forbids it (" + said + "; kernel.perf_event_paranoid is " +
             (level.empty() ? "unknown" : level) + ", at most 2 is needed, and containers may forbid it too)";
    }
    case ENOSYS:
      return "this kernel has no perf_event_open (" + said + ")";
    default:
      return said;
  }
}

std::optional<CounterValue> read_counter(int fd) {
  std::uint64_t words[3];
  if (::read(fd, words, sizeof words) != static_cast<ssize_t>(sizeof words)) return {};
  return CounterValue{words[0], words[1], words[2]};
}

constexpr HardwareEvent all_events[] = {HardwareEvent::instructions, HardwareEvent::cycles,
                                        HardwareEvent::l1d_read_misses, HardwareEvent::ll_misses};

}  // namespace

std::string_view to_string(HardwareEvent event) {
  constexpr std::string_view names[] = {"instructions", "cycles", "L1D read misses",
                                        "last-level cache misses"};
  return names[static_cast<std::size_t>(event)];
}

std::optional<double> scaled_count(const CounterValue& before, const CounterValue& after) {
  const std::uint64_t running = after.running_ns - before.running_ns;
  if (running == 0) return {};
  return static_cast<double>(after.count - before.count) *
         (static_cast<double>(after.enabled_ns - before.enabled_ns) / static_cast<double>(running));
}

PerfCounters::PerfCounters() : PerfCounters(open_event) {}

PerfCounters::PerfCounters(const Open& open) {
  int group = -1;
  for (const HardwareEvent event : all_events) {
    Counter& counter = at(event);
    perf_event_attr attributes = attributes_of(event);
    // Members of a group follow their leader's switch.
    attributes.disabled = group < 0;
    int fd = open(attributes, group);
    counter.leads = group < 0;
    if (fd == -EINVAL && group >= 0) {
      attributes.disabled = 1;
      fd = open(attributes, -1);
      counter.leads = true;
    }
    if (fd < 0) {
      counter.refusal = reason_of(-fd);
      continue;
    }
    counter.fd = fd;
    if (group < 0) group = fd;
  }
}

PerfCounters::~PerfCounters() {
  for (const Counter& counter : counters_)
    if (counter.fd >= 0) ::close(counter.fd);
}

bool PerfCounters::has(HardwareEvent event) const {
  return at(event).fd >= 0;
}

bool PerfCounters::has_any() const {
  for (const Counter& counter : counters_)
    if (counter.fd >= 0) return true;
  return false;
}

const std::string& PerfCounters::refusal(HardwareEvent event) const {
  return at(event).refusal;
}

std::string PerfCounters::refusals() const {
  std::vector<std::pair<std::string, std::string>> events_of;  // Each pair holds a reason and its events.
  for (const HardwareEvent event : all_events) {
    const std::string& why = refusal(event);
    if (why.empty()) continue;
    auto it = events_of.begin();
    while (it != events_of.end() && it->first != why) ++it;
    if (it == events_of.end()) it = events_of.insert(it, {why, ""});
    scenes::append_item(it->second, to_string(event));
  }
  std::string out;
  for (const auto& [why, events] : events_of) scenes::append_item(out, events + ": " + why, "; ");
  return out;
}

void PerfCounters::switch_groups(unsigned long request) {
  for (const Counter& counter : counters_)
    if (counter.fd >= 0 && counter.leads) ::ioctl(counter.fd, request, PERF_IOC_FLAG_GROUP);
}

void PerfCounters::start() {
  for (Counter& counter : counters_)
    if (counter.fd >= 0) counter.before = read_counter(counter.fd).value_or(CounterValue{});
  switch_groups(PERF_EVENT_IOC_ENABLE);
}

std::array<std::optional<double>, hardware_events> PerfCounters::stop() {
  switch_groups(PERF_EVENT_IOC_DISABLE);
  std::array<std::optional<double>, hardware_events> out;
  for (std::size_t i = 0; i < hardware_events; ++i) {
    if (counters_[i].fd < 0) continue;
    if (const auto after = read_counter(counters_[i].fd)) out[i] = scaled_count(counters_[i].before, *after);
  }
  return out;
}

}  // namespace plumb::tools
