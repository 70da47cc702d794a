#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "contest/case.hpp"
#include "plumb/settings.hpp"

namespace plumb::bench {

/// A timed step has this many sweeps. The longer step shows what a sweep alone takes.
inline constexpr std::uint32_t sweeps = 20, long_sweeps = 40;

/// Holds what was measured of a contender.
struct Outcome {
  std::vector<double> step_s{};  ///< seconds per step, one sample per round
  /// Holds seconds per sweep without prediction, preparation and advance, from the time that a longer step
  /// takes longer. It covers some of the rounds where scenes are large, and none for a baseline.
  std::vector<double> sweep_s{};
  std::uint32_t rods = 0;
  unsigned threads = 1;        ///< threads that worked
  std::size_t bytes = 0;       ///< bytes of state and rods; 0 for a baseline
  double bytes_per_sweep = 0;  ///< bytes per rod, see sweep_bytes_per_rod()
  std::uint32_t run_up_steps = 0;
  double run_up_stretch = 0;  ///< largest |stretch| after the run-up, which is the same for all contenders
  std::uint64_t steps = 0;    ///< steps of run-up, warming and samples together
  double max_stretch = 0;     ///< largest |stretch| after all steps
  std::uint64_t state_hash = 0;

  double ns_per_projection(std::size_t round) const;
  double least_ns() const;
  double median_ns() const;
  double median_sweep_ns() const;  ///< ns per projection; 0 if not measured
};

/// This is one way of stepping the scene of a contest: a world, or a baseline.
struct Contender {
  bool is_baseline = false;
  std::string arrangement{};  ///< layout of a world, order of a baseline's rods
  LayoutChoice layout = LayoutChoice::automatic;
  Isa isa = Isa::scalar;
  unsigned threads = 1;
  bool is_reference = false;  ///< others must end in its bits
  bool listed = true;         ///< if false, it takes part for comparison only
  Outcome outcome{};

  /// Returns a name such as "relax/chain/float/auto/avx512/threads:1/links:8191".
  std::string name(const Case& c) const;
};

/// Times contenders over one scene side by side. They take turns in every round, so that a noisy minute falls
/// on all of them alike. All worlds make the same steps and must end in the same bits.
class Contest {
 public:
  Contest(const Case& c, std::vector<Contender> contenders, std::uint32_t rounds)
      : case_(c), contenders_(std::move(contenders)), rounds_(rounds) {}

  /// Unlists the contenders whose names `is_wanted` refuses, and takes out those that nothing is compared
  /// with.
  template <class IsWanted>
  void keep(IsWanted&& is_wanted) {
    for (Contender& contender : contenders_)
      contender.listed = contender.listed && is_wanted(contender.name(case_));
    std::erase_if(contenders_,
                  [](const Contender& c) { return !c.listed && !c.is_baseline && !c.is_reference; });
  }
  bool has_listed() const {
    return std::any_of(contenders_.begin(), contenders_.end(), [](const Contender& c) { return c.listed; });
  }

  /// Takes all samples. Only the first call does anything. Throws CheckFailed if worlds differ from each
  /// other or anything is not finite.
  void measure();
  bool is_measured() const { return measured_; }

  const Case& scene_case() const { return case_; }
  const std::vector<Contender>& contenders() const { return contenders_; }
  /// Returns the time of the baseline with rods in that order over the time of contender `i` in the same
  /// round. It is 0 without such a baseline.
  double speedup(std::size_t i, const std::string& order, std::size_t round) const;
  double median_speedup(std::size_t i, const std::string& order) const;
  bool has_baseline(const std::string& order) const { return baseline(order) != nullptr; }

 private:
  const Contender* baseline(const std::string& order) const;

  Case case_;
  std::vector<Contender> contenders_;
  std::uint32_t rounds_;
  bool measured_ = false;
};

}  // namespace plumb::bench
