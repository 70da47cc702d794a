#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "plumb/export.hpp"
#include "plumb/scene.hpp"
#include "plumb/shapes/contact.hpp"
#include "plumb/vec3.hpp"
#include "plumb/world.hpp"

/// @file
/// This file finds what a line, a ball or a box meets in a world: to pick with a mouse, to see and to aim. It
/// also finds what is near, and whether there is room.
namespace plumb {

/// Names what a query found. Targets are ordered by kind, then by list, then by number.
struct QueryTarget {
  /// Says what it is: nothing, a shape or a piece of ground, or a rod or a particle that no shape shows.
  enum class Kind : std::uint8_t { none, shape, rod, particle };
  Kind kind = Kind::none;               ///< What it is.
  ShapeKind list = ShapeKind::capsule;  ///< Of a shape or a piece of ground, its list.
  std::uint32_t number = 0;             ///< Index into that list, Scene::rods or Scene::particles.

  /// Returns the name of a shape or a piece of ground.
  constexpr ShapeId shape() const { return {list, number}; }
  /// Compares by kind, then by list, then by number.
  friend constexpr auto operator<=>(const QueryTarget&, const QueryTarget&) = default;
};

/// Says what a query may find.
struct QueryFilter {
  /// What may touch a shape with this filter is found. Bare rods and particles have the default one.
  Filter filter{};
  bool shapes = true;  ///< Whether capsules and hulls are found; one on anchors is a shape, too.
  bool ground = true;  ///< Whether ground is found.
  bool bare = true;    ///< Whether bare rods and particles are found.
};

/// Leads from a place along a direction, as far as a length.
struct Ray {
  Vec3 origin{};                                            ///< Where it starts, in m.
  Vec3 direction{};                                         ///< Where it goes, of any length but 0.
  double length = std::numeric_limits<double>::infinity();  ///< How far it goes, in m; it may be infinite.
};

/// This is a box that is cast or asked about.
struct QueryBox {
  Vec3 half_size{};                               ///< Half of its sides, in m.
  std::array<double, 4> orientation{1, 0, 0, 0};  ///< Unit quaternion w, x, y, z.
};

/// Says what was found, and where. Where nothing was found the target is none and the distance infinite.
struct Hit {
  QueryTarget target{};  ///< What it is.
  Vec3 point{};          ///< Where it is touched, on its surface, in m.
  Vec3 normal{};         ///< Unit vector out of its surface there.
  /// How far the ray went, in m, or what was cast along it. Of closest_point() it is how far the surface is,
  /// negative inside.
  double distance = std::numeric_limits<double>::infinity();

  /// Returns whether anything was found.
  explicit constexpr operator bool() const { return target.kind != QueryTarget::Kind::none; }
};

/// Says how thick queries take what has no shape.
///
/// A rod is bare unless a capsule is held by both of its particles and by no other, or a body has both. A
/// particle is bare unless a capsule is held by it or a body has it.
struct QuerySettings {
  double rod_radius = 0;       ///< Radius of bare rods, in m; 0 leaves them out.
  double particle_radius = 0;  ///< Radius of bare particles, in m; 0 leaves them out.
};

/// Finds what lines, balls and boxes meet among the shapes, the ground, and the bare rods and particles of a
/// world.
///
/// It keeps a hierarchy of bounding volumes of its own, and everything is where it was when update() was last
/// called. Between calls of update() any number of threads may ask, even while the world steps.
///
///     plumb::Queries queries(scene, {.rod_radius = 0.01});
///     queries.update(world);  // after each step
///     if (const plumb::Hit hit = queries.cast_ray({.origin = eye, .direction = look})) ...
///
/// Capsules, hulls, planes, boxes and solid meshes are solid. What starts in one, or touches it at the start,
/// meets it at distance 0, with the point and the normal that closest_point() finds. An open mesh is a sheet
/// that is met from both sides. Below a height field all is solid, but its sides are open: what comes from
/// beside it goes in under its border and meets it from below.
///
/// Of equal distances the target that comes first in their order counts. Answers are the same to the bit on
/// every machine and number of threads, and do not depend on how the hierarchy came to be. What has a place
/// that is not finite is not found, and neither are broken rods, nor the cords of tackles. Rods and particles
/// that were added or joined since the scene are found as bare ones, and what was removed is not.
class PLUMB_API Queries {
 public:
  /// Prepares a scene, with everything where it is there. Throws InputError if validate() refuses the scene,
  /// or on a radius that is negative or not finite. It keeps no reference to the scene.
  explicit Queries(const Scene& scene, const QuerySettings& settings = {});
  ~Queries();
  Queries(Queries&&) noexcept;             ///< Moves all; what is left can only be assigned to.
  Queries& operator=(Queries&&) noexcept;  ///< Moves all; what is left can only be assigned to.

  /// Takes everything where it is in a world of the same scene. Throws InputError, and changes nothing, if
  /// the world has fewer particles or rods than the scene, or lacks a platform. Boxes of the hierarchy
  /// follow. Where they have grown far beyond what they were, or bare rods and particles came or went, it is
  /// built anew, which takes some fifteen times as long.
  void update(const World& world);

  /// Returns what a ray meets first. Throws InputError on a ray whose origin is not finite, whose direction
  /// is zero or not finite, or whose length is negative or not a number.
  Hit cast_ray(const Ray& ray, const QueryFilter& filter = {}) const;
  /// Writes what each ray meets first into `hits`, in their order. Threads may share rays by casting parts of
  /// them. Throws InputError on a ray that cast_ray() refuses, with its number, and unless there are as many
  /// hits as rays; then nothing is written.
  void cast_rays(std::span<const Ray> rays, std::span<Hit> hits, const QueryFilter& filter = {}) const;
  /// Returns what a ball, of a radius in m, touches first while its centre goes along a ray. Throws
  /// InputError as cast_ray() does, and on a radius that is negative or not finite.
  Hit cast_sphere(const Ray& ray, double radius, const QueryFilter& filter = {}) const;
  /// Returns what a box touches first while its centre goes along a ray and it does not turn. Of several
  /// places that touch at once the point is one. Distances are exact to 1e-8 of the sizes of what touches.
  /// Throws InputError as cast_ray() does, on a size that is negative or not finite, and on a quaternion that
  /// is not of length one, to within 1e-9.
  Hit cast_box(const Ray& ray, const QueryBox& box, const QueryFilter& filter = {}) const;

  /// Lists in `out`, in their order, what a ball overlaps or touches; what was in `out` is gone. The centre
  /// and the radius are in m. Throws InputError on a centre that is not finite and on a radius that
  /// cast_sphere() refuses; then `out` stays as it is.
  void overlap_sphere(Vec3 center, double radius, std::vector<QueryTarget>& out,
                      const QueryFilter& filter = {}) const;
  /// Lists what a box about a centre (m) overlaps or touches, as overlap_sphere() does. Throws InputError on
  /// a centre that is not finite and on a box that cast_box() refuses.
  void overlap_box(Vec3 center, const QueryBox& box, std::vector<QueryTarget>& out,
                   const QueryFilter& filter = {}) const;
  /// Returns the place on a surface that is nearest to a place (m), if it is no farther than `within` (m). Of
  /// solids that hold the place, that in which it is deepest counts. Throws InputError on a place that is not
  /// finite, and if `within` is negative or not a number.
  Hit closest_point(Vec3 from, double within = std::numeric_limits<double>::infinity(),
                    const QueryFilter& filter = {}) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace plumb
