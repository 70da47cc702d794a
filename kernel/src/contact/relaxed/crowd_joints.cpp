#include "contact/relaxed/crowd_joints.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "contact/rows.hpp"

namespace plumb::detail {

// --- What there is

template <class T>
auto CrowdJoints<T>::add_sums(std::uint32_t island, const Linkage& linkage, const Crowd<T>& crowd,
                              std::span<const Combination> sums) -> TermRange {
  const auto first = static_cast<std::uint32_t>(sums_terms_.size());
  const std::size_t before = terms_.size();
  for (std::size_t s = 0; s < sums.size(); ++s) {
    crowd.add_terms(linkage, island, sums[s], 1, terms_);
    for (std::size_t k = before; k < terms_.size(); ++k) {
      const auto same = std::find_if(sums_terms_.begin() + first, sums_terms_.end(),
                                     [&](const SumsTerm& each) { return each.at == terms_[k].at; });
      SumsTerm& term =
          same == sums_terms_.end() ? sums_terms_.emplace_back(SumsTerm{terms_[k].at, {}, 0}) : *same;
      term.weight[s] += terms_[k].weight;
      const std::uint32_t particle = sums[s].terms[k - before].particle;
      term.inverse_mass = crowd.inverse_mass(island, particle);
    }
    terms_.resize(before);
  }
  return {first, static_cast<std::uint32_t>(sums_terms_.size())};
}

template <class T>
void CrowdJoints<T>::mark_bodies(const Linkage& linkage) {
  in_body_.assign(linkage.particles(), 0);
  for (const BodyShape& body : linkage.bodies())
    for (const std::uint32_t particle : body.particles) in_body_[particle] = 1;
}

template <class T>
void CrowdJoints<T>::gather(std::span<LinkageState* const> cluster, const Crowd<T>& crowd) {
  terms_.clear();
  sums_terms_.clear();
  balls_.clear();
  dots_.clear();
  distances_.clear();
  sources_.clear();
  has_elastics_ = false;
  for (std::uint32_t i = 0; i < cluster.size(); ++i) {
    if (!crowd.is_moving(i)) continue;
    const LinkageState& state = *cluster[i];
    const Linkage& linkage = *state.linkage;
    const auto add_terms = [&](const Combination& sum, double& moves) {
      const auto first = static_cast<std::uint32_t>(terms_.size());
      moves = crowd.add_terms(linkage, i, sum, 1, terms_);
      return TermRange{first, static_cast<std::uint32_t>(terms_.size())};
    };
    std::uint32_t number = 0;
    linkage.for_pins([&](const Combination& apart) {
      double moves = 0;
      const TermRange terms = add_terms(apart, moves);
      balls_.push_back({terms, i, number++, moves > 0 ? 1 / moves : 0});
    });
    linkage.for_alignments([&](const Combination& u, const Combination& v, double value) {
      dots_.push_back({add_sums(i, linkage, crowd, std::array{u, v}), i, value});
    });
    for (std::uint32_t k = 0; k < state.angle_rules.size(); ++k) {
      const Linkage::Angle& angle = linkage.angles()[k];
      sources_.push_back({add_sums(i, linkage, crowd, std::array{angle.u, angle.v}), i, k, none});
    }
    if (linkage.elastics().empty()) continue;
    has_elastics_ = true;
    mark_bodies(linkage);
    for (std::uint32_t k = 0; k < linkage.elastics().size(); ++k) {
      const Elastic& elastic = linkage.elastics()[k];
      if (elastic.kind != Elastic::Kind::distance) {
        sources_.push_back({add_sums(i, linkage, crowd, elastic.sums), i, none, k, pulls_body(elastic)});
        continue;
      }
      double moves = 0;
      const TermRange terms = add_terms(elastic.sums[0], moves);
      distances_.push_back({terms, i, k, pulls_body(elastic), moves});
    }
  }
}

// --- A substep

template <class T>
void CrowdJoints<T>::begin(std::span<LinkageState* const> cluster, const Crowd<T>& crowd, double h,
                           double recovery_rate) {
  h_ = h;
  for (std::uint32_t i = 0; i < cluster.size(); ++i)
    if (crowd.is_moving(i)) cluster[i]->follow_bends(h);
  for (BallJoint& joint : balls_) {
    joint.apart = crowd.position(terms_of(joint.terms));
    joint.push = {};
  }
  for (Dot& each : dots_) {
    each.u = each.v = {};
    for (const SumsTerm& term : sums_of(each.terms)) {
      const Vec3 x = crowd.position(term.at);
      each.u += term.weight[0] * x;
      each.v += term.weight[1] * x;
    }
  }
  laws_.clear();
  for (Distance& each : distances_) {
    each.apart = crowd.position(terms_of(each.terms));
    each.length = norm(each.apart);
    each.push = {};
    each.pull = 0;
    laws_.push_back(&cluster[each.island]->laws[each.number]);
  }
  rows_.clear();
  for (const Source& source : sources_) add_rows(source, *cluster[source.island], h, recovery_rate);
}

template <class T>
void CrowdJoints<T>::add_rows(const Source& source, LinkageState& state, double h, double recovery_rate) {
  const Linkage& linkage = *state.linkage;
  Row row{.terms = source.terms,
          .island = source.island,
          .control = source.control,
          .elastic = source.elastic,
          .pulls_body = source.pulls_body};
  const auto add = [&](double off, double stiff, double give, double least, double most) {
    row.moves = 0;
    for (const SumsTerm& term : sums_of(row.terms)) {
      Vec3 along;
      for (std::size_t s = 0; s < 3; ++s) along += term.weight[s] * row.along[s];
      row.moves += term.inverse_mass * dot(along, along);
    }
    row.off = off;
    row.stiff = stiff;
    row.give = give;
    row.least = least;
    row.most = most;
    if (row.moves > 0) rows_.push_back(row);
  };
  if (source.elastic != none) {
    const ElasticLaw& law = state.laws[source.elastic];
    const Elastic& elastic = linkage.elastics()[source.elastic];
    if (law.stiffness == 0 && law.damping == 0 && law.force == 0) return;
    const double excess = linkage.number(elastic, state.x, state.elastic_numbers[source.elastic]) - law.rest;
    row.along = linkage.slope(elastic, state.x);
    return add(h * h * (law.stiffness * excess + law.force), h * h * law.stiffness + h * law.damping, 1,
               -INFINITY, INFINITY);
  }
  const Linkage::AngleRule& rule = state.angle_rules[source.control];
  if (rule.lower == 0 && rule.upper == std::numbers::pi && rule.friction == 0) return;
  const Linkage::Angle& angle = linkage.angles()[source.control];
  const Vec3 u = angle.u.of(state.x);
  const auto [value, along_u, along_v] = Linkage::slope(u, angle.v.of(state.x));
  row.along = {along_u, along_v, Vec3{}};
  // Directions that are parallel have no way to part in, and a push along next to none would throw them.
  if (dot(along_u, along_u) * dot(u, u) < 0.25) return;
  const double share = h * recovery_rate;
  if (rule.lower > 0) add(recovered(value - rule.lower, 0, share), 1, 0, 0, INFINITY);
  if (rule.upper < std::numbers::pi) add(-recovered(rule.upper - value, 0, share), 1, 0, -INFINITY, 0);
  if (rule.friction > 0) add(0, 1, 0, -h * h * rule.friction, h * h * rule.friction);
}

template <class T>
bool CrowdJoints<T>::pull_bodies(Crowd<T>& crowd) {
  // A pull changes by about this share where its ends give way.
  constexpr double least_stiff = 0.01;
  bool is_stiff = false;
  for (std::size_t i = 0; i < distances_.size(); ++i) {
    Distance& each = distances_[i];
    if (!each.pulls_body) continue;
    visit(crowd, each, *laws_[i]);
    is_stiff = is_stiff || stiffness_of(*laws_[i]) * each.moves > least_stiff;
  }
  for (Row& row : rows_) {
    if (!row.pulls_body) continue;
    visit(crowd, row);
    is_stiff = is_stiff || row.stiff * row.moves > least_stiff * row.give;
  }
  return is_stiff;
}

template <class T>
void CrowdJoints<T>::sweep(Crowd<T>& crowd) {
  for (std::size_t i = 0; i < distances_.size(); ++i) visit(crowd, distances_[i], *laws_[i]);
  for (BallJoint& joint : balls_) {
    const std::span<const Term> terms = terms_of(joint.terms);
    const Vec3 by = -joint.over * (joint.apart + crowd.moved(terms));
    joint.push += by;
    crowd.push(terms, by);
  }
  for (const Dot& each : dots_) {
    Vec3 u = each.u, v = each.v;
    for (const SumsTerm& term : sums_of(each.terms)) {
      const Vec3 p = crowd.moved(term.at);
      u += term.weight[0] * p;
      v += term.weight[1] * p;
    }
    double moves = 0;
    for (const SumsTerm& term : sums_of(each.terms)) {
      const Vec3 along = term.weight[0] * v + term.weight[1] * u;
      moves += term.inverse_mass * dot(along, along);
    }
    if (!(moves > 0)) continue;
    const double push = (each.value - dot(u, v)) / moves;
    for (const SumsTerm& term : sums_of(each.terms))
      crowd.push(term.at, push * term.inverse_mass * (term.weight[0] * v + term.weight[1] * u));
  }
  for (Row& row : rows_) visit(crowd, row);
}

/// Rods that are rigid are projected from where they are, as rods without a law are: where they do not fit,
/// what they pushed before grows without bound, and has any direction.
template <class T>
void CrowdJoints<T>::visit(Crowd<T>& crowd, Distance& distance, const ElasticLaw& law) const {
  const double moves = distance.moves;
  if (!(moves > 0) || (law.stiffness == 0 && law.damping == 0 && law.force == 0)) return;
  const std::span<const Term> terms = terms_of(distance.terms);
  const Vec3 now = distance.apart + crowd.moved(terms);
  if (std::isinf(law.stiffness)) {
    const double length = norm(now);
    if (!(length > 0)) return;
    const double wanted = distance.pull + (length - law.rest) / moves;
    const double pull = law.one_sided ? std::max(wanted, 0.0) : wanted;
    crowd.push(terms, (distance.pull - pull) / length * now);
    distance.pull = pull;
    return;
  }
  // Where its ends would be without it.
  const Vec3 free = now - moves * distance.push;
  const double length = norm(free), excess = length - law.rest;
  const double stiff = stiffness_of(law);
  double pull =
      (h_ * h_ * (law.stiffness * excess + law.force) + h_ * law.damping * (length - distance.length)) /
      (1 + stiff * moves);
  if (law.one_sided && (!(excess > 0) || pull < 0)) pull = 0;
  const Vec3 push = length > 0 ? -pull / length * free : Vec3{};
  crowd.push(terms, push - distance.push);
  distance.push = push;
  distance.pull = pull;
}

template <class T>
void CrowdJoints<T>::visit(Crowd<T>& crowd, Row& row) const {
  const std::span<const SumsTerm> terms = sums_of(row.terms);
  const auto along_of = [&](const SumsTerm& term) {
    return term.weight[0] * row.along[0] + term.weight[1] * row.along[1] + term.weight[2] * row.along[2];
  };
  double changed = 0;
  for (const SumsTerm& term : terms) changed += dot(along_of(term), crowd.moved(term.at));
  const double left = row.give * row.push + row.off + row.stiff * changed;
  const double push = std::clamp(row.push - left / (row.give + row.stiff * row.moves), row.least, row.most);
  const double by = push - row.push;
  if (by == 0) return;
  row.push = push;
  for (const SumsTerm& term : terms) crowd.push(term.at, by * term.inverse_mass * along_of(term));
}

template <class T>
double CrowdJoints<T>::sweep_velocities(std::span<LinkageState* const> cluster,
                                        std::span<const std::uint8_t> of, Crowd<T>& crowd) const {
  double most = 0;
  for (const BallJoint& joint : balls_) {
    if (of[joint.island] == 0) continue;
    const std::span<const Term> terms = terms_of(joint.terms);
    const Vec3 apart = crowd.velocity(terms), by = -joint.over * apart;
    crowd.push_velocity(terms, by);
    most = std::max(most, norm(apart));
    LinkagePulls& pulls = cluster[joint.island]->pulls;
    if (!pulls.counts) continue;
    pulls.pins[joint.number] += by;
    crowd.push_fixed(terms, joint.island, by, pulls);
  }
  for (const Dot& each : dots_)
    if (of[each.island] != 0) most = std::max(most, sweep_velocities(each, crowd));
  return most;
}

template <class T>
double CrowdJoints<T>::sweep_velocities(const Dot& of, Crowd<T>& crowd) const {
  Vec3 u{}, v{}, u_rate{}, v_rate{};
  for (const SumsTerm& term : sums_of(of.terms)) {
    const Vec3 x = crowd.position(term.at), rate = crowd.velocity(term.at);
    u += term.weight[0] * x;
    v += term.weight[1] * x;
    u_rate += term.weight[0] * rate;
    v_rate += term.weight[1] * rate;
  }
  double moves = 0, most = 0;
  const auto along = [&](const SumsTerm& term) { return term.weight[0] * v + term.weight[1] * u; };
  for (const SumsTerm& term : sums_of(of.terms)) moves += term.inverse_mass * dot(along(term), along(term));
  if (!(moves > 0)) return 0;
  const double push = -(dot(u_rate, v) + dot(u, v_rate)) / moves;
  for (const SumsTerm& term : sums_of(of.terms)) {
    const Vec3 by = push * term.inverse_mass * along(term);
    crowd.push_velocity(term.at, by);
    most = std::max(most, norm(by));
  }
  return most;
}

template <class T>
std::uint32_t CrowdJoints<T>::end(std::span<LinkageState* const> cluster, const Crowd<T>& crowd, double h) {
  std::uint32_t broken = 0;
  for (std::size_t i = 0; i < distances_.size(); ++i) {
    const Distance& each = distances_[i];
    LinkageState& state = *cluster[each.island];
    if (state.pulls.counts) state.linkage->count_pull(each.number, state.x, each.pull / h, state.pulls);
    if (each.number >= state.broken.size() || !(each.pull > h * h * laws_[i]->strength)) continue;
    state.break_rod(each.number);
    ++broken;
  }
  for (const BallJoint& joint : balls_) {
    LinkagePulls& pulls = cluster[joint.island]->pulls;
    if (!pulls.counts) continue;
    pulls.pins[joint.number] += 1 / h * joint.push;
    crowd.push_fixed(terms_of(joint.terms), joint.island, 1 / h * joint.push, pulls);
  }
  for (const Row& row : rows_) {
    LinkageState& state = *cluster[row.island];
    if (!state.pulls.counts) continue;
    if (row.control != none)
      state.pulls.angles[row.control] += row.push / h;
    else
      state.linkage->count_pull(row.elastic, state.x, -row.push / h, state.pulls);
  }
  return broken;
}

template class CrowdJoints<float>;
template class CrowdJoints<double>;

}  // namespace plumb::detail
