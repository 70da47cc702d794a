// This file lets programs grab places of a world.

#include <algorithm>
#include <cmath>

#include "step/world_impl.hpp"

namespace plumb {

using detail::refuse;

namespace {

/// Two sums of weights that differ by this are the same.
constexpr double weight_tolerance = 1e-9;

void require_target(Vec3 target, Precision precision) {
  if (!is_finite(target)) refuse("grab: target is not finite");
  const double most = farthest_coordinate(precision);
  if (std::max({std::abs(target.x), std::abs(target.y), std::abs(target.z)}) > most)
    refuse("grab: target is too far for ", to_string(precision), ", at most ", most, " m from the origin");
}

std::uint32_t number_of(const detail::Grabs& grabs, Handle<Grab> handle) {
  const detail::Numbers& numbers = grabs.numbers();
  const auto [number, generation] = handle;
  if (!handle) refuse("grab: the handle names none");
  if (number >= numbers.count() || numbers.generation(number) < generation || generation % 2 == 0)
    refuse("grab ", number, ": the handle, of generation ", generation, ", is not of this world");
  if (numbers.generation(number) != generation)
    refuse("grab ", number, ": was released; its handle is of generation ", generation, ", now ",
           numbers.generation(number));
  return number;
}

}  // namespace

Handle<Grab> World::grab(const Grab& grab) {
  double sum = 0;
  bool moves = false;
  for (std::size_t k = 0; k < grab.at.particles.size(); ++k) {
    const double weight = grab.at.weights[k];
    if (weight == 0) continue;
    if (!std::isfinite(weight)) refuse("grab: weight ", k, " of its place is not finite");
    impl_->require_known(grab.at.particles[k]);
    for (std::size_t other = 0; other < k; ++other)
      if (grab.at.weights[other] != 0 && grab.at.particles[other] == grab.at.particles[k])
        refuse("grab: its place lists particle ", grab.at.particles[k], " twice");
    moves = moves || impl_->fixed[grab.at.particles[k]] == 0;
    sum += weight;
  }
  if (!(std::abs(sum - 1) <= weight_tolerance))
    refuse("grab: weights of its place must add up to 1, and make ", sum);
  if (!moves) refuse("grab: its place is fixed, and a grab cannot move it; move_anchor() does");
  if (!(grab.stiffness >= 0 && std::isfinite(grab.stiffness)))
    refuse("grab: stiffness must be finite and not negative, got ", grab.stiffness, " N/m");
  if (!(grab.damping >= 0 && std::isfinite(grab.damping)))
    refuse("grab: damping must be finite and not negative, got ", grab.damping, " N s/m");
  require_target(grab.target, impl_->precision);
  const std::uint32_t number = impl_->step->grab(grab);
  return {number, impl_->step->grabs().numbers().generation(number)};
}

void World::move_grab(Handle<Grab> grab, Vec3 target) {
  const std::uint32_t number = number_of(impl_->step->grabs(), grab);
  require_target(target, impl_->precision);
  impl_->step->move_grab(number, target);
}

void World::release(Handle<Grab> grab) {
  impl_->step->release(number_of(impl_->step->grabs(), grab));
}

bool World::has(Handle<Grab> grab) const {
  const detail::Numbers& numbers = impl_->step->grabs().numbers();
  return grab && grab.number < numbers.count() && numbers.has(grab.number) &&
         numbers.generation(grab.number) == grab.generation;
}

Vec3 World::grab_force(Handle<Grab> grab) const {
  impl_->require_tensions();
  return impl_->step->grabs().force(number_of(impl_->step->grabs(), grab));
}

double World::power(Handle<Grab> grab) const {
  impl_->require_tensions();
  return impl_->step->grabs().power(number_of(impl_->step->grabs(), grab));
}

}  // namespace plumb
