// This file lets programs change settings of a world.

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "step/world_impl.hpp"

namespace plumb {

using detail::refuse;

const Settings& World::settings() const {
  return impl_->step->settings();
}

void World::set_settings(const Settings& settings) {
  const Settings to = settings;  // which may be those that the world shows
  Impl::require_sound(to);
  if (to.memory != this->settings().memory) refuse("settings: memory is that with which a world began");
  const double most = farthest_coordinate(to.precision);
  for (std::uint32_t i = 0; i < particle_count(); ++i) {
    const Vec3 at = impl_->step->position(i);
    if (impl_->step->population().particles.has(i) &&
        std::max({std::abs(at.x), std::abs(at.y), std::abs(at.z)}) > most)
      refuse("settings: particle ", i, ": is too far for ", to_string(to.precision), ", at most ", most,
             " m from the origin");
  }
  impl_->step = impl_->step->changed(to, [this, &to](std::shared_ptr<const Scene> scene) {
    return detail::make_step(impl_->memory, std::move(scene), to);
  });
  impl_->take(to);
}

}  // namespace plumb
