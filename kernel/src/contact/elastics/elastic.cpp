#include "contact/elastics/elastic.hpp"

#include <algorithm>
#include <cmath>

namespace plumb::detail {

void set_laws(const Spring& spring, std::span<ElasticLaw> laws) {
  if (laws.size() == 1) {
    laws[0] = {spring.length, spring.stiffness, spring.damping, spring.force, spring.one_sided};
    return;
  }
  laws[0] = {.force = spring.force};
  for (ElasticLaw& law : laws.subspan(1)) law = {.stiffness = spring.stiffness, .damping = spring.damping};
}

void set_laws(const Torsion& torsion, std::span<ElasticLaw> laws) {
  laws[0] = {torsion.angle, torsion.stiffness, torsion.damping, -torsion.torque, false};
}

void set_laws(const AngleControl& angle, std::span<ElasticLaw> laws) {
  if (!laws.empty()) laws[0] = {angle.target, angle.stiffness, angle.damping, 0, false};
}

double swing(const ElasticLaw& law, double give, double h) {
  return h * h * give * law.stiffness + h * give * law.damping;
}

namespace {

/// Returns the share that a substep resolves of what swings, or is damped, by the square root of `square`.
double resolved_share(double square) {
  return 1 / (1 + std::max(square - 1, 0.0));
}

}  // namespace

void ElasticStep::begin(const ElasticLaw& law, double gives, double h, bool at_end) {
  give = gives;
  const bool is_rigid = std::isinf(law.stiffness);
  resolved = is_rigid ? 0 : at_end ? 1 : resolved_share(swing(law, give, h));
  kick = at_end ? h * h : 0.5 * h * h;
  soft = before = 0;
  if (is_rigid) {
    went = std::numeric_limits<double>::quiet_NaN();  // It is held still.
    return;
  }
  // What is damped strongly does not swing, and needs no damping more.
  const double damps = law.damping / h;
  const double swings = h * h * give * law.stiffness / (1 + h * give * law.damping);
  const double share = at_end ? 1 : 1 - 0.5 * resolved_share(swings);
  const double excess = start - law.rest, taut = law.one_sided ? std::max(excess, 0.0) : excess;
  const double slope = law.stiffness * share + damps;
  damped = damps / slope;
  soft = 1 / (kick * slope);
  before = (law.stiffness * (1 - share) - damps) / slope * taut;
  if (!at_end && !std::isnan(went)) before -= law.stiffness * (share - 0.5) / slope * h * went;
}

double ElasticStep::soft_at_end() const {
  return acts && !lets_go && resolved < 1 ? resolved / (1 - resolved) * give : -1;
}

double ElasticStep::rate_at_end(double mean) const {
  return damped * mean + (std::isnan(went) ? 0 : (1 - damped) * (1.5 * mean - 0.5 * went));
}

}  // namespace plumb::detail
