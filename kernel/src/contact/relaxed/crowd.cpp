#include "contact/relaxed/crowd.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

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
  bool is_new = is_stale_ || laid_out_.size() != cluster.size();
  for (std::size_t i = 0; !is_new && i < cluster.size(); ++i)
    is_new = laid_out_[i] != cluster[i] || (moves_[i] != 0) != moves(*cluster[i]);
  if (is_new) {
    is_stale_ = false;
    laid_out_.assign(cluster.begin(), cluster.end());
    moves_.clear();
    for (const LinkageState* const state : cluster) moves_.push_back(moves(*state) ? 1 : 0);
    lay_out(cluster, rules);
  }
  origin_ = cluster.front()->x.front();
  for (std::uint32_t i = 0; i < cluster.size(); ++i) {
    const LinkageState& state = *cluster[i];
    for (std::uint32_t k = 0; k < state.x.size(); ++k) {
      const std::uint32_t to = record * (first_[i] + k);
      const double inverse = inverse_mass_[first_[i] + k];
      put(x_.data(), to, state.x[k] - origin_);
      put(v_.data(), to, moves_[i] != 0 ? state.v[k] : Vec3{});
      put(a_.data(), to, inverse > 0 ? state.linkage->gravity() + inverse * state.force[k] : Vec3{});
    }
  }
}

template <class T>
void Crowd<T>::gather_velocities(const LinkageState& state, std::uint32_t island) {
  for (std::uint32_t k = 0; k < state.linkage->movable(); ++k)
    put(v_.data(), record * (first_[island] + k), state.v[k]);
}

template <class T>
void Crowd<T>::lay_out(std::span<LinkageState* const> cluster, const CrowdRules& rules) {
  first_.clear();
  inverse_mass_.clear();
  has_loops_ = false;
  for (std::uint32_t i = 0; i < cluster.size(); ++i) {
    const Linkage& linkage = *cluster[i]->linkage;
    // Anchors close loops, too.
    const std::uint32_t rods_of_tree = linkage.movable() - (linkage.is_grounded() ? 0 : 1);
    has_loops_ = has_loops_ || (moves_[i] != 0 && linkage.rods() > rods_of_tree);
    first_.push_back(static_cast<std::uint32_t>(inverse_mass_.size()));
    for (std::uint32_t k = 0; k < linkage.particles(); ++k)
      inverse_mass_.push_back(k < linkage.movable() && moves_[i] != 0 ? 1 / linkage.mass_of(k) : 0);
  }
  particles_ = static_cast<std::uint32_t>(inverse_mass_.size());
  ++layout_;
  mass_.assign(record * inverse_mass_.size(), 0);
  for (std::size_t i = 0; i < mass_.size(); ++i)
    if (const double inverse = inverse_mass_[i / record]; inverse > 0 && i % record < 3)
      mass_[i] = 1 / inverse;
  // Padding lanes have both ends at a record after the last particle.
  for (auto* const each : {&x_, &p_, &v_, &a_}) make_room(*each, record * (particles_ + std::size_t{1}));
  for (auto* const each : {&x_, &p_}) put(each->data(), record * particles_, {});
  lay_out_rods(cluster, rules);
}

template <class T>
void Crowd<T>::lay_out_rods(std::span<LinkageState* const> cluster, const CrowdRules& rules) {
  constexpr std::uint32_t lanes = simd::logical_width<T>;
  colors_.clear();
  address_a_.clear();
  address_b_.clear();
  rod_of_.clear();
  rods_ = 0;
  std::uint32_t most = 0;
  for (const LinkageState* const state : cluster) most = std::max(most, state->linkage->colors());
  for (std::uint32_t color = 0; color < most; ++color) {
    const auto begin = static_cast<std::uint32_t>(rod_of_.size() / lanes);
    for (std::uint32_t i = 0; i < cluster.size(); ++i) {
      if (moves_[i] == 0) continue;
      for (const Linkage::ColoredRod& rod : cluster[i]->linkage->rods_of(color)) {
        address_a_.push_back(record * (first_[i] + rod.a));
        address_b_.push_back(record * (first_[i] + rod.b));
        rod_of_.push_back({i, rod.number, rod.length2, 0});
        ++rods_;
      }
    }
    while (rod_of_.size() % lanes != 0) {
      address_a_.push_back(record * particles_);
      address_b_.push_back(record * particles_);
      rod_of_.push_back({});
    }
    colors_.push_back({begin, static_cast<std::uint32_t>(rod_of_.size() / lanes)});
  }
  make_room(rod_, rod_of_.size() * simd::rod_fields);
  make_room(weight_, rod_of_.size() * simd::weight_fields);
  make_room(moved_, rod_of_.size() * simd::moved_fields);
  for (std::size_t lane = 0; lane < rod_of_.size(); ++lane) {
    T* const fields = weight_.data() + lane / lanes * simd::weight_fields * lanes + lane % lanes;
    RodOf& rod = rod_of_[lane];
    if (rod.island == none) {
      fields[0] = 1;
      fields[lanes] = fields[2 * lanes] = fields[3 * lanes] = 0;
      continue;
    }
    const double wa = inverse_mass_[address_a_[lane] / record], wb = inverse_mass_[address_b_[lane] / record];
    const bool by_mass = rules.weights == Weights::mass;
    const double share_a = by_mass ? wa : (wa > 0 ? 1 : 0), share_b = by_mass ? wb : (wb > 0 ? 1 : 0);
    const double scale = rules.omega / 4 / (share_a + share_b);
    fields[0] = static_cast<T>(rod.length2);
    fields[lanes] = static_cast<T>(scale * share_a);
    fields[2 * lanes] = static_cast<T>(scale * share_b);
    fields[3 * lanes] = static_cast<T>(1 / rod.length2);
    rod.mass = rules.omega / 4 / (wa + wb);
  }
}

