#include "plumb/shapes/queries.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "queries/bare.hpp"
#include "queries/casts.hpp"
#include "queries/near_things.hpp"
#include "queries/query_tree.hpp"
#include "queries/things.hpp"
#include "scene/refuse.hpp"
#include "step/world_impl.hpp"

namespace plumb {

using detail::Probe;
using detail::refuse;
using detail::Strike;
using detail::Thing;

/// Holds what can be found, where it is, and how it is searched.
struct PLUMB_HIDDEN Queries::Impl {
  Impl(const Scene& scene, const QuerySettings& settings);

  /// Lists bare rods and particles, and shapes of the scene `now` that were added, and takes everything where
  /// it is.
  void follow(const Scene& now);
  Hit cast(const Probe& probe, const QueryFilter& filter) const;
  Hit hit(const Probe& probe, const detail::Nearest& nearest) const;
  Hit closest(Vec3 from, double within, const QueryFilter& filter) const;
  void overlap(const Probe& probe, std::vector<QueryTarget>& out, const QueryFilter& filter) const;
  /// Calls visit(thing) for what the hierarchy leaves out, but for planes.
  template <class Visit>
  void for_wide(Visit&& visit) const {
    for (const std::uint32_t i : things.wide()) visit(things.list()[i]);
  }

  detail::Things things;
  detail::Bare bare;
  detail::QueryTree tree;
  Array<Thing> ordered;                 ///< as the hierarchy has them, so that neighbours lie side by side
  detail::ByKind<std::uint32_t> sizes;  ///< of the scene; a world may have more
  Array<Vec3> positions;
  Array<std::uint8_t> gone, ended_capsules, ended_hulls;  ///< by rod, and by shape of the scene
  Array<detail::Whereabouts::Sphere> spheres;
  Array<Pose> platforms;
};

namespace {

void require_amount(double amount, const char* what) {
  if (!(amount >= 0 && std::isfinite(amount)))
    refuse(what, " must be finite and not negative, got ", amount, " m");
}

void require_place(Vec3 place, const char* what) {
  if (!is_finite(place)) refuse(what, " is not finite");
}

void require_ray(const Ray& ray, const std::string& name) {
  if (!is_finite(ray.origin)) refuse(name, ": origin is not finite");
  if (!is_finite(ray.direction)) refuse(name, ": direction is not finite");
  if (ray.direction == Vec3{}) refuse(name, ": direction must not be zero");
  if (!(ray.length >= 0)) refuse(name, ": length must not be negative, got ", ray.length, " m");
}

/// Returns a vector of length one; squares of large and of small ones would not fit.
Vec3 unit(Vec3 v) {
  const double most = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  const Vec3 scaled{v.x / most, v.y / most, v.z / most};
  return (1 / norm(scaled)) * scaled;
}

Probe probe_of(const Ray& ray) {
  return {.origin = ray.origin, .direction = unit(ray.direction), .length = ray.length};
}

/// Returns whether both places of a capsule are one.
bool has_middle(const Capsule& capsule) {
  return capsule.a.particles == capsule.b.particles && capsule.a.weights == capsule.b.weights;
}

detail::SolidBox solid_box(Vec3 center, const QueryBox& box) {
  require_amount(std::min({box.half_size.x, box.half_size.y, box.half_size.z}), "box: half size");
  require_amount(std::max({box.half_size.x, box.half_size.y, box.half_size.z}), "box: half size");
  if (!is_finite(box.half_size)) refuse("box: half size is not finite");
  const auto [w, x, y, z] = box.orientation;
  const double length = std::sqrt(w * w + x * x + y * y + z * z);
  if (!(std::abs(length - 1) <= 1e-9))
    refuse("box: orientation must be a quaternion of length 1, not ", length);
  return {center, box.half_size, detail::frame_of(box.orientation)};
}

}  // namespace

Queries::Impl::Impl(const Scene& scene, const QuerySettings& settings)
    : things(scene, settings),
      bare(scene, settings),
      sizes(detail::sizes_of(scene)),
      gone(scene.rods.size()),
      ended_capsules(scene.capsules.size()),
      ended_hulls(scene.hulls.size()),
      platforms(scene.platforms.begin(), scene.platforms.end()) {
  for (const Particle& particle : scene.particles) positions.push_back(particle.position);
  follow(scene);
}

void Queries::Impl::follow(const Scene& now) {
  const bool are_others =
      things.list_bare(now, bare.rods(), bare.particles(), bare.shapes()) || ordered.empty();
  things.update({positions, gone, ended_capsules, ended_hulls, spheres, platforms});
  if (!are_others) tree.fit(things.bounds());
  if (are_others || tree.is_worn()) tree.build(things.bounds());
  ordered.clear();
  for (const std::uint32_t i : tree.order()) ordered.push_back(things.list()[i]);
}

Hit Queries::Impl::hit(const Probe& probe, const detail::Nearest& nearest) const {
  if (!nearest.strike) return {};
  Strike strike = nearest.strike;
  if (nearest.thing < ordered.size())
    strike = detail::strike_on_capsule(probe, ordered[nearest.thing], strike.distance);
  return {things.target(nearest.number), strike.point, strike.normal, strike.distance};
}

Hit Queries::Impl::cast(const Probe& probe, const QueryFilter& filter) const {
  detail::Nearest nearest;
  const auto see = [&](const Strike& strike, std::uint32_t number, std::uint32_t thing) {
    if (!nearest.is_beaten_by(strike.distance, number) || !things.may_find(number, filter)) return;
    nearest = {strike, number, thing};
  };
  constexpr std::uint32_t none = 0xffffffff;
  for (const detail::PlaneNow& plane : things.planes()) see(detail::cast(probe, plane), plane.number, none);
  for_wide([&](const Thing& thing) { see(detail::cast(probe, things.mesh(thing)), thing.number, none); });
  double best = std::min(probe.length, nearest.strike.distance);
  tree.along(probe.way(), best, [&](std::uint32_t k) {
    const Thing& thing = ordered[k];
    if (thing.form == Thing::Form::capsule && !probe.box) {
      const double way = detail::way_to_capsule(probe.origin, probe.direction, thing.p, thing.q,
                                                thing.radius + probe.radius);
      if (way <= best) see({way, {}, {}}, thing.number, k);
    } else if (thing.form == Thing::Form::mesh) {
      see(detail::cast(probe, things.mesh(thing)), thing.number, none);
    } else if (thing.form != Thing::Form::gone) {
      std::array<Vec3, 2> ends;
      see(detail::cast(probe, things.convex(thing, ends)), thing.number, none);
    }
    best = std::min(best, nearest.strike.distance);
  });
  return hit(probe, nearest);
}

Hit Queries::Impl::closest(Vec3 from, double within, const QueryFilter& filter) const {
  detail::Nearest nearest;
  const auto see = [&](const Strike& strike, std::uint32_t number) {
    if (strike.distance > within || !nearest.is_beaten_by(strike.distance, number)) return;
    if (things.may_find(number, filter)) nearest = {strike, number};
  };
  double best = within;
  // Of equally near ones that with the lower number is to be seen, too.
  const auto reach = [&] { return std::max(best, 0.0) * (1 + 1e-9); };
  for (const detail::PlaneNow& plane : things.planes()) see(detail::near_plane(from, plane), plane.number);
  for_wide([&](const Thing& thing) {
    best = std::min(best, nearest.strike.distance);
    see(detail::near_mesh(from, things.mesh(thing), reach()), thing.number);
  });
  best = std::min(best, nearest.strike.distance);
  tree.near(from, best, [&](std::uint32_t k) {
    const Thing& thing = ordered[k];
    if (thing.form == Thing::Form::gone) return;
    see(detail::near_thing(from, things, thing, reach()), thing.number);
    best = std::min(best, nearest.strike.distance);
  });
  if (!nearest.strike) return {};
  return {things.target(nearest.number), nearest.strike.point, nearest.strike.normal,
          nearest.strike.distance};
}

void Queries::Impl::overlap(const Probe& probe, std::vector<QueryTarget>& out,
                            const QueryFilter& filter) const {
  out.clear();
  const auto see = [&](const Strike& strike, std::uint32_t number) {
    if (strike && things.may_find(number, filter)) out.push_back(things.target(number));
  };
  for (const detail::PlaneNow& plane : things.planes()) see(detail::overlap(probe, plane), plane.number);
  for_wide([&](const Thing& thing) { see(detail::overlap(probe, things.mesh(thing)), thing.number); });
  const Vec3 reach = probe.reach();
  tree.within({probe.origin - reach, probe.origin + reach}, [&](std::uint32_t k) {
    const Thing& thing = ordered[k];
    if (thing.form != Thing::Form::gone) see(detail::overlap(probe, things, thing), thing.number);
  });
  std::sort(out.begin(), out.end());
}

Queries::Queries(const Scene& scene, const QuerySettings& settings) {
  validate(scene);
  require_amount(settings.rod_radius, "rod_radius");
  require_amount(settings.particle_radius, "particle_radius");
  impl_ = std::make_unique<Impl>(scene, settings);
}
Queries::~Queries() = default;
Queries::Queries(Queries&&) noexcept = default;
Queries& Queries::operator=(Queries&&) noexcept = default;

void Queries::update(const World& world) {
  Impl& of = *impl_;
  const auto require = [](std::size_t has, std::size_t want, const char* what) {
    if (has < want) refuse("the world has ", has, " ", what, ", and the scene of these queries has ", want);
  };
  require(world.particle_count(), of.sizes.particles, "particles");
  require(world.rod_count(), of.sizes.rods, "rods");
  // A world refuses what it does not have. Nothing of this has changed by then.
  Array<Pose>& platforms = of.platforms;
  for (std::uint32_t i = 0; i < platforms.size(); ++i) static_cast<void>(world.platform(i));
  for (const auto& [kind, count] :
       {std::pair(ShapeKind::capsule, of.sizes.capsules), std::pair(ShapeKind::hull, of.sizes.hulls)})
    if (count > 0) static_cast<void>(world.has_shape({kind, count - 1}));
  for (std::uint32_t i = 0; i < platforms.size(); ++i) platforms[i] = world.platform(i);
  of.positions.resize(world.particle_count());
  world.copy_positions(of.positions);
  const detail::Step& step = *world.impl_->step;
  const detail::Population& population = step.population();
  of.gone.resize(world.rod_count());
  for (std::uint32_t i = 0; i < of.gone.size(); ++i)
    of.gone[i] = !population.rods.has(i) || step.waits<Rod>(i) || step.is_broken(i) ? 1 : 0;
  // Numbers of what was removed may be those of what was added since.
  const auto list_ended = [&](ShapeKind kind, const detail::Numbers& numbers, Array<std::uint8_t>& out) {
    for (std::uint32_t i = 0; i < out.size(); ++i)
      out[i] = !numbers.is_first(i) || !step.has_shape({kind, i}) ? 1 : 0;
  };
  list_ended(ShapeKind::capsule, population.capsules, of.ended_capsules);
  list_ended(ShapeKind::hull, population.hulls, of.ended_hulls);
  of.spheres.clear();
  for (std::uint32_t i = 0; i < population.capsules.count(); ++i)
    if (const auto middle = population.capsules.has(i) ? step.middle_of(i) : std::nullopt)
      if (!has_middle(step.scene().capsules[i])) of.spheres.push_back({i, *middle});
  of.bare.find(step.scene(), population, [&](ShapeId shape) { return step.has_shape(shape); });
  of.follow(step.scene());
}

Hit Queries::cast_ray(const Ray& ray, const QueryFilter& filter) const {
  require_ray(ray, "ray");
  return impl_->cast(probe_of(ray), filter);
}

void Queries::cast_rays(std::span<const Ray> rays, std::span<Hit> hits, const QueryFilter& filter) const {
  if (rays.size() != hits.size())
    refuse("hits of ", rays.size(), " rays cannot be written into ", hits.size(), " elements");
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Ray& ray = rays[i];
    // Names cost more than rays do.
    if (!is_finite(ray.origin) || !is_finite(ray.direction) || ray.direction == Vec3{} || !(ray.length >= 0))
      require_ray(ray, "ray " + std::to_string(i));
  }
  for (std::size_t i = 0; i < rays.size(); ++i) hits[i] = impl_->cast(probe_of(rays[i]), filter);
}

