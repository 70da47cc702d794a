#pragma once

#include <benchmark/benchmark.h>

namespace plumb::bench {

/// Prints one line per benchmark: name, least and median time, and counters that say whether to believe it.
class LineReporter final : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context& context) override;
  void ReportRuns(const std::vector<Run>& runs) override;
};

}  // namespace plumb::bench
