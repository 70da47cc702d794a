#include "layouts/line_reporter.hpp"

#include <cstdio>
#include <string>

namespace plumb::bench {
namespace {

double counter(const benchmark::BenchmarkReporter::Run& run, const std::string& name) {
  const auto found = run.counters.find(name);
  return found == run.counters.end() ? 0 : found->second.value;
}

}  // namespace

bool LineReporter::ReportContext(const Context& context) {
  PrintBasicContext(&GetErrorStream(), context);
  return true;
}

void LineReporter::ReportRuns(const std::vector<Run>& runs) {
  const Run* least = nullptr;
  const Run* median = nullptr;
  for (const Run& run : runs) {
    if (run.aggregate_name == "min") least = &run;
    if (run.aggregate_name == "median") median = &run;
  }
  if (!least || !median) return;
  std::printf("%-66s", least->run_name.function_name.c_str());
  if (counter(*median, "bytes_per_second") > 0) {
    std::printf("  median %7.2f GB/s\n", 1e-9 * counter(*median, "bytes_per_second"));
  } else {
    std::printf("  min %7.3f  median %7.3f ns", counter(*least, "ns_per_projection"),
                counter(*median, "ns_per_projection"));
    if (counter(*median, "speedup") > 0) std::printf("  speedup %6.1f", counter(*median, "speedup"));
    if (counter(*median, "max_stretch") > 0) std::printf("  stretch %9.3g", counter(*median, "max_stretch"));
    std::printf("\n");
  }
  std::fflush(stdout);
}

}  // namespace plumb::bench
