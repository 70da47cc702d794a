#include "direct/tackles/tackle_law.hpp"

#include <algorithm>

namespace plumb::detail {
namespace {

/// A function of how long a cord is at the end, and its derivative.
struct Value {
  double value, slope;
};

/// Returns how much a cord is too long in the mean over a substep, as its energy asks, in m.
Value mean_excess(const TackleLaw& law, double theta, double start, double end) {
  const double taut = std::max(end, 0.0), taut_before = std::max(start, 0.0);
  if (theta == 1) return law.is_one_sided ? Value{taut, end > 0 ? 1.0 : 0.0} : Value{end, 1};
  if (!law.is_one_sided || (start >= 0 && end >= 0)) return {(start + end) / 2, 0.5};
  if (start <= 0 && end <= 0) return {0, 0};
  // (taut² - taut_before²)/(2 (end - start)), where one of both is 0
  const double change = end - start, mean = (taut * taut - taut_before * taut_before) / (2 * change);
  return {mean, (taut - mean) / change};
}

/// Returns the pull of an elastic cord, in N over the unit of mass.
Value elastic_pull(const TackleLaw& law, const TackleFactors& factors, const TackleIterate& iterate) {
  const auto [start, end, mu, paid] = iterate;
  const Value mean = factors.theta == 1 ? mean_excess(law, 1, start, end)
                                        : mean_excess(law, factors.theta, start + paid, end - paid);
  Value pull{law.stiffness * mean.value, law.stiffness * mean.slope};
  const double damping = factors.rate * law.damping;
  if (damping == 0) return pull;
  const double from = law.is_one_sided ? std::max(start, 0.0) : start;
  const double to = law.is_one_sided ? std::max(end, 0.0) : end;
  pull.value += damping * (to - from);
  if (to == end) pull.slope += damping;
  return law.is_one_sided && pull.value <= 0 ? Value{0, 0} : pull;
}

}  // namespace

TackleRow tackle_row(const TackleLaw& law, const TackleFactors& factors, const TackleIterate& iterate) {
  if (law.is_rigid) {
    const auto [start, end, mu, paid] = iterate;
    if (!law.is_one_sided || end - mu > 0) return {1, 0, end};
    return {0, 1, mu};
  }
  const Value pull = elastic_pull(law, factors, iterate);
  const double rest = iterate.mu + factors.kick * pull.value, slope = factors.kick * pull.slope;
  if (slope > 0) return {1, 1 / slope, rest / slope};
  return {0, 1, rest};
}

TackleRow giving_tackle_row(const TackleLaw& law, double kick, double give, const TackleIterate& iterate) {
  const auto [start, end, mu, paid] = iterate;
  if (!law.is_rigid) {
    TackleLaw undamped = law;
    undamped.damping = 0;
    return tackle_row(undamped, {kick, 0, 1}, iterate);
  }
  if (law.is_one_sided && end <= 0) return {0, 1, mu};
  return {1, give, end + give * mu};
}

TacklePull giving_tackle_pull(const TackleLaw& law, double kick, double give, double end) {
  const double excess = law.is_one_sided ? std::max(end, 0.0) : end;
  const double stiffness = law.is_rigid ? 1 / give : kick * law.stiffness;
  return {-stiffness * excess, 0.5 * stiffness * excess * excess};
}

}  // namespace plumb::detail
