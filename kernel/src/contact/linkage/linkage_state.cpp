#include "contact/linkage/linkage_state.hpp"

#include <algorithm>
#include <cmath>

#include "scene/bends/curvature.hpp"

namespace plumb::detail {
namespace {

/// A step that is not implicit follows an elastic whose swing, squared, is below this in radians.
constexpr double most_swing = 0.25;
/// Velocities of redundant constraints are corrected so often. One takes eight digits off what is left, or
/// two where masses differ by 1e6.
constexpr int velocity_corrections = 2;
/// What hung from a rod has so many seconds (s) to become fast before it counts as slow.
constexpr double awake_after_break = 0.5;
/// A capsule lies in two places, and a hull on four corners or so; each may turn on its place. Room for these
/// is there from the start, since what comes to lie in one more place late would else allocate then.
constexpr std::size_t kept_of_capsule = 4;
constexpr std::size_t kept_of_hull = 8;

}  // namespace

LinkageState::LinkageState(const Linkage& kind, std::uint32_t island, const Scene& part, bool relaxes)
    : linkage(&kind),
      force(kind.movable()),
      laws(kind.elastic_laws().begin(), kind.elastic_laws().end()),
      angle_rules(kind.angle_rules().begin(), kind.angle_rules().end()),
      number(island) {
  acceleration.resize(kind.movable());
  asleep = std::all_of(part.particles.begin(), part.particles.end(),
                       [](const Particle& each) { return each.fixed || each.asleep; });
  for (const Particle& particle : part.particles) {
    x.push_back(particle.position);
    v.push_back(particle.fixed || asleep ? Vec3{} : particle.velocity);
  }
  kept.reserve(kept_of_capsule * kind.shapes().size() + kept_of_hull * kind.hulls().size());
  if (relaxes) kept_violations.reserve(kind.rods());
  anchors_went.assign(kind.particles() - kind.movable(), Vec3{});
  elastic_numbers.assign(laws.size(), 0);
  elastic_rates.reserve(laws.size());
  if (kind.breaks()) broken.assign(kind.giving_rods(), 0);
  stiffness.assign(kind.taut_rods(), 0);
  stiffness_before.assign(kind.taut_rods(), 0);
  wave_inertia.assign(kind.taut_rods(), 0);
  waves_before.assign(kind.taut_rods(), 0);
  if (!laws.empty()) {  // What sleeps is thrown late.
    pulls_.reserve(kind.movable());
    energies_.reserve(kind.movable());
  }
  follow_bends(0);
  follow_elastics();
}

void LinkageState::return_to(const LinkageMotion& motion) {
  this->motion() = motion;
  factored = false;
  turning.clear();
  for (std::size_t i = 0; i < broken.size(); ++i)
    laws[i] = broken[i] != 0 ? ElasticLaw{} : linkage->elastic_laws()[i];
}

void LinkageState::break_rod(std::size_t elastic) {
  laws[elastic] = {};
  broken[elastic] = 1;
  energy.reset();
  forget_tautness();
  slow_time = -awake_after_break;
}

void LinkageState::rates(std::span<const Vec3> velocities, Linkage::Range of, std::span<double> right) const {
  linkage->rates(x, velocities, of, right);
  for (const RodLengths::Change& each : lengths.changes())
    right[linkage->plan().position(linkage->row_of_rod(each.rod))] += each.half_square_rate;
}

bool LinkageState::is_driven() const {
  return lengths.move() ||
         std::any_of(v.begin() + linkage->movable(), v.end(), [](Vec3 of) { return of != Vec3{}; });
}

double LinkageState::most_of_blow() const {
  double fastest = 0;
  for (const RodLengths::Change& each : lengths.changes())
    fastest = std::max(fastest, (each.rate - each.went) * (each.rate - each.went));
  for (std::size_t i = 0; i < anchors_went.size(); ++i) {
    const Vec3 change = v[linkage->movable() + i] - anchors_went[i];
    fastest = std::max(fastest, dot(change, change));
  }
  return 0.5 * linkage->mass() * fastest;
}

double LinkageState::driving_speed() const {
  double most = lengths.speed();
  for (const Vec3 of_anchor : std::span(v).subspan(linkage->movable()))
    most = std::max(most, norm(of_anchor));
  return most;
}

Vec3 LinkageState::velocity_of_anchors() const {
  Vec3 sum{};
  for (std::size_t k = linkage->movable(); k < v.size(); ++k) sum += v[k];
  return sum == Vec3{} ? sum : (1.0 / static_cast<double>(v.size() - linkage->movable())) * sum;
}

double LinkageState::work_of_given(std::span<const double> multipliers, Array<simd::Quad>& unknowns) {
  const Vec3 common = velocity_of_anchors();
  given_.resize(v.size());
  bool any = lengths.move();
  for (std::size_t k = linkage->movable(); k < v.size(); ++k) {
    given_[k] = v[k] - common;
    any = any || given_[k] != Vec3{};
  }
  if (!any) return 0;
  const std::span<double> right = numbers(unknowns);
  rates(given_, linkage->fixed_ones(), right);
  double sum = 0;
  for (std::uint32_t c = 0; c < linkage->constraints(); ++c)
    sum -= multipliers[c] * right[linkage->plan().position(3 * linkage->movable() + c)];
  return sum;
}

double LinkageState::work_of_common(std::span<const Vec3> after, double h) {
  const Vec3 common = velocity_of_anchors();
  if (common == Vec3{}) return 0;
  given_.assign(v.size(), common);
  double sum = h * linkage->potential(given_, force);
  linkage->momenta(after, given_);
  for (std::uint32_t k = 0; k < linkage->movable(); ++k) sum += dot(common, given_[k]);
  linkage->momenta(v, given_);
  for (std::uint32_t k = 0; k < linkage->movable(); ++k) sum -= dot(common, given_[k]);
  return sum;
}

void LinkageState::correct_velocities(std::span<Vec3> velocities, Array<simd::Quad>& unknowns,
                                      std::span<double> multipliers) const {
  const std::span<double> right = numbers(unknowns);
  for (int i = 0; i < velocity_corrections; ++i) {
    std::fill(right.begin(), right.end(), 0.0);
    rates(velocities, linkage->all(), right);
    solve(unknowns);
    linkage->take_multipliers(right, 1, multipliers);
    for (std::uint32_t k = 0; k < linkage->movable(); ++k) velocities[k] += linkage->taken(right, k);
  }
}

bool LinkageState::has_ended(const BendElastics& bend) const {
  return !broken.empty() &&
         std::any_of(bend.rods.begin(), bend.rods.end(), [&](std::uint32_t rod) { return broken[rod] != 0; });
}

void LinkageState::follow_bends(double h) {
  for (const BendElastics& bend : linkage->bends()) {
    const std::span<ElasticLaw> of_bend = std::span(laws).subspan(bend.first, bend.count);
    const Combination& w = linkage->elastics()[bend.first].sums[0];
    if (has_ended(bend))
      std::fill(of_bend.begin(), of_bend.end(), ElasticLaw{});
    else
      set_laws(bend, w.of(x) + h / 2 * w.of(v), of_bend);
  }
}

void LinkageState::follow_elastics() {
  for (std::size_t i = 0; i < laws.size(); ++i)
    elastic_numbers[i] = linkage->number(linkage->elastics()[i], x, elastic_numbers[i]);
}

void LinkageState::follow_elastics(double h) {
  elastic_rates.assign(elastic_numbers.begin(), elastic_numbers.end());
  follow_elastics();
  for (std::size_t i = 0; i < laws.size(); ++i)
    elastic_rates[i] = (elastic_numbers[i] - elastic_rates[i]) / h;
}

void LinkageState::add_motors(std::span<Vec3> forces) const {
  for (std::size_t i = 0; i < laws.size(); ++i) {
    const ElasticLaw& law = laws[i];
    const Elastic& elastic = linkage->elastics()[i];
    if (law.force == 0) continue;
    if (law.one_sided && linkage->number(elastic, x, elastic_numbers[i]) <= law.rest) continue;
    linkage->push_along(elastic, linkage->slope(elastic, x), -law.force, forces);
  }
}

void LinkageState::add_elastic_pulls(std::span<Vec3> forces) const {
  add_motors(forces);
  for (std::size_t i = 0; i < laws.size(); ++i) {
    const Elastic& elastic = linkage->elastics()[i];
    if (const double pull = elastic_pull(i); pull != 0)
      linkage->push_along(elastic, linkage->slope(elastic, x), -pull, forces);
  }
}

bool LinkageState::trades_energy() const {
  return !linkage->bends().empty() || std::any_of(laws.begin(), laws.end(), [](const ElasticLaw& law) {
    return law.force != 0 || law.damping != 0 || (law.stiffness != 0 && !std::isinf(law.stiffness));
  });
}

double LinkageState::elastic_energy() const {
  double sum = 0;
  for (std::size_t i = 0; i < laws.size(); ++i) {
    const ElasticLaw& law = laws[i];
    if (linkage->is_of_bend(i) || (law.stiffness == 0 && law.force == 0)) continue;
    const double off = linkage->number(linkage->elastics()[i], x, elastic_numbers[i]) - law.rest;
    if (law.one_sided && off <= 0) continue;
    sum += law.force * off;
    if (!std::isinf(law.stiffness)) sum += 0.5 * law.stiffness * off * off;
  }
  for (const BendElastics& bend : linkage->bends()) {
    const Vec3 w = linkage->elastics()[bend.first].sums[0].of(x);
    if (!has_ended(bend)) sum += bending_energy(bend.stiffness, bend.curvature, dot(w, w));
  }
  return sum;
}

double LinkageState::elastic_pull(std::size_t i) const {
  const ElasticLaw& law = laws[i];
  const Elastic& elastic = linkage->elastics()[i];
  if (law.stiffness == 0 && law.damping == 0) return 0;
  const ElasticSlope slope = linkage->slope(elastic, x);
  const double off = linkage->number(elastic, x, elastic_numbers[i]) - law.rest;
  return law.stiffness * off + law.damping * Linkage::rate(elastic, slope, v, linkage->all());
}

void LinkageState::find_gives() {
  gives.resize(laws.size());
  const auto is_solved = [&](std::size_t i) {
    const bool is_slack = laws[i].stiffness == 0 && laws[i].damping == 0;
    return !is_slack && !std::isinf(laws[i].stiffness) && !linkage->is_of_bend(i) &&
           !linkage->elastics()[i].is_loose;
  };
  bool any_solved = false;
  for (std::size_t i = 0; i < laws.size() && !any_solved; ++i) any_solved = is_solved(i);
  if (any_solved && !factor()) return;
  unknowns_.resize(linkage->plan().columns());
  push_.assign(linkage->movable(), Vec3{});
  const std::span<double> right = detail::numbers(unknowns_);
  for (std::size_t i = 0; i < laws.size(); ++i) {
    gives[i] = 0;
    if (laws[i].stiffness == 0 && laws[i].damping == 0) continue;
    const Elastic& elastic = linkage->elastics()[i];
    linkage->push_along(elastic, linkage->slope(elastic, x), 1, push_);
    if (!is_solved(i)) {
      // What is rigid only needs a scale, which its particles alone give. Bends move them across rods.
      for (const std::uint32_t k : elastic.touched) gives[i] += dot(push_[k], push_[k]) / linkage->mass_of(k);
    } else {
      std::fill(right.begin(), right.end(), 0.0);
      linkage->put(push_, right);
      solve(unknowns_);
      for (std::uint32_t k = 0; k < linkage->movable(); ++k)
        gives[i] += dot(push_[k], linkage->taken(right, k));
    }
    for (const std::uint32_t k : elastic.touched) push_[k] = {};
    gives[i] = std::max(gives[i], 0.0);
  }
}

bool LinkageState::can_follow_elastics(double h) {
  if (!linkage->bends().empty() ||
      std::any_of(laws.begin(), laws.end(), [](const ElasticLaw& law) { return law.one_sided; }))
    return false;
  find_gives();
  for (std::size_t i = 0; i < laws.size(); ++i)
    if (!(swing(laws[i], gives[i], h) <= most_swing)) return false;
  return true;
}

double top_speed(const LinkageState& state) {
  double square = 0;
  const auto see = [&](Vec3 v) { square = std::max(square, dot(v, v)); };
  for (const Vec3 v : state.v) see(v);
  for (const Linkage::Ball& ball : state.linkage->balls())
    if (ball.center.size() > 1) see(ball.center.of(state.v));
  return std::sqrt(square) + state.lengths.speed();
}

namespace {

constexpr unsigned is_frozen = bits_of({Problem::Kind::frozen}),
                   is_elastic = bits_of({Problem::Kind::elastic});

/// Returns the mean velocity (m/s) of an island's movable particles, by mass.
Vec3 mean_velocity(const LinkageState& state) {
  double mass = 0;
  Vec3 sum{};
  for (std::uint32_t k = 0; k < state.linkage->movable(); ++k) {
    mass += state.linkage->mass_of(k);
    sum += state.linkage->mass_of(k) * state.v[k];
  }
  return mass > 0 ? 1 / mass * sum : Vec3{};
}

}  // namespace

void LinkageState::take_troubles(Troubles of_cluster, bool others) {
  unsigned own = others ? of_cluster & ~(is_frozen | is_elastic) : 0u;
  if (frozen) own |= of_cluster & is_frozen;
  if (strain != Strain::none) own |= is_elastic;
  troubles = static_cast<Troubles>(own);
}

Troubles LinkageState::troubles_now(bool also_lasting) const {
  unsigned out = asleep ? 0u : troubles;
  if (also_lasting) out |= (troubles & lasting) | (frozen ? is_frozen : 0u);
  return static_cast<Troubles>(out);
}

void LinkageState::follow_slowness(bool is_slow, double dt) {
  if (is_slow && slow_time == 0) slow_from = mean_velocity(*this);
  slow_time = is_slow ? slow_time + dt : 0;
}

double LinkageState::change_within(double time) const {
  return time / slow_time * norm(mean_velocity(*this) - slow_from);
}

double mean_speed(const LinkageState& state) {
  double mass = 0, sum = 0;
  for (std::uint32_t k = 0; k < state.linkage->movable(); ++k) {
    mass += state.linkage->mass_of(k);
    sum += state.linkage->mass_of(k) * dot(state.v[k], state.v[k]);
  }
  return state.lengths.speed() + (mass > 0 ? std::sqrt(sum / mass) : 0);
}

namespace {

/// Returns whether is_it(number) of a fixed particle that holds a capsule or a hull, by its number in the
/// scene.
template <class IsIt>
bool any_anchor(const LinkageState& of, std::uint32_t number, IsIt&& is_it) {
  const auto is_one = [&](std::uint32_t k) { return k >= of.linkage->movable() && is_it(of.particles[k]); };
  const std::span<const Linkage::Shape> capsules = of.linkage->shapes();
  if (number >= capsules.size()) {
    const Linkage::HullShape& hull = of.linkage->hulls()[number - capsules.size()];
    return std::any_of(hull.particles.begin(), hull.particles.end(), is_one);
  }
  const auto has = [&](Terms place) {
    return std::any_of(place.begin(), place.end(), [&](const auto& term) { return is_one(term.particle); });
  };
  return has(capsules[number].a) || has(capsules[number].b);
}

}  // namespace

bool hang_together(const LinkageState& one, std::uint32_t capsule, const LinkageState& other,
                   std::uint32_t other_capsule) {
  if (!one.linkage->is_grounded() || !other.linkage->is_grounded()) return false;
  return any_anchor(one, capsule, [&](std::uint32_t anchor) {
    return any_anchor(other, other_capsule, [&](std::uint32_t each) { return each == anchor; });
  });
}

bool hang_together(const LinkageState& one, std::uint32_t shape, const Linkage::Shape& anchored) {
  return one.linkage->is_grounded() && any_anchor(one, shape, [&](std::uint32_t anchor) {
           const auto has = [&](Terms place) {
             return std::any_of(place.begin(), place.end(),
                                [&](const auto& term) { return term.particle == anchor; });
           };
           return has(anchored.a) || has(anchored.b);
         });
}

}  // namespace plumb::detail
