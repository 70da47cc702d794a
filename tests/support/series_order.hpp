#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "truth/integrators/integrator.hpp"
#include "truth/model.hpp"

namespace plumb::test {

/// Returns the order that 0.1 s of a motion show for a series of `order`: the logarithm to base 2 of the
/// error in so many steps over that in twice as many.
inline double measured_order(const truth::Model& model, const truth::State& start, std::uint32_t order,
                             int steps) {
  truth::Integrator best(model, start, {});
  best.advance_to(0.1L);
  const auto error = [&](int count) {
    truth::Integrator one(model, start, {.order = order});
    for (int i = 0; i < count; ++i) one.step(0.1L / count);
    truth::Real worst = 0;
    for (std::size_t i = 0; i < model.particles(); ++i) {
      worst = std::max(
          {worst, norm(one.state().x[i] - best.state().x[i]), norm(one.state().v[i] - best.state().v[i])});
    }
    return worst;
  };
  return static_cast<double>(std::log2(error(steps) / error(2 * steps)));
}

}  // namespace plumb::test
