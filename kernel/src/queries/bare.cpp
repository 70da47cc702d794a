#include "queries/bare.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "scene/lists/digest.hpp"

namespace plumb::detail {
namespace {

/// Lists the particles of a capsule, ascending and each once.
Array<std::uint32_t> particles_of(const Capsule& capsule) {
  std::set<std::uint32_t> out;
  for (const Point* const point : {&capsule.a, &capsule.b})
    for (std::size_t k = 0; k < 4; ++k)
      if (point->weights[k] != 0) out.insert(point->particles[k]);
  return {out.begin(), out.end()};
}

std::uint64_t digest_of(const Capsule& capsule) {
  Digest out;
  out(capsule);
  return out.value();
}

bool is_shown(std::span<const std::uint8_t> shown, const Numbers& numbers, std::uint32_t number) {
  return number < shown.size() && shown[number] != 0 && numbers.is_first(number);
}

}  // namespace

Bare::Bare(const Scene& scene, const QuerySettings& settings)
    : finds_rods_(settings.rod_radius > 0),
      finds_particles_(settings.particle_radius > 0),
      shown_rods_(scene.rods.size()),
      shown_particles_(scene.particles.size()),
      first_(sizes_of(scene)) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (const Capsule& capsule : scene.capsules) {
    const Array<std::uint32_t> particles = particles_of(capsule);
    for (const std::uint32_t particle : particles) shown_particles_[particle] = 1;
    if (particles.size() == 2) pairs.emplace(particles[0], particles[1]);
  }
  for (const Body& body : scene.bodies)
    for (const std::uint32_t a : body.particles) {
      shown_particles_[a] = 1;
      for (const std::uint32_t b : body.particles) pairs.insert(std::minmax(a, b));
    }
  for (std::size_t i = 0; i < scene.rods.size(); ++i)
    shown_rods_[i] = pairs.contains(std::minmax(scene.rods[i].a, scene.rods[i].b)) ? 1 : 0;
  find(scene, population_of(scene), [](ShapeId) { return true; });
}

void Bare::find(const Scene& now, const Population& population, const HasShape& has_shape) {
  rods_.clear();
  particles_.clear();
  find_added(now, population, has_shape);
  const auto has = [](const auto& list, const auto& each) {
    return std::binary_search(list.begin(), list.end(), each);
  };
  if (finds_rods_)
    for (std::uint32_t i = 0; i < now.rods.size(); ++i)
      if (population.rods.has(i) && !is_shown(shown_rods_, population.rods, i) &&
          !has(added_pairs_,
               std::pair<std::uint32_t, std::uint32_t>(std::minmax(now.rods[i].a, now.rods[i].b))))
        rods_.push_back({i, now.rods[i].a, now.rods[i].b});
  if (finds_particles_)
    for (std::uint32_t i = 0; i < now.particles.size(); ++i)
      if (population.particles.has(i) && !is_shown(shown_particles_, population.particles, i) &&
          !has(added_at_, i))
        particles_.push_back(i);
}

void Bare::find_added(const Scene& now, const Population& population, const HasShape& has_shape) {
  shapes_.clear();
  added_pairs_.clear();
  added_at_.clear();
  const auto for_added = [](std::size_t count, std::uint32_t first, const Numbers& numbers, auto&& f) {
    for (std::uint32_t i = 0; i < count; ++i)
      if (numbers.has(i) && (i >= first || !numbers.is_first(i))) f(i);
  };
  for_added(now.capsules.size(), first_.capsules, population.capsules, [&](std::uint32_t i) {
    if (!has_shape({ShapeKind::capsule, i})) return;
    shapes_.push_back({{ShapeKind::capsule, i}, digest_of(now.capsules[i])});
    const Array<std::uint32_t> particles = particles_of(now.capsules[i]);
    added_at_.insert(added_at_.end(), particles.begin(), particles.end());
    if (particles.size() == 2) added_pairs_.emplace_back(particles[0], particles[1]);
  });
  for_added(now.hulls.size(), first_.hulls, population.hulls, [&](std::uint32_t i) {
    if (!has_shape({ShapeKind::hull, i})) return;
    Digest digest;
    digest(now.hulls[i]);
    for (const std::uint32_t particle : now.bodies[now.hulls[i].body].particles)
      digest(particle, now.particles[particle].position);
    shapes_.push_back({{ShapeKind::hull, i}, digest.value()});
  });
  for_added(now.bodies.size(), first_.bodies, population.bodies, [&](std::uint32_t i) {
    for (const std::uint32_t a : now.bodies[i].particles) {
      added_at_.push_back(a);
      for (const std::uint32_t b : now.bodies[i].particles) added_pairs_.push_back(std::minmax(a, b));
    }
  });
  std::sort(added_pairs_.begin(), added_pairs_.end());
  std::sort(added_at_.begin(), added_at_.end());
}

}  // namespace plumb::detail
