// This file reads where bodies of a world are, and how they move.

#include "step/world_impl.hpp"

namespace plumb {

using detail::BodyPoses;
using detail::refuse;

namespace {

template <class Read>
std::array<Vec3, 4> read_four(const BodyPoses& bodies, std::uint32_t body, Read&& read) {
  const auto& [a, b, c, d] = bodies.particles(body);
  return {read(a), read(b), read(c), read(d)};
}

void require_bodies(std::size_t size, std::uint32_t bodies, const char* what) {
  if (size != bodies) refuse(what, " of ", bodies, " bodies cannot be copied into ", size, " elements");
}

}  // namespace

std::uint32_t World::body_count() const {
  return impl_->step->population().bodies.count();
}

Pose World::pose(std::uint32_t body) const {
  impl_->require_body(body);
  const auto position = [&](std::uint32_t particle) { return (*impl_->step).position(particle); };
  return impl_->bodies.pose(body, read_four(impl_->bodies, body, position));
}

BodyMotion World::motion(std::uint32_t body) const {
  impl_->require_body(body);
  const auto position = [&](std::uint32_t particle) { return (*impl_->step).position(particle); };
  const auto velocity = [&](std::uint32_t particle) { return (*impl_->step).velocity(particle); };
  return impl_->bodies.motion(body, read_four(impl_->bodies, body, position),
                              read_four(impl_->bodies, body, velocity));
}

void World::copy_poses(std::span<Pose> out) const {
  require_bodies(out.size(), body_count(), "poses");
  if (out.empty()) return;
  impl_->step->copy_positions(impl_->positions);
  impl_->bodies.copy_poses(impl_->positions, out);
  impl_->step->population().bodies.for_free([&](std::uint32_t body) { out[body] = {}; });
}

void World::copy_motions(std::span<BodyMotion> out) const {
  require_bodies(out.size(), body_count(), "motions");
  if (out.empty()) return;
  impl_->step->copy_positions(impl_->positions);
  impl_->step->copy_velocities(impl_->velocities);
  impl_->bodies.copy_motions(impl_->positions, impl_->velocities, out);
  impl_->step->population().bodies.for_free([&](std::uint32_t body) { out[body] = {}; });
}

}  // namespace plumb
