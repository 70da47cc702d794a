#include "contact/relaxed/crowd.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace plumb::detail {
namespace {

template <class T>
void make_room(layouts::AlignedBuffer<T>& buffer, std::size_t size) {
  if (buffer.size() < size) buffer = layouts::AlignedBuffer<T>(size + size / 2);
}

}  // namespace

template <class T>
void Crowd<T>::gather(std::span<LinkageState* const> cluster, const CrowdRules& rules) {
  const auto moves = [](const LinkageState& state) { return !state.asleep && !state.frozen; };
  changes_lengths_ = std::any_of(cluster.begin(), cluster.end(),
                                 [](const LinkageState* state) { return !state->lengths.changes().empty(); });
  bool is_new = is_stale_ || laid_out_.size() != cluster.size();
  for (std::size_t i = 0; !is_new && i < cluster.size(); ++i)
    is_new = laid_out_[i] != cluster[i] || (moves_[i] != 0) != moves(*cluster[i]);
  if (is_new) {
    is_stale_ = false;
    laid_out_.assign(cluster.begin(), cluster.end());
    moves_.clear();
    for (const LinkageState* const state : cluster) moves_.push_back(moves(*state) ? 1 : 0);
    lay_out(cluster, rules);
  } else if (have_others_changed()) {
    weigh_rods(rules);
  } else {
    follow_lengths();
  }
  origin_ = cluster.front()->x.front();
  anchors_.clear();
  carried_.clear();
  for (std::uint32_t i = 0; i < cluster.size(); ++i) {
    const LinkageState& state = *cluster[i];
    const std::uint32_t movable = state.linkage->movable();
    for (std::uint32_t k = 0; k < state.x.size(); ++k) {
      const std::uint32_t to = number_of(i, k);
      const double inverse = inverse_mass(i, k);
      const Vec3 velocity = moves_[i] != 0 ? state.v[k] : Vec3{};
      put(x_.data(), to, state.x[k] - origin_);
      put(v_.data(), to, velocity);
      put(a_.data(), to, inverse > 0 ? state.linkage->gravity() + inverse * state.force[k] : Vec3{});
      if (k < movable) continue;
      anchors_.push_back(to);
      carried_.push_back(velocity);
    }
  }
}

template <class T>
void Crowd<T>::gather_velocities(const LinkageState& state, std::uint32_t island) {
  for (std::uint32_t k = 0; k < state.linkage->movable(); ++k)
    put(v_.data(), number_of(island, k), state.v[k]);
}

template <class T>
void Crowd<T>::lay_out(std::span<LinkageState* const> cluster, const CrowdRules& rules) {
  places_.lay_out(cluster, moves_, lanes);
  stride_ = places_.component_stride();
  kernels_ = places_.access() == layouts::Access::rows ? &all_kernels_->row_crowds : &all_kernels_->crowds;
  inverse_mass_.clear();
  has_loops_ = false;
  for (std::uint32_t i = 0; i < cluster.size(); ++i) {
    const Linkage& linkage = *cluster[i]->linkage;
    // Anchors close loops, too.
    const std::uint32_t rods_of_tree = linkage.movable() - (linkage.is_grounded() ? 0 : 1);
    has_loops_ = has_loops_ || (moves_[i] != 0 && linkage.rods() > rods_of_tree);
    for (std::uint32_t k = 0; k < linkage.particles(); ++k)
      inverse_mass_.push_back(k < linkage.movable() && moves_[i] != 0 ? 1 / linkage.mass_of(k) : 0);
  }
  ++layout_;
  mass_.assign(places_.numbers(), 0);
  for (std::uint32_t k = 0; k < inverse_mass_.size(); ++k)
    for (std::uint32_t c = 0; c < 3; ++c)
      if (inverse_mass_[k] > 0) mass_[places_.at(k) + c * stride_] = 1 / inverse_mass_[k];
  for (auto* const each : {&x_, &p_, &v_, &a_}) {
    make_room(*each, places_.padded_numbers() + lanes);
    std::fill_n(each->data(), places_.padded_numbers() + lanes, T(0));
  }
  weigh_rods(rules);
}

