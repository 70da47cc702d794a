#include "contact/levers/shape_maker.hpp"

#include <algorithm>
#include <cmath>

#include "plumb/layouts/memory.hpp"

namespace plumb::detail {
namespace {

/// Lists the particles of two sums, each once.
Array<std::uint32_t> particles_of(Terms a, Terms b) {
  Array<std::uint32_t> out;
  for (const Terms sum : {a, b})
    for (const auto& [particle, weight] : sum) out.push_back(particle);
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

}  // namespace

ShapeMaker::ShapeMaker(const Scene& part) : part_(part) {
  for (std::uint32_t i = 0; i < part.bodies.size(); ++i)
    for (const std::uint32_t particle : part.bodies[i].particles) bodies_.emplace(particle, i);
  for (const Rod& rod : part.rods)
    rods_[std::minmax(rod.a, rod.b)] = !rod.law.one_sided && std::isinf(rod.law.strength);
}

bool ShapeMaker::keeps_apart(std::uint32_t a, std::uint32_t b) const {
  if (part_.particles[a].fixed && part_.particles[b].fixed) return true;
  const auto rod = rods_.find({a, b});
  return rod != rods_.end() && rod->second;
}

Linkage::Shape ShapeMaker::make(const Capsule& capsule, TermPool& places) const {
  Linkage::Shape shape{places.keep(combination(capsule.a)), places.keep(combination(capsule.b)),
                       capsule.radius, capsule.surface, capsule.filter};
  const Array<std::uint32_t> particles = particles_of(shape.a, shape.b);
  if (particles.size() == 1) return shape;
  const auto [first, end] = bodies_.equal_range(particles.front());
  for (auto at = first; at != end; ++at) {
    const auto& body = part_.bodies[at->second].particles;
    const bool holds = std::all_of(particles.begin(), particles.end(), [&](std::uint32_t particle) {
      return std::find(body.begin(), body.end(), particle) != body.end();
    });
    if (!holds) continue;
    shape.turning = Linkage::Shape::Turning::body;
    shape.turners = body;
    return shape;
  }
  if (particles.size() != 2 || !keeps_apart(particles[0], particles[1])) return shape;
  shape.turners = {particles[0], particles[1]};
  shape.turning = Linkage::Shape::Turning::line;
  return shape;
}

}  // namespace plumb::detail
