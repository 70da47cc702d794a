#include "scene/bends/bends.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

#include "scene/bends/curvature.hpp"
#include "scene/bends/rod_table.hpp"
#include "scene/refuse.hpp"

namespace plumb::detail {
namespace {

void validate_numbers(const Bend& bend, std::size_t i) {
  if (!(bend.stiffness >= 0 && std::isfinite(bend.stiffness)))
    refuse("bend ", i, ": stiffness must be finite and not negative, got ", bend.stiffness, " N m");
  if (!(bend.damping >= 0 && std::isfinite(bend.damping)))
    refuse("bend ", i, ": damping must be finite and not negative, got ", bend.damping, " N m s");
  if (bend.stiffness == 0 && bend.damping == 0)
    refuse("bend ", i, ": has neither stiffness nor damping, so that it holds nothing");
  if (!(bend.angle >= 0 && bend.angle <= largest_rest_angle))
    refuse("bend ", i, ": angle must be from 0 to ", largest_rest_angle, " rad, got ", bend.angle, " rad");
}

void validate_particles(const Scene& scene, std::size_t i) {
  const Bend& bend = scene.bends[i];
  for (const std::uint32_t particle : particles_of(bend)) {
    if (particle < scene.particles.size()) continue;
    refuse("bend ", i, ": particle ", particle, " does not exist (the scene has ", scene.particles.size(),
           " particles)");
  }
  if (bend.a == bend.b || bend.b == bend.c || bend.a == bend.c)
    refuse("bend ", i, ": needs three different particles, got ", bend.a, ", ", bend.b, " and ", bend.c);
  const auto is_fixed = [&](std::uint32_t particle) { return scene.particles[particle].fixed; };
  if (is_fixed(bend.a) && is_fixed(bend.b) && is_fixed(bend.c))
    refuse("bend ", i, ": all of its particles (", bend.a, ", ", bend.b, " and ", bend.c, ") are fixed");
}

void validate_rods(const Scene& scene, const RodTable& rods, std::size_t i) {
  const Bend& bend = scene.bends[i];
  require_rod(scene, rods, {"bend ", i}, bend.a, bend.b);
  require_rod(scene, rods, {"bend ", i}, bend.b, bend.c);
}

void refuse_duplicate_bends(const std::vector<Bend>& bends) {
  using Entry = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, std::size_t>;
  Array<Entry> sorted;
  for (std::size_t i = 0; i < bends.size(); ++i) {
    const auto [low, high] = std::minmax(bends[i].a, bends[i].c);
    sorted.emplace_back(bends[i].b, low, high, i);
  }
  std::sort(sorted.begin(), sorted.end());
  const auto particles = [](const Entry& e) {
    return std::tuple(std::get<0>(e), std::get<1>(e), std::get<2>(e));
  };
  const auto twice = std::adjacent_find(
      sorted.begin(), sorted.end(),
      [&](const Entry& first, const Entry& second) { return particles(first) == particles(second); });
  if (twice != sorted.end())
    refuse("bend ", std::get<3>(twice[1]), ": bends the same particles as bend ", std::get<3>(*twice));
}

}  // namespace

void validate_bends(const Scene& scene) {
  if (scene.bends.empty()) return;
  const RodTable rods(scene);
  for (std::size_t i = 0; i < scene.bends.size(); ++i) {
    validate_particles(scene, i);
    validate_numbers(scene.bends[i], i);
    validate_rods(scene, rods, i);
  }
  refuse_duplicate_bends(scene.bends);
}

Array<std::array<double, 2>> bend_lengths(const Scene& scene) {
  Array<std::array<double, 2>> out;
  if (scene.bends.empty()) return out;
  const RodTable rods(scene);
  const auto length = [&](std::uint32_t a, std::uint32_t b) {
    const auto rod = rods.find(a, b);
    return rod ? rod_length(scene, *rod) : norm(scene.particles[b].position - scene.particles[a].position);
  };
  out.reserve(scene.bends.size());
  for (const Bend& bend : scene.bends) out.push_back({length(bend.a, bend.b), length(bend.b, bend.c)});
  return out;
}

double bending_energy(const Scene& scene, std::span<const Vec3> positions) {
  const Array<std::array<double, 2>> lengths = bend_lengths(scene);
  double sum = 0;
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    const Bend& bend = scene.bends[i];
    const Vec3 w = 1 / lengths[i][0] * (positions[bend.b] - positions[bend.a]) -
                   1 / lengths[i][1] * (positions[bend.c] - positions[bend.b]);
    sum += bending_energy(bend.stiffness, curvature_of_angle(bend.angle), dot(w, w));
  }
  return sum;
}

}  // namespace plumb::detail