template <class T>
double Crowd<T>::length2(const CrowdPlaces::Rod& rod) const {
  return rod.length2 * laid_out_[rod.island]->lengths.square(rod.number);
}

/// Notes which rods have changed their lengths, since all others stay as they are weighed.
template <class T>
void Crowd<T>::note_changed() {
  changed_.clear();
  for (std::uint32_t i = 0; i < laid_out_.size(); ++i)
    for (const RodLengths::Change& each : laid_out_[i]->lengths.changes()) changed_.push_back({i, each.rod});
  changed_lanes_.clear();
  if (changed_.empty()) return;
  const auto rods = places_.rods();
  for (std::uint32_t lane = 0; lane < rods.size(); ++lane)
    if (rods[lane].island != none && laid_out_[rods[lane].island]->lengths.find(rods[lane].number))
      changed_lanes_.push_back(lane);
}

/// Returns whether other rods have changed their lengths than when rods were weighed.
template <class T>
bool Crowd<T>::have_others_changed() const {
  std::size_t at = 0;
  for (std::uint32_t i = 0; i < laid_out_.size(); ++i)
    for (const RodLengths::Change& each : laid_out_[i]->lengths.changes()) {
      if (at == changed_.size() || changed_[at] != ChangedRod{i, each.rod}) return true;
      ++at;
    }
  return at != changed_.size();
}

template <class T>
void Crowd<T>::follow_lengths() {
  for (const std::uint32_t lane : changed_lanes_) {
    const double square = length2(places_.rods()[lane]);
    weight(lane, 0) = static_cast<T>(square);
    weight(lane, 3) = static_cast<T>(1 / square);
  }
}

template <class T>
void Crowd<T>::weigh_rods(const CrowdRules& rules) {
  const auto rods = places_.rods();
  make_room(rod_, rods.size() * simd::rod_fields);
  make_room(weight_, rods.size() * simd::weight_fields);
  make_room(moved_, rods.size() * simd::moved_fields);
  mass_of_move_.assign(rods.size(), 0);
  for (std::size_t lane = 0; lane < rods.size(); ++lane) {
    const CrowdPlaces::Rod& rod = rods[lane];
    if (rod.island == none) {
      weight(lane, 0) = 1;
      weight(lane, 1) = weight(lane, 2) = weight(lane, 3) = 0;
      continue;
    }
    const double wa = inverse_mass_[rod.a], wb = inverse_mass_[rod.b];
    const bool by_mass = rules.weights == Weights::mass;
    const double share_a = by_mass ? wa : (wa > 0 ? 1 : 0), share_b = by_mass ? wb : (wb > 0 ? 1 : 0);
    const double scale = rules.omega / 4 / (share_a + share_b), square = length2(rod);
    weight(lane, 0) = static_cast<T>(square);
    weight(lane, 1) = static_cast<T>(scale * share_a);
    weight(lane, 2) = static_cast<T>(scale * share_b);
    weight(lane, 3) = static_cast<T>(1 / square);
    mass_of_move_[lane] = rules.omega / 4 / (wa + wb);
  }
  note_changed();
  find_uniform();
}

/// Finds which vectors have rods alone that are like the first one, so that their weights need not be read.
/// Rods that have changed their lengths are none of them.
template <class T>
void Crowd<T>::find_uniform() {
  ranges_.clear();
  uneven_.clear();
  kept_.clear();
  const auto rods = places_.rods();
  kept_.reserve(rods.size());
  if (rods.empty()) return;
  std::size_t first = 0;  // that stays as it is
  while (first < changed_lanes_.size() && changed_lanes_[first] == first) ++first;
  if (first == rods.size()) first = 0;
  uniform_length2_ = weight(first, 0);
  uniform_share_ = weight(first, 1);
  uniform_inverse_ = weight(first, 3);
  const auto is_uniform = [&](std::size_t lane) {
    if (std::binary_search(changed_lanes_.begin(), changed_lanes_.end(), lane)) return false;
    return rods[lane].island != none && weight(lane, 0) == uniform_length2_ &&
           weight(lane, 1) == uniform_share_ && weight(lane, 2) == uniform_share_ &&
           weight(lane, 3) == uniform_inverse_;
  };
  for (const auto [begin, end] : places_.colors())
    for (std::uint32_t v = begin; v < end; ++v) {
      bool uniform = true;
      for (std::size_t lane = std::size_t{v} * lanes; lane < (std::size_t{v} + 1) * lanes; ++lane)
        uniform = uniform && is_uniform(lane);
      if (v == begin || ranges_.back().uniform != uniform) ranges_.push_back({v, v, uniform});
      ranges_.back().end = v + 1;
    }
  for (const simd::Range& range : ranges_) uneven_.push_back({range.begin, range.end, false});
}