Hit Queries::cast_sphere(const Ray& ray, double radius, const QueryFilter& filter) const {
  require_ray(ray, "ray");
  require_amount(radius, "radius");
  Probe probe = probe_of(ray);
  probe.radius = radius;
  return impl_->cast(probe, filter);
}

Hit Queries::cast_box(const Ray& ray, const QueryBox& box, const QueryFilter& filter) const {
  require_ray(ray, "ray");
  const detail::SolidBox solid = solid_box(ray.origin, box);
  Probe probe = probe_of(ray);
  probe.box = &solid;
  return impl_->cast(probe, filter);
}

void Queries::overlap_sphere(Vec3 center, double radius, std::vector<QueryTarget>& out,
                             const QueryFilter& filter) const {
  require_place(center, "centre");
  require_amount(radius, "radius");
  impl_->overlap({.origin = center, .radius = radius}, out, filter);
}

void Queries::overlap_box(Vec3 center, const QueryBox& box, std::vector<QueryTarget>& out,
                          const QueryFilter& filter) const {
  require_place(center, "centre");
  const detail::SolidBox solid = solid_box(center, box);
  impl_->overlap({.origin = center, .box = &solid}, out, filter);
}

Hit Queries::closest_point(Vec3 from, double within, const QueryFilter& filter) const {
  require_place(from, "place");
  if (!(within >= 0)) refuse("within must not be negative, got ", within, " m");
  return impl_->closest(from, within, filter);
}

}  // namespace plumb
