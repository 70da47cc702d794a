#include "plumb/embedding/frames.hpp"

#include <algorithm>
#include <cmath>

#include "scene/refuse.hpp"
#include "step/world_impl.hpp"

namespace plumb {

void Frames::update(const World& world) {
  const std::size_t known = now_.size();
  std::swap(now_, before_);
  now_.resize(world.particle_count());
  world.copy_positions(now_);
  before_.resize(now_.size());
  const std::span<const std::uint32_t> generations = world.impl_->step->population().particles.generations();
  const std::span<const std::uint32_t> teleports = world.impl_->teleports;
  const auto differ = [](std::span<const std::uint32_t> now, std::span<const std::uint32_t> before,
                         std::size_t i, std::uint32_t at_first) {
    const auto of = [&](std::span<const std::uint32_t> all) { return i < all.size() ? all[i] : at_first; };
    return of(now) != of(before);
  };
  const auto is_other = [&](std::size_t i) {
    return i >= known || differ(generations, generations_, i, 1) || differ(teleports, teleports_, i, 0);
  };
  moved_.clear();
  const auto has_moved = [&](std::size_t i) {
    if (!is_other(i)) return now_[i] != before_[i];
    before_[i] = now_[i];
    return true;
  };
  for (std::size_t i = 0, end = 0; i < now_.size(); i = end + 1) {
    for (end = i; end < now_.size() && has_moved(end);) ++end;
    if (end > i) moved_.push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(end - i)});
  }
  generations_.assign(generations.begin(), generations.end());
  teleports_.assign(teleports.begin(), teleports.end());
}

template <class Real>
void Frames::write(const StridedVectors<Real>& out, double share,
                   std::span<const ParticleRange> ranges) const {
  if (out.count != now_.size())
    detail::refuse("frames: positions of ", now_.size(), " particles cannot be written to ", out.count,
                   " vectors");
  if (out.stride < 3 * sizeof(Real) || out.stride % sizeof(Real) != 0)
    detail::refuse("frames: a stride of ", out.stride, " bytes does not fit vectors of numbers of ",
                   sizeof(Real));
  if (!std::isfinite(share)) detail::refuse("frames: the share must be finite, got ", share);
  const std::size_t stride = out.stride / sizeof(Real);
  const auto put = [&](const ParticleRange& range, auto&& at) {
    Real* to = out.first + range.first * stride;
    for (std::size_t i = range.first; i < std::size_t{range.first} + range.count; ++i, to += stride) {
      const Vec3 p = at(i);
      to[0] = static_cast<Real>(p.x);
      to[1] = static_cast<Real>(p.y);
      to[2] = static_cast<Real>(p.z);
    }
  };
  for (const ParticleRange& range : ranges)
    if (share == 1)
      put(range, [&](std::size_t i) { return now_[i]; });
    else
      put(range, [&](std::size_t i) { return (1 - share) * before_[i] + share * now_[i]; });
}

void Frames::copy(const StridedVectors<float>& out, double share) const {
  const ParticleRange all{0, static_cast<std::uint32_t>(now_.size())};
  write(out, share, {&all, 1});
}
void Frames::copy(const StridedVectors<double>& out, double share) const {
  const ParticleRange all{0, static_cast<std::uint32_t>(now_.size())};
  write(out, share, {&all, 1});
}
void Frames::copy_moved(const StridedVectors<float>& out, double share) const {
  write(out, share, moved_);
}
void Frames::copy_moved(const StridedVectors<double>& out, double share) const {
  write(out, share, moved_);
}

}  // namespace plumb
