#include "support/quiet.hpp"

#include <algorithm>
#include <cstdio>
#include <thread>
#include <vector>

#include "limits/limit_kernels.hpp"
#include "limits/together.hpp"
#include "scenes/basics/numbers.hpp"
#include "support/statistics.hpp"

namespace plumb::bench {

double work_of_two_threads() {
  if (std::thread::hardware_concurrency() < 2) return 1;
  const auto seconds = [](unsigned threads) {
    return run_together(
        threads, [](unsigned) {}, [](unsigned) { limit_kernels(Isa::scalar).project_float(2000000); });
  };
  std::vector<double> ratios;
  for (int i = 0; i < 7; ++i) {
    const double one = seconds(1);
    ratios.push_back(2 * one / seconds(2));
  }
  return median(ratios);
}

std::string quiet_text(double at_the_beginning) {
  const double now = work_of_two_threads();
  const std::string text = "Two threads did " + scenes::plain_number(at_the_beginning) +
                           " times the work of one when the run began and " + scenes::plain_number(now) +
                           " when it ended (2: nothing else ran).";
  if (std::min(at_the_beginning, now) < 1.8)
    std::fprintf(stderr, "warning: this machine is not quiet. %s\n", text.c_str());
  return text;
}

}  // namespace plumb::bench
