#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "contact/linkage/combination.hpp"
#include "contact/platforms/platforms.hpp"
#include "contact/shapes/bounds.hpp"
#include "contact/shapes/hulls/convex_hull.hpp"
#include "contact/shapes/meshes/triangle_mesh.hpp"
#include "contact/surroundings.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/shapes/queries.hpp"
#include "queries/solid_box.hpp"

namespace plumb::detail {

/// This is one that a query may find, but for planes, where it is now. It fills a line of the cache.
///
/// Its number is its place in the order of targets. A capsule is the line from p to q (m) with its radius
/// (m).
struct Thing {
  enum class Form : std::uint8_t { gone, capsule, solid, mesh };
  Vec3 p{}, q{};
  double radius = 0;
  std::uint32_t number = 0;
  Form form = Form::gone;
};

/// This is a plane where it is now: its unit normal, and how far (m) it is along it.
struct PlaneNow {
  Vec3 normal{};
  double offset = 0;
  std::uint32_t number = 0;  ///< its place in the order of targets
};

/// This is a rod that nothing else shows, between two particles.
struct BareRod {
  std::uint32_t rod, a, b;
  friend bool operator==(const BareRod&, const BareRod&) = default;
};

/// This is a capsule or hull that was added since the scene.
struct AddedShape {
  ShapeId shape;
  std::uint64_t digest;  ///< of how it is described
  friend bool operator==(const AddedShape&, const AddedShape&) = default;
};

/// Says where a world is. Rods that are out, and capsules and hulls of the scene that ended, are bytes other
/// than 0.
struct Whereabouts {
  /// This is a capsule that is a sphere around a particle, since its rod is out.
  struct Sphere {
    std::uint32_t capsule, particle;
  };

  std::span<const Vec3> positions;  ///< m, by particle
  std::span<const std::uint8_t> gone, ended_capsules, ended_hulls;
  std::span<const Sphere> spheres;  ///< ascending by capsule
  std::span<const Pose> platforms;

  /// Returns the particle around which a capsule is a sphere, if it is one of these.
  std::optional<std::uint32_t> middle_of(std::uint32_t capsule) const {
    const auto at = std::lower_bound(spheres.begin(), spheres.end(), capsule,
                                     [](const Sphere& each, std::uint32_t of) { return each.capsule < of; });
    if (at == spheres.end() || at->capsule != capsule) return std::nullopt;
    return at->particle;
  }
};

/// Keeps what of a world can be found by queries, and where it is now.
class Things {
 public:
  /// Takes shapes and ground of a scene. Bare rods and particles are listed apart.
  Things(const Scene& scene, const QuerySettings& settings);

  /// Lists the bare rods and particles that there are, and the shapes of the scene `now` that were added.
  /// Returns whether they are others than last time; the list then has others, too.
  bool list_bare(const Scene& now, std::span<const BareRod> rods, std::span<const std::uint32_t> particles,
                 std::span<const AddedShape> shapes);
  /// Takes everything where it is.
  void update(const Whereabouts& now);

  /// Lists all but planes, in the order of their numbers, and boxes around them. What is gone is nowhere.
  std::span<const Thing> list() const { return things_; }
  std::span<const Bounds> bounds() const { return bounds_; }
  /// Lists the places in the list of what a hierarchy leaves out, because it would be as large as that:
  /// landscapes with all that is below them. Their bounds are nowhere.
  std::span<const std::uint32_t> wide() const { return wide_; }
  std::span<const PlaneNow> planes() const { return planes_; }

  /// Returns the shape of a solid, or of the line of a capsule, which `ends` has room for.
  Convex convex(const Thing& thing, std::array<Vec3, 2>& ends) const;
  const TriangleMesh& mesh(const Thing& thing) const { return meshes_[index_[thing.number]]; }

  const QueryTarget& target(std::uint32_t number) const { return targets_[number]; }
  /// Returns whether a filter lets a query find it.
  bool may_find(std::uint32_t number, const QueryFilter& filter) const;

 private:
  /// A capsule goes where its places do.
  struct Line {
    std::uint32_t thing;
    Combination a, b;
  };
  /// A hull goes where the particles of its body do.
  struct Carried {
    std::uint32_t thing = 0, solid = 0;
    ConvexHull hull;  ///< as it is in the scene
    std::array<std::uint32_t, 4> particles;
    Array<std::array<double, 4>> corners;  ///< weights of the particles
    Array<Vec3> vertices, normals;         ///< now
  };

  std::uint32_t add(const QueryTarget& target, const Filter& filter);
  std::uint32_t add_thing(const QueryTarget& target, const Filter& filter, const Thing& thing,
                          std::size_t index = 0);
  std::uint32_t add_solid(ShapeKind list, std::size_t i, const Filter& filter, double radius);
  void add_capsule(const Scene& scene, std::size_t i);
  void add_hull(const Scene& scene, std::size_t i);
  void add_ground(const Scene& scene);
  void add_mesh(ShapeKind list, std::size_t i, const GroundMesh& mesh, MeshSides sides);
  void move_platforms(std::span<const Pose> platforms);
  void move_hulls(const Whereabouts& now);
  Bounds around(const Thing& thing) const;

  Array<QueryTarget> targets_;
  Array<Filter> filters_;
  Array<std::uint32_t> index_;  ///< by number: which of the solids or meshes it is
  Array<Thing> things_;
  Array<Bounds> bounds_;
  Array<Line> lines_;
  /// Says how many of each the scene has: what is bare or was added comes after these.
  struct Counts {
    std::size_t things = 0, numbers = 0, lines = 0, carried = 0, solids = 0;
  } first_;
  double rod_radius_, particle_radius_;  ///< m
  Array<BareRod> rods_;
  Array<std::uint32_t> particles_;
  Array<AddedShape> added_;
  Array<std::unique_ptr<Carried>> carried_;  ///< Convex shapes point to what stays where it is.
  /// Of solids, which are hulls on bodies, boxes, hulls of the ground and added hulls in this order: their
  /// shapes now, and the first box.
  Array<Convex> solids_;
  std::size_t first_box_ = 0, first_box_thing_ = 0;
  Array<ConvexHull> ground_hulls_;
  Array<SolidBox> boxes_;  ///< now
  Array<TriangleMesh> meshes_;
  Array<std::uint32_t> wide_;
  Array<PlaneNow> planes_;
  Array<Plane> home_planes_;
  Array<Surroundings::Solid> home_boxes_;
  Platforms platforms_;
  Array<Pose> poses_;  ///< of the platforms, now
};

}  // namespace plumb::detail
