#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "contest/case.hpp"

namespace plumb::bench {

/// Measures what this machine can do at most, in the same run as what it does.
///
/// - limit/projection/<number>/<isa>: ns per rod projection with everything in registers.
/// - limit/bandwidth/<level>/threads:<n>: bytes per second of x += p (two reads, one write). The two arrays
///   fill the level, and threads split them.
class Limits {
 public:
  struct Row {
    std::string name;
    bool is_bandwidth = false;      ///< samples are bytes per second, not ns per projection
    std::vector<double> samples{};  ///< one per round
    std::function<double()> sample{};
  };

  /// Prepares the limits for 1 thread and, on a machine that has them, 2.
  explicit Limits(std::uint32_t rounds);

  /// Takes all samples, round by round. Only the first call does anything.
  void measure();
  const std::vector<Row>& rows() const { return rows_; }

  /// Returns the least of the samples, in ns.
  double projection_ns(Precision precision, Isa isa) const;
  /// Returns the most of the samples, in bytes per second.
  double bytes_per_second(Level level, unsigned threads) const;

 private:
  const Row& row(const std::string& name) const;

  std::uint32_t rounds_;
  std::vector<Row> rows_;
};

}  // namespace plumb::bench