template <class T>
simd::BlockView<T> Crowd<T>::view() {
  return {.x = x_.data(),
          .p = p_.data(),
          .out = p_.data(),
          .component_stride = stride_,
          .rod = rod_.data(),
          .weight = weight_.data(),
          .address_a = places_.address_a(),
          .address_b = places_.address_b(),
          .uniform_length2 = uniform_length2_,
          .uniform_share = uniform_share_,
          .uniform_inverse_length2 = uniform_inverse_,
          .moved = moved_.data()};
}

template <class T>
void Crowd<T>::scatter(LinkageState& state, std::uint32_t island) const {
  if (moves_[island] == 0) return;
  for (std::uint32_t k = 0; k < state.linkage->movable(); ++k) {
    state.x[k] = origin_ + at(x_.data(), number_of(island, k));
    state.v[k] = at(v_.data(), number_of(island, k));
  }
  // Anchors that stand keep their place to the last bit.
  for (std::uint32_t k = state.linkage->movable(); k < state.x.size(); ++k)
    if (state.v[k] != Vec3{}) state.x[k] = origin_ + at(x_.data(), number_of(island, k));
}

template <class T>
void Crowd<T>::prepare(const simd::AccessKernels<T>& kernels, bool counts) {
  restore_lengths();
  const simd::BlockView<T> all = view();
  for (const simd::Range& range : ranges_) kernels.prepare(all, range);
  if (counts) std::fill_n(moved_.data(), places_.rods().size() * simd::moved_fields, T(0));
}

template <class T>
void Crowd<T>::sweep(const simd::AccessKernels<T>& kernels, Gradient gradient, bool counts) {
  const auto& sweeps = counts ? kernels.count : kernels.sweep;
  const std::span<const simd::Range> of = ranges();
  sweeps[static_cast<int>(gradient)](view(), of.data(), static_cast<std::uint32_t>(of.size()));
}

template <class T>
T Crowd<T>::violation(const simd::AccessKernels<T>& kernels) {
  T most = 0;
  const simd::BlockView<T> all = view();
  for (const simd::Range& range : ranges()) most = std::max(most, kernels.violation(all, range));
  return most;
}

template <class T>
void Crowd<T>::keep_violations(double h) {
  const auto rods = places_.rods();
  const auto keeps = [&](std::uint32_t i) {
    const Leftovers& left = laid_out_[i]->leftovers;
    return moves_[i] != 0 && (left.any() || left.keeps(h) > 0);
  };
  std::uint32_t island = 0;
  while (island < islands() && !keeps(island)) ++island;
  if (island == islands()) return;
  kept_.assign(rods.size(), T(0));
  Keeping<T> by({}, h);
  island = none;
  for (std::uint32_t lane = 0; lane < rods.size(); ++lane) {
    const CrowdPlaces::Rod& rod = rods[lane];
    if (rod.island == none) continue;
    const LinkageState& state = *laid_out_[rod.island];
    if (std::exchange(island, rod.island) != rod.island) by = Keeping<T>(state.leftovers, h);
    T& off = rod_[(lane / lanes * simd::rod_fields + 3) * lanes + lane % lanes];
    if (!std::isfinite(off)) continue;
    const bool has_kept = !state.kept_violations.empty();
    kept_[lane] = by.of(off, has_kept ? static_cast<T>(state.kept_violations[rod.number]) : T(0));
    most_kept_ = std::max(most_kept_, double{std::abs(kept_[lane]) * weight(lane, 3)});
    off -= kept_[lane];
    weight(lane, 0) += kept_[lane];
  }
}