template <class T>
simd::BlockView<T> Crowd<T>::view() {
  return {.x = x_.data(),
          .p = p_.data(),
          .out = p_.data(),
          .component_stride = 1,
          .rod = rod_.data(),
          .weight = weight_.data(),
          .address_a = address_a_.data(),
          .address_b = address_b_.data(),
          .uniform_length2 = 1,
          .uniform_share = 0,
          .uniform_inverse_length2 = 1,
          .moved = moved_.data()};
}

template <class T>
void Crowd<T>::scatter(LinkageState& state, std::uint32_t island) const {
  if (moves_[island] == 0) return;
  for (std::uint32_t k = 0; k < state.linkage->movable(); ++k) {
    state.x[k] = origin_ + at(x_.data(), record * (first_[island] + k));
    state.v[k] = at(v_.data(), record * (first_[island] + k));
  }
}

template <class T>
void Crowd<T>::predict(double h, Gradient gradient) {
  const double by = gradient == Gradient::mid ? 0.5 * h * h : h * h;
  for (std::size_t i = 0; i < laid_out_.size(); ++i) {
    const Linkage& linkage = *laid_out_[i]->linkage;
    const T keep = static_cast<T>(h * linkage.kept(gradient == Gradient::mid ? 0.5 * h : h));
    const std::uint32_t begin = record * first_[i], movable = begin + record * linkage.movable(),
                        end = begin + record * linkage.particles();
    for (std::uint32_t k = begin; k < movable; ++k) p_[k] = keep * v_[k] + static_cast<T>(by) * a_[k];
    for (std::uint32_t k = movable; k < end; ++k) p_[k] = static_cast<T>(h) * v_[k];
  }
}

template <class T>
void Crowd<T>::prepare(const simd::AccessKernels<T>& kernels) {
  const simd::BlockView<T> all = view();
  for (const simd::Range& color : colors_) kernels.prepare(all, color);
  std::fill_n(moved_.data(), rod_of_.size() * simd::moved_fields, T(0));
}

template <class T>
void Crowd<T>::sweep(const simd::AccessKernels<T>& kernels, Gradient gradient, bool counts) {
  const auto& sweeps = counts ? kernels.count : kernels.sweep;
  sweeps[static_cast<int>(gradient)](view(), colors_.data(), static_cast<std::uint32_t>(colors_.size()));
}

template <class T>
T Crowd<T>::violation(const simd::AccessKernels<T>& kernels) {
  T most = 0;
  const simd::BlockView<T> all = view();
  for (const simd::Range& color : colors_) most = std::max(most, kernels.violation(all, color));
  return most;
}

template <class T>
double Crowd<T>::violation_before() const {
  double most = 0;
  for (std::size_t lane = 0; lane < rod_of_.size(); ++lane) {
    if (rod_of_[lane].island == none) continue;
    const Vec3 along = at(x_.data(), address_a_[lane]) - at(x_.data(), address_b_[lane]);
    most = std::max(most, std::abs(dot(along, along) / rod_of_[lane].length2 - 1));
  }
  return most;
}

template <class T>
void Crowd<T>::advance(double h, Gradient gradient) {
  const T over = static_cast<T>(1 / h);
  for (std::size_t i = 0; i < laid_out_.size(); ++i) {
    const Linkage& linkage = *laid_out_[i]->linkage;
    const std::uint32_t begin = record * first_[i], movable = begin + record * linkage.movable(),
                        end = begin + record * linkage.particles();
    const T kept = static_cast<T>(linkage.kept(0.5 * h));
    if (gradient == Gradient::mid)
      for (std::uint32_t k = begin; k < movable; ++k) v_[k] = kept * (2 * over * p_[k] - kept * v_[k]);
    else
      for (std::uint32_t k = begin; k < movable; ++k) v_[k] = over * p_[k];
    for (std::uint32_t k = begin; k < end; ++k) x_[k] += p_[k];
  }
}

template <class T>
double Crowd<T>::kinetic(const T* data) const {
  // Sums side by side do not wait for each other.
  constexpr std::size_t side_by_side = 2 * record;
  double twice[side_by_side] = {};
  std::size_t i = 0;
  for (; i + side_by_side <= mass_.size(); i += side_by_side)
    for (std::size_t k = 0; k < side_by_side; ++k)
      twice[k] += mass_[i + k] * (double{data[i + k]} * data[i + k]);
  for (std::size_t k = 0; i + k < mass_.size(); ++k)
    twice[k] += mass_[i + k] * (double{data[i + k]} * data[i + k]);
  return 0.5 * std::accumulate(twice, twice + side_by_side, 0.0);
}

