// This file lets programs edit a world while it runs.

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <type_traits>

#include "contact/platforms/anchored.hpp"
#include "relax/plan.hpp"
#include "step/world_impl.hpp"

namespace plumb {

using detail::refuse;

namespace {

/// Refuses what cannot be added to a world that runs.
void require_addable(const Scene& scene) {
  const auto require_none = [](const char* what, const auto& list) {
    if (!list.empty()) refuse(what, " 0: cannot be added to a world that runs");
  };
  require_none("twist", scene.twists);
  require_none("reel", scene.reels);
  require_none("plane", scene.planes);
  require_none("box", scene.boxes);
  require_none("platform", scene.platforms);
  require_none("ground capsule", scene.ground_capsules);
  require_none("ground hull", scene.ground_hulls);
  require_none("mesh", scene.meshes);
  require_none("height field", scene.height_fields);
  for (std::size_t i = 0; i < scene.capsules.size(); ++i)
    if (detail::is_anchored(scene, scene.capsules[i]))
      refuse("capsule ", i, ": nothing movable has it, and ground cannot be added to a world");
  if (scene.particles.empty()) refuse("the scene has no particles to be added");
}

}  // namespace

void World::cut(std::uint32_t rod) {
  impl_->require_rod(rod);
  impl_->step->cut(rod);
}

void World::fix(std::uint32_t particle) {
  impl_->require_known(particle);
  impl_->step->fix(particle, true);
  impl_->fixed[particle] = 1;
}
void World::free(std::uint32_t particle) {
  impl_->require_known(particle);
  impl_->step->fix(particle, false);
  impl_->fixed[particle] = 0;
}
void World::set_mass(std::uint32_t particle, double mass) {
  impl_->require_known(particle);
  if (!(mass > 0 && std::isfinite(mass)))
    refuse("particle ", particle, ": a mass must be positive and finite, got ", mass, " kg");
  impl_->step->set_mass(particle, mass);
}
void World::set_gravity(Vec3 gravity) {
  if (!is_finite(gravity)) refuse("gravity is not finite: ", gravity);
  if (!impl_->step->has_archive())
    refuse("gravity stays under springs, multipliers and featherstone; relax, direct and auto change it");
  impl_->step->set_gravity(gravity);
}
void World::teleport(std::span<const std::uint32_t> particles, std::span<const Vec3> positions,
                     std::span<const Vec3> velocities) {
  if (positions.size() != particles.size() || velocities.size() != particles.size())
    refuse("teleport: ", particles.size(), " particles cannot have ", positions.size(), " positions and ",
           velocities.size(), " velocities");
  const double most = farthest_coordinate(impl_->precision);
  for (std::size_t i = 0; i < particles.size(); ++i) {
    impl_->require_known(particles[i]);
    const Vec3 to = positions[i];
    if (!(std::max({std::abs(to.x), std::abs(to.y), std::abs(to.z)}) <= most) || !is_finite(velocities[i]))
      refuse("particle ", particles[i], ": cannot be at ", to, " m with ", velocities[i], " m/s");
  }
  if (!impl_->step->has_archive())
    refuse("teleport: springs, multipliers and featherstone keep their place; relax, direct and auto do not");
  impl_->step->teleport(particles, positions, velocities);
  impl_->teleports.resize(impl_->fixed.size(), 0);
  for (const std::uint32_t particle : particles) ++impl_->teleports[particle];
}

// --- What is added and removed

void World::Impl::fit_numbers() {
  fixed.resize(step->population().particles.count(), 0);
  if (step->population().bodies.count() == 0) return;
  positions.resize(fixed.size());
  velocities.resize(fixed.size());
}

void World::reserve(const Scene& like, std::uint32_t times) {
  if (!impl_->step->has_archive())
    refuse("springs, multipliers and featherstone edit nothing; relax, direct and auto do");
  detail::ByKind<std::uint32_t> more = detail::sizes_of(like);
  for (std::uint32_t* const size : more.all()) {
    if (std::uint64_t{*size} * times > std::numeric_limits<std::uint32_t>::max())
      refuse("reserve: ", *size, " of a kind cannot be there ", times, " times more");
    *size *= times;
  }
  detail::require_addressable(std::uint64_t{particle_count()} + more.particles,
                              std::uint64_t{rod_count()} + more.rods);
  impl_->step->make_room(more);
  impl_->fit_numbers();
}

Added World::add(const Scene& scene) {
  validate(scene);
  require_addable(scene);
  if (const Vec3 pull = impl_->step->next_gravity();
      !(scene.gravity == pull) && !(scene.gravity == Scene{}.gravity))
    refuse("gravity: what is added has ", scene.gravity, " m/s^2, and the world has ", pull,
           "; the default of Scene says none");
  if (scene.drag != impl_->step->drag())
    refuse("drag: what is added has ", scene.drag, " 1/s, and the world has ", impl_->step->drag());
  if (scene.joint_drag != impl_->step->joint_drag())
    refuse("joint drag: what is added has ", scene.joint_drag, " 1/s, and the world has ",
           impl_->step->joint_drag());
  if (!impl_->step->has_archive())
    refuse("springs, multipliers and featherstone add nothing to a world; relax, direct and auto do");
  detail::require_addressable(std::uint64_t{particle_count()} + scene.particles.size(),
                              std::uint64_t{rod_count()} + scene.rods.size());
  const detail::ByKind<std::uint32_t> first = impl_->step->add(scene);
  for (std::uint32_t i = 0; i < scene.bodies.size(); ++i)
    impl_->bodies.take(impl_->step->scene(), first.bodies + i);
  impl_->fit_numbers();
  for (std::uint32_t i = 0; i < scene.particles.size(); ++i)
    impl_->fixed[first.particles + i] = scene.particles[i].fixed ? 1 : 0;
  return {.particle = first.particles,
          .rod = first.rods,
          .bend = first.bends,
          .tackle = first.tackles,
          .body = first.bodies,
          .pin = first.pins,
          .alignment = first.alignments,
          .angle = first.angles,
          .spring = first.springs,
          .torsion = first.torsions,
          .capsule = first.capsules,
          .hull = first.hulls};
}

void World::remove(std::uint32_t particle) {
  impl_->require_known(particle);
  for (const std::uint32_t gone : impl_->step->remove(particle)) impl_->fixed[gone] = 0;
}

void World::pack() {
  impl_->step->pack();
}

namespace {

template <class Item>
constexpr const char* name_of = detail::names_of_kinds[detail::kind_of<Item>()];

template <class Item>
const detail::Numbers& numbers_of(const detail::Population& population) {
  return *population.all()[detail::kind_of<Item>()];
}

}  // namespace

template <class Item>
Handle<Item> World::handle(std::uint32_t number) const {
  const detail::Numbers& numbers = numbers_of<Item>(impl_->step->population());
  Impl::require_one_of(numbers.count(), name_of<Item>, number);
  if (!numbers.has(number)) return {};
  return {number, numbers.generation(number)};
}

template <class Item>
std::uint32_t World::number(Handle<Item> handle) const {
  const detail::Numbers& numbers = numbers_of<Item>(impl_->step->population());
  const auto [number, generation] = handle;
  if (!handle) refuse(name_of<Item>, ": the handle names none");
  if (number >= numbers.count() || numbers.generation(number) < generation || generation % 2 == 0)
    refuse(name_of<Item>, ' ', number, ": the handle, of generation ", generation, ", is not of this world");
  if (numbers.generation(number) != generation)
    refuse(name_of<Item>, ' ', number, ": was removed; its handle is of generation ", generation, ", now ",
           numbers.generation(number));
  return number;
}

template <class Item>
bool World::has(Handle<Item> handle) const {
  const detail::Numbers& numbers = numbers_of<Item>(impl_->step->population());
  const auto [number, generation] = handle;
  return handle && number < numbers.count() && numbers.generation(number) == generation &&
         numbers.has(number);
}

#define PLUMB_NAMES(Item)                                             \
  template PLUMB_API Handle<Item> World::handle(std::uint32_t) const; \
  template PLUMB_API std::uint32_t World::number(Handle<Item>) const; \
  template PLUMB_API bool World::has(Handle<Item>) const;
PLUMB_NAMES(Particle)
PLUMB_NAMES(Rod)
PLUMB_NAMES(Bend)
PLUMB_NAMES(Tackle)
PLUMB_NAMES(Body)
PLUMB_NAMES(Pin)
PLUMB_NAMES(Alignment)
PLUMB_NAMES(AngleControl)
PLUMB_NAMES(Spring)
PLUMB_NAMES(Torsion)
PLUMB_NAMES(Capsule)
PLUMB_NAMES(Hull)
#undef PLUMB_NAMES

template <class Item>
void World::cut(Handle<Item> item) {
  if constexpr (std::is_same_v<Item, Rod>)
    cut(number(item));
  else
    impl_->step->cut(detail::kind_of<Item>(), name_of<Item>, number(item));
}

template PLUMB_API void World::cut(Handle<Rod>);
template PLUMB_API void World::cut(Handle<Pin>);
template PLUMB_API void World::cut(Handle<Alignment>);
template PLUMB_API void World::cut(Handle<AngleControl>);
template PLUMB_API void World::cut(Handle<Spring>);
template PLUMB_API void World::cut(Handle<Torsion>);

}  // namespace plumb