template <class T>
void Crowd<T>::end_keeping(std::span<LinkageState* const> cluster, double h) const {
  for (std::uint32_t i = 0; i < cluster.size(); ++i) {
    if (!is_moving(i) || cluster[i]->frozen) continue;
    cluster[i]->leftovers.pass(h);
    cluster[i]->kept_violations.clear();
  }
  if (kept_.empty()) return;
  const auto rods = places_.rods();
  for (std::uint32_t lane = 0; lane < rods.size(); ++lane) {
    if (rods[lane].island == none) continue;
    LinkageState& state = *cluster[rods[lane].island];
    if (state.frozen || !state.leftovers.any()) continue;
    state.kept_violations.resize(state.linkage->rods());
    state.kept_violations[rods[lane].number] = kept_[lane];
  }
}

/// Lets rods be as long again as they are.
template <class T>
void Crowd<T>::restore_lengths() {
  most_kept_ = 0;
  if (kept_.empty()) return;
  kept_.clear();
  const auto rods = places_.rods();
  for (std::uint32_t lane = 0; lane < rods.size(); ++lane)
    if (rods[lane].island != none) weight(lane, 0) = static_cast<T>(length2(rods[lane]));
}

template <class T>
double Crowd<T>::violation_of_positions() const {
  double most = 0;
  for (const CrowdPlaces::Rod& rod : places_.rods()) {
    if (rod.island == none) continue;
    const Vec3 along = position(places_.at(rod.a)) - position(places_.at(rod.b));
    most = std::max(most, std::abs(dot(along, along) / length2(rod) - 1));
  }
  return most;
}

template <class T>
void Crowd<T>::count_pulls(double h, Gradient gradient, std::span<LinkageState* const> cluster) const {
  const double by = (gradient == Gradient::mid ? 2 : 1) / h;
  const auto rods = places_.rods();
  for (std::size_t lane = 0; lane < rods.size(); ++lane) {
    const CrowdPlaces::Rod& rod = rods[lane];
    if (rod.island == none || !cluster[rod.island]->pulls.counts) continue;
    const auto vector_of = [&](const T* fields, std::size_t count) {
      const T* const first = fields + lane / lanes * count * lanes + lane % lanes;
      return Vec3{first[0], first[lanes], first[2 * lanes]};
    };
    const Vec3 move = vector_of(moved_.data(), simd::moved_fields);
    const double size = by * mass_of_move_[lane] * norm(move);
    const Vec3 along = vector_of(rod_.data(), simd::rod_fields);
    const double pull = dot(move, along) > 0 ? size : -size;
    LinkagePulls& pulls = cluster[rod.island]->pulls;
    pulls.rods[rod.number] += pull;
    const std::uint32_t fixed = places_.first(rod.island) + cluster[rod.island]->linkage->movable();
    const Vec3 pulled = pull / norm(along) * along;
    if (rod.a >= fixed) pulls.fixed[rod.a - fixed] += pulled;
    if (rod.b >= fixed) pulls.fixed[rod.b - fixed] -= pulled;
  }
}

template <class T>
double Crowd<T>::add_terms(const Linkage& linkage, std::uint32_t island, Terms sum, double sign,
                           Array<Term>& to) const {
  double moves = 0;
  for (const auto& own : sum) {
    const Term each = term(linkage, island, own);
    to.push_back({each.at, sign * each.weight, sign * each.move});
    moves += each.weight * each.move;
  }
  return moves;
}

template <class T>
void Crowd<T>::push_fixed(std::span<const Term> terms, std::uint32_t island, Vec3 impulse,
                          LinkagePulls& pulls) const {
  const auto fixed = static_cast<std::uint32_t>(pulls.fixed.size());
  const bool is_last = island + 1 == laid_out_.size();
  const std::uint32_t end = is_last ? places_.particles() : places_.first(island + 1);
  for (const Term& term : terms)
    if (const std::uint32_t at = places_.particle_at(term.at); at < end && at >= end - fixed)
      pulls.fixed[at - (end - fixed)] += term.weight * impulse;
}

template class Crowd<float>;
template class Crowd<double>;

}  // namespace plumb::detail
