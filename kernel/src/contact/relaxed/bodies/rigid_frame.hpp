#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "contact/relaxed/crowd.hpp"

namespace plumb::detail {

/// This is a body of four particles where it is, as a rigid one.
struct RigidFrame {
  std::array<std::uint32_t, 4> at;  ///< places of its particles
  std::array<double, 4> mass;       ///< kg
  std::array<Vec3, 4> offsets;      ///< m, from its middle
  Vec3 middle;                      ///< m, from the crowd's origin
  double inverse_mass;              ///< 1/kg, of all
  std::array<Vec3, 3> adjugate;     ///< kg² m⁴, of its inertia, by columns
  double determinant;               ///< kg³ m⁶, of its inertia
};

/// Returns that of a body of an island, or none if some of its particles are fixed or it has no volume.
template <class T>
std::optional<RigidFrame> rigid_frame(const Crowd<T>& crowd, std::uint32_t island,
                                      const std::array<std::uint32_t, 4>& particles) {
  RigidFrame out{};
  double all = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const double inverse = crowd.inverse_mass(island, particles[i]);
    if (!(inverse > 0)) return std::nullopt;
    out.at[i] = crowd.number_of(island, particles[i]);
    out.mass[i] = 1 / inverse;
    out.offsets[i] = crowd.position(out.at[i]);
    all += out.mass[i];
    out.middle += out.mass[i] * out.offsets[i];
  }
  out.inverse_mass = 1 / all;
  out.middle = out.inverse_mass * out.middle;
  Vec3 x{}, y{}, z{};  // columns of the inertia
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3 r = out.offsets[i] -= out.middle;
    x += out.mass[i] * (dot(r, r) * Vec3{1, 0, 0} - r.x * r);
    y += out.mass[i] * (dot(r, r) * Vec3{0, 1, 0} - r.y * r);
    z += out.mass[i] * (dot(r, r) * Vec3{0, 0, 1} - r.z * r);
  }
  out.adjugate = {cross(y, z), cross(z, x), cross(x, y)};
  out.determinant = dot(x, out.adjugate[0]);
  if (!(out.determinant > 0)) return std::nullopt;
  return out;
}

}  // namespace plumb::detail
