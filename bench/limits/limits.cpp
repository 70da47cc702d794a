#include "limits.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <stdexcept>
#include <thread>

#include "limit_kernels.hpp"
#include "plumb/layouts/aligned_buffer.hpp"
#include "support/statistics.hpp"
#include "together.hpp"

namespace plumb::bench {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_between(Clock::time_point start, Clock::time_point end) {
  return std::chrono::duration<double>(end - start).count();
}

std::string projection_name(Precision precision, Isa isa) {
  return std::string("limit/projection/").append(number_name(precision)).append("/").append(to_string(isa));
}

std::string bandwidth_name(Level level, unsigned threads) {
  return std::string("limit/bandwidth/")
      .append(to_string(level))
      .append("/threads:" + std::to_string(threads));
}

double sample_projection(std::uint64_t (*project)(std::uint64_t)) {
  constexpr std::uint64_t rods = 2000000;
  project(rods);  // the processor may change its clock with the instruction set
  const auto start = Clock::now();
  const std::uint64_t done = project(rods);
  return 1e9 * seconds_between(start, Clock::now()) / static_cast<double>(done);
}

/// Adds two arrays with `threads` threads, each in its own part.
class Adder {
 public:
  Adder(std::size_t bytes, unsigned threads)
      : threads_(threads), x_(bytes / 2 / sizeof(float)), p_(bytes / 2 / sizeof(float)) {
    for (std::size_t i = 0; i < p_.size(); ++i) p_[i] = 1e-6f;
  }

  /// Returns bytes per second, after a pass that is not counted.
  double sample() {
    constexpr std::size_t least_bytes = std::size_t{64} << 20;
    const std::size_t passes = std::max<std::size_t>(2, least_bytes / (2 * sizeof(float) * x_.size()));
    const double seconds = run_together(
        threads_, [&](unsigned thread) { add(thread, 1); }, [&](unsigned thread) { add(thread, passes); });
    return static_cast<double>(3 * sizeof(float) * x_.size() * passes) / seconds;
  }

 private:
  void add(unsigned thread, std::size_t passes) {
    const std::size_t part = x_.size() / 16 / threads_ * 16;
    for (std::size_t i = 0; i < passes; ++i)
      limit_kernels(best_isa()).add(x_.data() + thread * part, p_.data() + thread * part, part);
  }

  unsigned threads_;
  layouts::AlignedBuffer<float> x_, p_;
};

constexpr std::size_t level_bytes(Level level) {
  constexpr std::size_t bytes[] = {16 << 10, 512 << 10, 8 << 20, 256 << 20};
  return bytes[static_cast<int>(level)];
}

}  // namespace

Limits::Limits(std::uint32_t rounds) : rounds_(rounds) {
  for (const Isa isa : {Isa::scalar, Isa::sse2, Isa::avx2, Isa::avx512}) {
    if (!is_supported(isa)) continue;
    const LimitKernels& kernels = limit_kernels(isa);
    rows_.push_back({.name = projection_name(Precision::single, isa),
                     .sample = [&] { return sample_projection(kernels.project_float); }});
    rows_.push_back({.name = projection_name(Precision::double_, isa),
                     .sample = [&] { return sample_projection(kernels.project_double); }});
  }
  for (const Level level : {Level::l1, Level::l2, Level::l3, Level::dram}) {
    for (const unsigned threads : {1u, 2u}) {
      if (threads > std::thread::hardware_concurrency()) continue;
      const auto sample = [=, adder = std::shared_ptr<Adder>()]() mutable {
        if (!adder) adder = std::make_shared<Adder>(level_bytes(level), threads);
        return adder->sample();
      };
      rows_.push_back({.name = bandwidth_name(level, threads), .is_bandwidth = true, .sample = sample});
    }
  }
}

void Limits::measure() {
  if (!rows_.front().samples.empty()) return;
  for (std::uint32_t round = 0; round < rounds_; ++round)
    for (Row& row : rows_) row.samples.push_back(row.sample());
  for (Row& row : rows_) row.sample = nullptr;  // frees its arrays, too
}

const Limits::Row& Limits::row(const std::string& name) const {
  const auto found = std::find_if(rows_.begin(), rows_.end(), [&](const Row& r) { return r.name == name; });
  if (found == rows_.end()) throw std::out_of_range(name + " is not measured");
  return *found;
}

double Limits::projection_ns(Precision precision, Isa isa) const {
  return least(row(projection_name(precision, isa)).samples);
}

double Limits::bytes_per_second(Level level, unsigned threads) const {
  const std::vector<double>& samples = row(bandwidth_name(level, threads)).samples;
  return *std::max_element(samples.begin(), samples.end());
}

}  // namespace plumb::bench
