// This file lets programs change settings of a world.

#include <algorithm>
#include <cmath>

#include "step/world_impl.hpp"

namespace plumb {

using detail::refuse;

const Settings& World::settings() const {
  return impl_->step->settings();
}

void World::set_settings(const Settings& settings) {
  Impl::require_sound(settings);
  const double most = farthest_coordinate(settings.precision);
  for (std::uint32_t i = 0; i < particle_count(); ++i) {
    const Vec3 at = impl_->step->position(i);
    if (impl_->step->population().particles.has(i) &&
        std::max({std::abs(at.x), std::abs(at.y), std::abs(at.z)}) > most)
      refuse("settings: particle ", i, ": is too far for ", to_string(settings.precision), ", at most ", most,
             " m from the origin");
  }
  impl_->step = impl_->step->changed(settings);
  impl_->take(settings);
}

}  // namespace plumb
