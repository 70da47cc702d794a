// This file finds where the particles of a crowd may go within a step.

#include <algorithm>

#include "contact/linkage/linkage_bounds.hpp"
#include "contact/relaxed/pairs/crowd_pairs.hpp"
#include "contact/relaxed/pairs/ways.hpp"

namespace plumb::detail {

/// Finds where the particles of a crowd may go, and `more` (m) around that.
template <class T>
void CrowdPairs<T>::bound_particles(std::span<LinkageState* const> cluster, const Crowd<T>& crowd, double dt,
                                    double more) {
  std::uint32_t at = 0;
  for (std::uint32_t i = 0; i < cluster.size(); ++i) {
    const Linkage& linkage = *cluster[i]->linkage;
    const bool moves = crowd.is_moving(i);
    const double fall = moves ? fall_in(linkage, dt) + margin_ + thrown_[i] + more : 0;
    for (std::uint32_t k = 0; k < linkage.particles(); ++k) {
      at = crowd.number_of(i, k);
      const Bounds way = passed_through(crowd.position(at), dt * crowd.velocity(at), fall);
      const double low[3] = {way.low.x, way.low.y, way.low.z}, high[3] = {way.high.x, way.high.y, way.high.z};
      for (std::uint32_t c = 0; c < 3; ++c) {
        low_[at + c * stride_] = static_cast<T>(low[c]);
        high_[at + c * stride_] = static_cast<T>(high[c]);
      }
    }
  }
}

template <class T>
Bounds CrowdPairs<T>::particle_bounds(std::uint32_t at) const {
  const std::uint32_t y = at + stride_, z = y + stride_;
  return {{low_[at], low_[y], low_[z]}, {high_[at], high_[y], high_[z]}};
}

template <class T>
void CrowdPairs<T>::include_particle(std::uint32_t at, const Bounds& bounds) {
  const double low[3] = {bounds.low.x, bounds.low.y, bounds.low.z},
               high[3] = {bounds.high.x, bounds.high.y, bounds.high.z};
  for (std::uint32_t c = 0; c < 3; ++c) {
    T &least = low_[at + c * stride_], &most = high_[at + c * stride_];
    least = std::min(least, static_cast<T>(low[c]));
    most = std::max(most, static_cast<T>(high[c]));
  }
}

/// Returns whether displacements take all particles to where they were looked for. Then no line leaves its
/// bounds.
template <class T>
bool CrowdPairs<T>::are_in_bounds(const Crowd<T>& crowd) const {
  // Numbers side by side are compared in vectors. All layouts fill whole ones.
  constexpr std::size_t side_by_side = 4;
  const T *const x = crowd.positions(), *const p = crowd.displacements();
  T out[side_by_side] = {};
  for (std::size_t i = 0; i < low_.size(); i += side_by_side)
    for (std::size_t k = 0; k < side_by_side; ++k) {
      const T at = x[i + k] + p[i + k], below = low_[i + k] - at, above = at - high_[i + k];
      const T most = below > above ? below : above;
      out[k] = most > out[k] ? most : out[k];
    }
  return std::all_of(out, out + side_by_side, [](T each) { return each == 0; });
}

template void CrowdPairs<float>::bound_particles(std::span<LinkageState* const>, const Crowd<float>&, double,
                                                 double);
template Bounds CrowdPairs<float>::particle_bounds(std::uint32_t) const;
template void CrowdPairs<float>::include_particle(std::uint32_t, const Bounds&);
template bool CrowdPairs<float>::are_in_bounds(const Crowd<float>&) const;
template void CrowdPairs<double>::bound_particles(std::span<LinkageState* const>, const Crowd<double>&,
                                                  double, double);
template Bounds CrowdPairs<double>::particle_bounds(std::uint32_t) const;
template void CrowdPairs<double>::include_particle(std::uint32_t, const Bounds&);
template bool CrowdPairs<double>::are_in_bounds(const Crowd<double>&) const;

}  // namespace plumb::detail