template <class T>
double Crowd<T>::most_moved() const {
  T most = 0;
  for (std::uint32_t k = 0; k < record * particles_; k += record) {
    const T square = (p_[k] * p_[k] + p_[k + 1] * p_[k + 1]) + p_[k + 2] * p_[k + 2];
    most = square > most ? square : most;
  }
  return std::sqrt(double{most});
}

template <class T>
void Crowd<T>::slow(double share, Vec3 about) {
  for (std::uint32_t k = 0; k < particles_; ++k)
    if (inverse_mass_[k] > 0) put(v_.data(), record * k, about + share * (at(v_.data(), record * k) - about));
}

template <class T>
auto Crowd<T>::common_motion() const -> CommonMotion {
  CommonMotion out;
  Vec3 momentum{};
  double mass = 0;
  for (std::uint32_t k = 0; k < particles_; ++k) {
    if (!(inverse_mass_[k] > 0)) return {};
    mass += 1 / inverse_mass_[k];
    momentum += 1 / inverse_mass_[k] * at(v_.data(), record * k);
  }
  out.velocity = (1 / mass) * momentum;
  out.energy = 0.5 * mass * dot(out.velocity, out.velocity);
  return out;
}

template <class T>
bool Crowd<T>::stop_if_broken(LinkageState& state, std::uint32_t island) {
  const std::uint32_t begin = record * first_[island], end = begin + record * state.linkage->movable();
  T zeros[record] = {};  // they stay so unless a number is infinite or none
  for (std::uint32_t k = begin; k < end; k += record)
    for (std::uint32_t c = 0; c < record; ++c) zeros[c] += T(0) * x_[k + c] + T(0) * v_[k + c];
  if (std::all_of(zeros, zeros + record, [](T zero) { return zero == 0; })) return false;
  for (std::uint32_t k = 0; k < state.linkage->movable(); ++k) {
    put(x_.data(), begin + record * k, state.x[k] - origin_);
    put(v_.data(), begin + record * k, {});
    put(a_.data(), begin + record * k, {});
    inverse_mass_[first_[island] + k] = 0;
    std::fill_n(mass_.begin() + record * (first_[island] + k), record, 0.0);
  }
  is_stale_ = true;
  return true;
}

template <class T>
void Crowd<T>::count_pulls(double h, Gradient gradient, std::span<LinkageState* const> cluster) const {
  constexpr std::size_t lanes = simd::logical_width<T>;
  const double by = (gradient == Gradient::mid ? 2 : 1) / h;
  for (std::size_t lane = 0; lane < rod_of_.size(); ++lane) {
    const RodOf& rod = rod_of_[lane];
    if (rod.island == none || !cluster[rod.island]->pulls.counts) continue;
    const auto vector_of = [&](const T* fields, std::size_t count) {
      const T* const first = fields + lane / lanes * count * lanes + lane % lanes;
      return Vec3{first[0], first[lanes], first[2 * lanes]};
    };
    const Vec3 move = vector_of(moved_.data(), simd::moved_fields);
    const double size = by * rod.mass * norm(move);
    const Vec3 along = vector_of(rod_.data(), simd::rod_fields);
    const double pull = dot(move, along) > 0 ? size : -size;
    LinkagePulls& pulls = cluster[rod.island]->pulls;
    pulls.rods[rod.number] += pull;
    const std::uint32_t fixed = first_[rod.island] + cluster[rod.island]->linkage->movable();
    const Vec3 pulled = pull / norm(along) * along;
    if (const std::uint32_t a = address_a_[lane] / record; a >= fixed) pulls.fixed[a - fixed] += pulled;
    if (const std::uint32_t b = address_b_[lane] / record; b >= fixed) pulls.fixed[b - fixed] -= pulled;
  }
}

template <class T>
double Crowd<T>::add_terms(const Linkage& linkage, std::uint32_t island, const Combination& sum, double sign,
                           std::vector<Term>& to) const {
  double moves = 0;
  for (std::uint32_t k = 0; k < sum.count; ++k) {
    const auto [particle, weight] = sum.terms[k];
    const double move = particle < linkage.movable() ? weight * inverse_mass(island, particle) : 0;
    to.push_back({record * (first_[island] + particle), sign * weight, sign * move});
    moves += weight * move;
  }
  return moves;
}

template <class T>
void Crowd<T>::push_fixed(std::span<const Term> terms, std::uint32_t island, Vec3 impulse,
                          LinkagePulls& pulls) const {
  const auto fixed = static_cast<std::uint32_t>(pulls.fixed.size());
  const std::uint32_t end = island + 1 < first_.size() ? first_[island + 1] : particles_;
  for (const Term& term : terms)
    if (const std::uint32_t at = term.at / record; at < end && at >= end - fixed)
      pulls.fixed[at - (end - fixed)] += term.weight * impulse;
}

template class Crowd<float>;
template class Crowd<double>;

}  // namespace plumb::detail
