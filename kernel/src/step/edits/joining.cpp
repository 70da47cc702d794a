// This file joins what a world has by rods, joints and springs.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <type_traits>
#include <utility>

#include "plumb/joints.hpp"
#include "relax/plan.hpp"
#include "scene/validate_bodies.hpp"
#include "step/breaks/ids.hpp"
#include "step/world_impl.hpp"

namespace plumb {
namespace detail {

bool Step::waits(std::size_t kind, std::uint32_t number) const {
  const Ids& waiting = *edits_.joined.names.all()[kind];
  return std::find(waiting.begin(), waiting.end(), number) != waiting.end();
}

/// Lets what waits never be joined, and nothing have its numbers.
void Step::take_back(Names numbers) {
  for (Ids* const of_kind : numbers.all()) sort_once(*of_kind);
  edits_.joined.sever(numbers);
  for (std::size_t kind = 0; kind < population_.kinds; ++kind)
    population_.all()[kind]->give_back(*numbers.all()[kind]);
}

/// Refuses a rod between ends that have one.
void Step::require_place_for(const Rod& rod, const Scene&) const {
  const auto require_other = [&](std::uint32_t number, const Rod& other) {
    if (std::minmax(other.a, other.b) == std::minmax(rod.a, rod.b))
      refuse("rod ", number, ": joins particles ", rod.a, " and ", rod.b, " already");
  };
  for (const std::uint32_t number : breaks_.rods_at(rod.a))
    if (breaks_.joins_ends(number)) require_other(number, breaks_.scene_now().rods[number]);
  const NamedPart& waiting = edits_.joined;
  for (std::size_t k = 0; k < waiting.names.rods.size(); ++k)
    require_other(waiting.names.rods[k], waiting.scene.rods[k]);
}

/// Refuses a pin of places that are apart. What would bring them together is a jump.
void Step::require_place_for(const Pin& pin, const Scene& alone) const {
  double longest = 0;
  Pin own = pin;
  for_particles(own, [&](std::uint32_t particle) {
    for (const std::uint32_t rod : breaks_.rods_at(particle))
      longest = std::max(longest, lengths_.length(rod));
  });
  const double apart = norm(position_of(alone, alone.pins[0].b) - position_of(alone, alone.pins[0].a));
  if (!(apart <= fits * longest)) refuse("pin 0: its places are ", apart, " m apart");
}

/// Refuses an alignment of directions that are off it, by a share of the longer one squared.
void Step::require_place_for(const Alignment& alignment, const Scene& alone) const {
  const Vec3 u = along(alone, alone.alignments[0].u), v = along(alone, alone.alignments[0].v);
  const double product = dot(u, v);
  if (!(std::abs(product - *alignment.value) <= fits * std::max(dot(u, u), dot(v, v))))
    refuse("alignment 0: its product is ", product, " m^2, and is to be ", *alignment.value, " m^2");
}

/// Refuses what cannot be joined as things are, or with an island that cannot be made anew.
template <class Item>
void Step::require_joinable(const Item& item, const Scene& alone) const {
  Edits then = edits_;
  then.joined.add(0, item);
  Item own = item;
  for_particles(own, [&](std::uint32_t each) {
    if (anchors_.is_fixed(each)) return;  // if it is to be freed, fix() has looked at what hangs from it
    require_editable("particle", each, each);
    if (const auto twist = breaks_.twist_at(each))
      refuse("particle ", each, ": twist ", *twist, " is of its island, which stays one");
  });
  for_particles(
      own, [&](std::uint32_t each) { require_simple_meeting("particle " + std::to_string(each), then); });
  if constexpr (requires { require_place_for(item, alone); }) require_place_for(item, alone);
}

template <class Item>
std::uint32_t Step::join(const Item& item, const Scene& alone) {
  breaks_.begin();
  require_joinable(item, alone);
  compile_addition(alone);  // which refuses what the settings cannot move
  Numbers& numbers = *population_.all()[kind_of<Item>()];
  const std::uint32_t number = numbers.find(1);
  numbers.take(number, 1);
  grow_tables();
  edits_.joined.add(number, item);
  return number;
}

/// Tells all that know rods of those that are joined. Who is fixed anew is looked at later.
void Step::put_joined(const Edits& edits) {
  for (std::size_t k = 0; k < edits.joined.names.rods.size(); ++k) {
    const std::uint32_t number = edits.joined.names.rods[k];
    const Rod& rod = edits.joined.scene.rods[k];
    lengths_.add(number, rod.length);
    rods_.add(number, rod, anchors_.is_fixed(rod.a) ? rod.b : rod.a);
    if (settings_.tensions)
      reactions_.insert_rod(breaks_.scene_now(), mass_model_of(settings_), number, anchors_);
  }
}

}  // namespace detail

using detail::refuse;

namespace {

/// Returns an item by itself, between its particles where they are now. Their masses do not matter to it.
template <class Item>
Scene scene_alone(const Item& item, const World& world, std::span<const std::uint8_t> fixed) {
  Scene out;
  std::map<std::uint32_t, std::uint32_t> numbers;
  Item& own = detail::list_of<Item>(out).emplace_back(item);
  detail::for_particles(own, [&](std::uint32_t& particle) {
    const auto [at, is_new] = numbers.try_emplace(particle, static_cast<std::uint32_t>(numbers.size()));
    if (is_new)
      out.particles.push_back(
          {.position = world.position(particle), .mass = 1, .fixed = fixed[particle] != 0});
    particle = at->second;
  });
  return out;
}

/// Refuses a rod whose ends no rod can join, before validate() names them by other numbers.
void require_ends(const Rod& rod, std::span<const std::uint8_t> fixed) {
  if (rod.a == rod.b) refuse("a rod to be joined: both ends are particle ", rod.a);
  if (fixed[rod.a] != 0 && fixed[rod.b] != 0)
    refuse("a rod to be joined: both ends (particles ", rod.a, " and ", rod.b, ") are fixed");
  if (rod.linear_drag != 0 || rod.orthogonal_drag != 0)
    refuse("a rod to be joined to particles ", rod.a, " and ", rod.b, ": is slowed by air, which stays out");
}

/// Lets a rod be as long as the one that is alone, which must fit between its ends.
void fit_length(Rod& rod, Scene& alone) {
  rod.length = alone.rods[0].length = rod_length(alone, 0);
  const double distance = norm(alone.particles[1].position - alone.particles[0].position);
  if (detail::misfit(distance, rod.length, rod.law) > detail::fits * rod.length)
    refuse("a rod to be joined to particles ", rod.a, " and ", rod.b, ": is ", rod.length,
           " m long, and its ends are ", distance, " m apart");
}

/// Lets an alignment keep the product that it has now, unless it names one.
void fit_value(Alignment& alignment, Scene& alone) {
  Alignment& now = alone.alignments[0];
  if (!now.value) now.value = dot(detail::along(alone, now.u), detail::along(alone, now.v));
  alignment.value = now.value;
}

/// Lets slots that nobody reads of a place name a particle that it has.
void fill_slots(Point& of) {
  std::uint32_t some = 0;
  for (std::size_t k = 0; k < 4; ++k)
    if (of.weights[k] != 0) some = of.particles[k];
  for (std::size_t k = 0; k < 4; ++k)
    if (of.weights[k] == 0) of.particles[k] = some;
}

}  // namespace

template <class Item>
Handle<Item> World::join(const Item& item) {
  constexpr bool is_rod = std::is_same_v<Item, Rod>;
  Item own = item;
  if constexpr (!is_rod) detail::for_points(own, fill_slots);
  detail::for_particles(own, [&](std::uint32_t particle) { impl_->require_known(particle); });
  if (!impl_->step->has_archive())
    refuse("springs, multipliers and featherstone join nothing; relax, direct and auto do");
  if constexpr (is_rod) require_ends(own, impl_->fixed);
  Scene alone = scene_alone(own, *this, impl_->fixed);
  validate(alone);
  detail::require_addressable(particle_count(), std::uint64_t{rod_count()} + 1);
  if constexpr (is_rod) fit_length(own, alone);
  if constexpr (std::is_same_v<Item, Alignment>) fit_value(own, alone);
  alone.drag = impl_->step->drag();
  const std::uint32_t number = impl_->step->join(own, alone);
  impl_->fit_numbers();
  return handle<Item>(number);
}

template PLUMB_API Handle<Rod> World::join(const Rod&);
template PLUMB_API Handle<Pin> World::join(const Pin&);
template PLUMB_API Handle<Alignment> World::join(const Alignment&);
template PLUMB_API Handle<AngleControl> World::join(const AngleControl&);
template PLUMB_API Handle<Spring> World::join(const Spring&);
template PLUMB_API Handle<Torsion> World::join(const Torsion&);

Handle<Rod> World::join(Handle<Particle> a, Handle<Particle> b, Rod rod) {
  rod.a = number(a);
  rod.b = number(b);
  return join(rod);
}

}  // namespace plumb
