// This file moves the particles of a crowd, and looks at how they move.

#include <algorithm>
#include <array>
#include <cmath>

#include "contact/relaxed/crowd.hpp"

namespace plumb::detail {

template <class T>
void Crowd<T>::predict(double h, Gradient gradient) {
  const T by = static_cast<T>(gradient == Gradient::mid ? 0.5 * h * h : h * h);
  for (std::uint32_t i = 0; i < laid_out_.size(); ++i) {
    const Linkage& linkage = *laid_out_[i]->linkage;
    const T keep = static_cast<T>(h * linkage.kept(gradient == Gradient::mid ? 0.5 * h : h));
    const std::uint32_t begin = places_.begin_of(i);
    kernels_->predict(&p_[begin], &v_[begin], &a_[begin], keep, by, places_.end_of(i) - begin);
  }
  for (std::size_t i = 0; i < anchors_.size(); ++i) {
    const Vec3 v = carried_[i];
    for (std::uint32_t c = 0; c < 3; ++c)
      p_[anchors_[i] + c * stride_] = static_cast<T>(h) * static_cast<T>(c == 0 ? v.x : c == 1 ? v.y : v.z);
  }
}

template <class T>
void Crowd<T>::advance(double h, Gradient gradient) {
  const T over = static_cast<T>(1 / h);
  for (std::uint32_t i = 0; i < laid_out_.size(); ++i) {
    const std::uint32_t begin = places_.begin_of(i), count = places_.end_of(i) - begin;
    const T kept = static_cast<T>(laid_out_[i]->linkage->kept(0.5 * h));
    T *const x = &x_[begin], *const v = &v_[begin];
    const T* const p = &p_[begin];
    if (gradient != Gradient::mid) {
      kernels_->advance(x, v, p, over, count);
      continue;
    }
    for (std::uint32_t k = 0; k < count; ++k) {
      v[k] = kept * (2 * over * p[k] - kept * v[k]);
      x[k] += p[k];
    }
  }
  for (std::size_t i = 0; i < anchors_.size(); ++i) put(v_.data(), anchors_[i], carried_[i]);
}

template <class T>
double Crowd<T>::most_moved() const {
  return std::sqrt(double{kernels_->farthest(p_.data(), places_.numbers())});
}

template <class T>
void Crowd<T>::slow(double share, Vec3 about) {
  for (std::uint32_t k = 0; k < inverse_mass_.size(); ++k)
    if (const std::uint32_t to = places_.at(k); inverse_mass_[k] > 0)
      put(v_.data(), to, about + share * (at(v_.data(), to) - about));
}

template <class T>
auto Crowd<T>::common_motion() const -> CommonMotion {
  CommonMotion out;
  Vec3 momentum{};
  double mass = 0;
  for (std::uint32_t k = 0; k < inverse_mass_.size(); ++k) {
    if (!(inverse_mass_[k] > 0)) return {};
    mass += 1 / inverse_mass_[k];
    momentum += 1 / inverse_mass_[k] * at(v_.data(), places_.at(k));
  }
  out.velocity = (1 / mass) * momentum;
  out.energy = 0.5 * mass * dot(out.velocity, out.velocity);
  return out;
}

template <class T>
std::span<const std::uint32_t> Crowd<T>::list_fast(const Bounds& box, double least,
                                                   Array<std::uint32_t>& room) const {
  const auto three = [](Vec3 v) {
    return std::array{static_cast<T>(v.x), static_cast<T>(v.y), static_cast<T>(v.z)};
  };
  room.resize(places_.particles());
  const simd::FastRules<T> rules{three(box.low), three(box.high), static_cast<T>(least * least)};
  return std::span(room).first(
      kernels_->list_fast(x_.data(), p_.data(), rules, places_.numbers(), room.data()));
}

template <class T>
bool Crowd<T>::is_finite() const {
  // Padding is none of a particle, and 0.
  const std::uint32_t count = (places_.numbers() + lanes - 1) / lanes * lanes;
  return all_kernels_->particles.all_finite(x_.data(), v_.data(), count);
}

template <class T>
bool Crowd<T>::stop_if_broken(LinkageState& state, std::uint32_t island) {
  constexpr std::uint32_t side_by_side = 4;
  T zeros[side_by_side] = {};  // they stay so unless a number is infinite or none
  const std::uint32_t begin = places_.begin_of(island), end = places_.end_of(island);
  for (std::uint32_t k = begin; k < end; k += side_by_side)
    for (std::uint32_t c = 0; c < side_by_side; ++c) zeros[c] += T(0) * x_[k + c] + T(0) * v_[k + c];
  if (std::all_of(zeros, zeros + side_by_side, [](T zero) { return zero == 0; })) return false;
  for (std::uint32_t k = 0; k < state.linkage->movable(); ++k) {
    const std::uint32_t particle = places_.first(island) + k, to = places_.at(particle);
    put(x_.data(), to, state.x[k] - origin_);
    put(v_.data(), to, {});
    put(a_.data(), to, {});
    inverse_mass_[particle] = 0;
    for (std::uint32_t c = 0; c < 3; ++c) mass_[to + c * stride_] = 0;
  }
  is_stale_ = true;
  return true;
}

template void Crowd<float>::predict(double, Gradient);
template void Crowd<float>::advance(double, Gradient);
template double Crowd<float>::most_moved() const;
template std::span<const std::uint32_t> Crowd<float>::list_fast(const Bounds&, double,
                                                                Array<std::uint32_t>&) const;
template void Crowd<float>::slow(double, Vec3);
template Crowd<float>::CommonMotion Crowd<float>::common_motion() const;
template bool Crowd<float>::is_finite() const;
template bool Crowd<float>::stop_if_broken(LinkageState&, std::uint32_t);
template void Crowd<double>::predict(double, Gradient);
template void Crowd<double>::advance(double, Gradient);
template double Crowd<double>::most_moved() const;
template std::span<const std::uint32_t> Crowd<double>::list_fast(const Bounds&, double,
                                                                 Array<std::uint32_t>&) const;
template void Crowd<double>::slow(double, Vec3);
template Crowd<double>::CommonMotion Crowd<double>::common_motion() const;
template bool Crowd<double>::is_finite() const;
template bool Crowd<double>::stop_if_broken(LinkageState&, std::uint32_t);

}  // namespace plumb::detail
