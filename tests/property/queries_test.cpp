// Queries find in any world what looking at everything finds: first hits, overlaps and nearest places, by
// distances of places that are written down here for each kind of thing. Each thing alone gives the same bits
// as all together.

#include "plumb/shapes/queries.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "contact/ground/ground_shape.hpp"
#include "contact/platforms/platforms.hpp"
#include "contact/shapes/bounds.hpp"
#include "contact/shapes/meshes/triangle.hpp"
#include "contact/shapes/touch.hpp"
#include "plumb/joints.hpp"
#include "queries/query_tree.hpp"
#include "scenes/basics/seeded.hpp"
#include "support/bodies.hpp"
#include "support/meshes.hpp"
#include "support/sanitizers.hpp"

namespace plumb::PLUMB_TEST_FILE {
namespace {

using Kind = QueryTarget::Kind;
using scenes::Random;

constexpr double thick = 0.03;     ///< m, radius of bare rods
constexpr double rounding = 1e-9;  ///< m, far above that of numbers up to 20, and far below all sizes

Vec3 unit_vector(Random& random) {
  for (;;) {
    const Vec3 v = random.in_cube();
    if (norm(v) > 0.1 && norm(v) < 1) return (1 / norm(v)) * v;
  }
}

std::array<double, 4> any_turn(Random& random) {
  return detail::rotation(3 * random.in_cube());
}

GroundMesh solid_l(Vec3 at) {
  const test::Mesh mesh = test::l_shape();
  GroundMesh out{.vertices = mesh.vertices, .triangles = mesh.triangles, .solid = true};
  for (Vec3& v : out.vertices) v += at;
  return out;
}

/// Ropes, balls, capsules, boxes on bodies and all kinds of ground within 10 m of the origin.
Scene make_scene(std::uint64_t seed) {
  Random random(seed);
  Scene scene;
  const auto place = [&] { return 8 * random.in_cube(); };
  for (int i = 0; i < 12; ++i) test::add_capsule_rod(scene, place(), place(), 1, random.scaled(0.02, 1));
  for (int i = 0; i < 6; ++i) test::add_ball(scene, place(), random.scaled(0.1, 1), 1);
  for (int i = 0; i < 4; ++i) {
    const std::uint32_t body = add_body(scene, solid_sphere(1, 0.5));
    scene.hulls.push_back(box_on_body(body, {.center = place(),
                                             .half_size = {random.scaled(0.2, 2), 0.4, 0.6},
                                             .orientation = any_turn(random)}));
    scene.hulls.back().radius = i % 2 == 0 ? 0 : 0.2;
  }
  for (int rope = 0; rope < 8; ++rope) {
    Vec3 at = place();
    for (int i = 0; i < 12; ++i, at += 0.4 * unit_vector(random)) {
      scene.particles.push_back({.position = at, .mass = 0.1, .fixed = i == 0});
      const auto now = static_cast<std::uint32_t>(scene.particles.size() - 1);
      if (i > 0) scene.rods.push_back({.a = now - 1, .b = now});
    }
  }
  scene.planes = {{.normal = unit_vector(random), .offset = -9}};
  for (int i = 0; i < 3; ++i)
    scene.boxes.push_back({.center = place(), .half_size = {0.3, 1, 2}, .orientation = any_turn(random)});
  scene.ground_capsules = {{place(), place(), 0.4}};
  scene.ground_hulls = {
      {.points = box_on_body(0, {.center = place(), .half_size = {1, 0.5, 0.7}}).points, .radius = 0.3}};
  scene.meshes = {solid_l(place())};
  const test::Mesh sheet = test::landscape(6, 0.8, [](double x, double z) { return std::sin(x) + 0.3 * z; });
  scene.meshes.push_back({.vertices = sheet.vertices, .triangles = sheet.triangles});
  // No ray comes to its sides, which are open.
  HeightField field{.corner = {-60, -8, -60}, .cell_x = 10, .cell_z = 10, .columns = 13};
  for (int i = 0; i < 13 * 13; ++i) field.heights.push_back(random.between(0, 1.5));
  scene.height_fields = {field};
  return scene;
}

// --- How far places are from each thing, negative inside. These are exact outside, and have the right sign.

struct Thing {
  QueryTarget target;
  std::function<double(Vec3)> distance;
};

double from_line(Vec3 x, Vec3 p, Vec3 q) {
  const Vec3 axis = q - p;
  const double square = dot(axis, axis);
  return norm(x - p - (square > 0 ? std::clamp(dot(x - p, axis) / square, 0.0, 1.0) : 0) * axis);
}

/// Of a box about a centre with these axes, which have its half sides as lengths.
double from_box(Vec3 x, Vec3 center, const std::array<Vec3, 3>& axes) {
  double outside = 0, inside = -INFINITY;
  for (const Vec3 axis : axes) {
    const double half = norm(axis), beyond = std::abs(dot(x - center, axis)) / half - half;
    outside += std::pow(std::max(beyond, 0.0), 2);
    inside = std::max(inside, beyond);
  }
  return inside < 0 ? inside : std::sqrt(outside);
}

double from_surface(Vec3 x, const GroundMesh& mesh) {
  double least = INFINITY;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 nearest = detail::nearest_on({mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]}, x).at;
    least = std::min(least, norm(x - nearest));
  }
  return least;
}

/// Of a box whose corners are listed as box_on_body() does, wherever they have been moved.
double from_corners(Vec3 x, const std::vector<Vec3>& at) {
  return from_box(x, 0.5 * (at[0] + at[7]),
                  {0.5 * (at[4] - at[0]), 0.5 * (at[2] - at[0]), 0.5 * (at[1] - at[0])});
}

double from_field(Vec3 x, const HeightField& field, const GroundMesh& mesh) {
  const double away = from_surface(x, mesh);
  const double u = (x.x - field.corner.x) / field.cell_x, v = (x.z - field.corner.z) / field.cell_z;
  const double most = field.columns - 1.0;
  if (!(u > 0 && u < most && v > 0 && v < most)) return away;
  const auto i = static_cast<std::uint32_t>(u), k = static_cast<std::uint32_t>(v);
  const auto height = [&](std::uint32_t column, std::uint32_t row) {
    return field.heights[row * field.columns + column];
  };
  const double s = u - i, t = v - k;
  const double up = s > t ? (1 - s) * height(i, k) + (s - t) * height(i + 1, k) + t * height(i + 1, k + 1)
                          : (1 - t) * height(i, k) + (t - s) * height(i, k + 1) + s * height(i + 1, k + 1);
  return x.y < field.corner.y + up ? -away : away;
}

/// Lists all things of make_scene() where they are now.
std::vector<Thing> things_of(const Scene& scene, const std::vector<Vec3>& x, bool with_rods = true) {
  std::vector<Thing> out;
  const auto add = [&](ShapeKind list, std::size_t i, std::function<double(Vec3)> distance) {
    out.push_back({{Kind::shape, list, static_cast<std::uint32_t>(i)}, std::move(distance)});
  };
  const auto place = [&](const Point& point) { return scenes::place_of(point, x); };
  for (std::size_t i = 0; i < scene.capsules.size(); ++i)
    add(ShapeKind::capsule, i,
        [p = place(scene.capsules[i].a), q = place(scene.capsules[i].b),
         r = scene.capsules[i].radius](Vec3 at) { return from_line(at, p, q) - r; });
  for (std::size_t i = 0; i < scene.hulls.size(); ++i) {
    std::vector<Vec3> corners;
    for (const Vec3 corner : scene.hulls[i].points)
      corners.push_back(place(point_on_body(scene, scene.hulls[i].body, corner)));
    add(ShapeKind::hull, i,
        [corners, r = scene.hulls[i].radius](Vec3 at) { return from_corners(at, corners) - r; });
  }
  for (std::size_t i = 0; i < scene.planes.size(); ++i)
    add(ShapeKind::plane, i,
        [plane = scene.planes[i]](Vec3 at) { return dot(plane.normal, at) - plane.offset; });
  for (std::size_t i = 0; i < scene.boxes.size(); ++i)
    add(ShapeKind::box, i,
        [corners = box_on_body(0, scene.boxes[i]).points](Vec3 at) { return from_corners(at, corners); });
  for (std::size_t i = 0; i < scene.ground_capsules.size(); ++i)
    add(ShapeKind::ground_capsule, i,
        [of = scene.ground_capsules[i]](Vec3 at) { return from_line(at, of.a, of.b) - of.radius; });
  for (std::size_t i = 0; i < scene.ground_hulls.size(); ++i)
    add(ShapeKind::ground_hull, i,
        [of = scene.ground_hulls[i]](Vec3 at) { return from_corners(at, of.points) - of.radius; });
  for (std::size_t i = 0; i < scene.meshes.size(); ++i)
    add(ShapeKind::mesh, i, [of = scene.meshes[i]](Vec3 at) {
      const double away = from_surface(at, of);
      return of.solid && test::is_in_l(at - of.vertices[0]) ? -away : away;
    });
  for (std::size_t i = 0; i < scene.height_fields.size(); ++i)
    add(ShapeKind::height_field, i,
        [of = scene.height_fields[i], mesh = detail::mesh_of(scene.height_fields[i])](Vec3 at) {
          return from_field(at, of, mesh);
        });
  // Those of ropes: capsules and bodies come first in the scene.
  for (std::uint32_t i = 0; with_rods && i < scene.rods.size(); ++i)
    if (scene.rods[i].mass == 0 && scene.particles[scene.rods[i].b].mass == 0.1)
      out.push_back({{Kind::rod, {}, i}, [p = x[scene.rods[i].a], q = x[scene.rods[i].b]](Vec3 at) {
                       return from_line(at, p, q) - thick;
                     }});
  return out;
}

std::vector<Vec3> places(const Scene& scene) {
  std::vector<Vec3> out;
  for (const Particle& particle : scene.particles) out.push_back(particle.position);
  return out;
}

double nearest(const std::vector<Thing>& things, Vec3 at) {
  double least = INFINITY;
  for (const Thing& thing : things) least = std::min(least, thing.distance(at));
  return least;
}
double distance_of(const std::vector<Thing>& things, const QueryTarget& target, Vec3 at) {
  for (const Thing& thing : things)
    if (thing.target == target) return thing.distance(at);
  return NAN;
}

/// Says how a ball or a ray goes, with what it met.
struct Flight {
  Ray ray;
  double radius;
  Hit hit;
};

/// Goes along by what is free around, which nothing can be within, to where something is met or nothing is.
/// What is only grazed may be passed, by less than a millimetre of way.
void expect_first(const std::vector<Thing>& things, const Flight& flight) {
  const Ray& ray = flight.ray;
  const Hit& hit = flight.hit;
  const double radius = flight.radius;
  const Vec3 along = (1 / norm(ray.direction)) * ray.direction;
  const auto at = [&](double t) { return ray.origin + t * along; };
  const double end = hit ? hit.distance : 40;
  for (double t = 0; t < end;) {
    const double room = nearest(things, at(t)) - radius;
    ASSERT_GE(room, -rounding) << t << " of " << end;
    t += std::max(room, 1e-3);
  }
  if (!hit) return;
  const double left = distance_of(things, hit.target, at(hit.distance)) - radius;
  if (hit.distance == 0) {
    ASSERT_LE(left, rounding);
    return;
  }
  ASSERT_NEAR(left, 0, rounding);
  ASSERT_NEAR(norm(hit.point - at(hit.distance)), radius, rounding);
  ASSERT_NEAR(norm(hit.normal), 1, 1e-12);
  // The touch is where the centre is, one radius back along the normal.
  ASSERT_LE(norm(hit.point + radius * hit.normal - at(hit.distance)), std::sqrt(rounding));
}

Ray any_ray(Random& random) {
  return {.origin = 10 * random.in_cube(),
          .direction = random.scaled(0.1, 10) * unit_vector(random),
          .length = 40};
}

TEST(Queries, MeetFirstWhatIsFirst) {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const Scene scene = make_scene(seed);
    const Queries queries(scene, {.rod_radius = thick});
    const std::vector<Thing> things = things_of(scene, places(scene));
    Random random(100 + seed);
    int met = 0;
    for (int i = 0; i < test::scaled(200); ++i) {
      const Ray ray = any_ray(random);
      const double radius = i % 2 == 0 ? 0 : random.scaled(0.01, 1);
      const Hit hit = i % 2 == 0 ? queries.cast_ray(ray) : queries.cast_sphere(ray, radius);
      met += bool(hit);
      expect_first(things, {ray, radius, hit});
      if (HasFatalFailure())
        FAIL() << "seed " << seed << ", ray " << i << ", target list " << int(hit.target.kind) << ' '
               << to_string(hit.target.list) << ' ' << hit.target.number << ", radius " << radius;
    }
    EXPECT_GT(met, test::scaled(100));
  }
}

TEST(Queries, FindWhatIsNearestAndWhatOverlaps) {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const Scene scene = make_scene(seed);
    const Queries queries(scene, {.rod_radius = thick});
    const std::vector<Thing> things = things_of(scene, places(scene));
    Random random(200 + seed);
    std::vector<QueryTarget> found;
    for (int i = 0; i < test::scaled(300); ++i) {
      const Vec3 at = 10 * random.in_cube();
      const double least = nearest(things, at);
      const Hit hit = queries.closest_point(at);
      ASSERT_TRUE(hit);
      // Of what is rounded the distance within is that to the surface, which the box's is not.
      const double own = distance_of(things, hit.target, at);
      if (least > 0) {
        ASSERT_NEAR(hit.distance, least, rounding) << seed << ' ' << i;
        ASSERT_NEAR(own, least, rounding) << seed << ' ' << i;
        ASSERT_NEAR(distance_of(things, hit.target, hit.point), 0, rounding) << seed << ' ' << i;
        ASSERT_NEAR(norm(hit.point + hit.distance * hit.normal - at), 0, rounding) << seed << ' ' << i;
        ASSERT_FALSE(queries.closest_point(at, least - rounding));
      } else {
        ASSERT_LE(hit.distance, rounding) << seed << ' ' << i;
        ASSERT_LE(own, rounding) << seed << ' ' << i;
      }
      const double radius = random.scaled(0.01, 3);
      queries.overlap_sphere(at, radius, found);
      ASSERT_TRUE(std::is_sorted(found.begin(), found.end()));
      for (const Thing& thing : things) {
        const double gap = thing.distance(at) - radius;
        if (std::abs(gap) < rounding) continue;
        ASSERT_EQ(std::binary_search(found.begin(), found.end(), thing.target), gap < 0)
            << seed << ' ' << i << ' ' << to_string(thing.target.list);
      }
    }
  }
}

/// Returns a place in a box about `at`, by shares of its sides from -1 to 1.
Vec3 place_in(Vec3 at, const QueryBox& box, Vec3 share) {
  const std::array<Vec3, 3> axes = axes_of(box.orientation);
  return at + share.x * box.half_size.x * axes[0] + share.y * box.half_size.y * axes[1] +
         share.z * box.half_size.z * axes[2];
}

QueryBox grown(QueryBox box, double by) {
  box.half_size += Vec3{by, by, by};
  return box;
}

TEST(Queries, BoxesOverlapWhatHasAPlaceInThem) {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const Scene scene = make_scene(seed);
    const Queries queries(scene, {.rod_radius = thick});
    const std::vector<Thing> things = things_of(scene, places(scene));
    Random random(300 + seed);
    std::vector<QueryTarget> found;
    for (int i = 0; i < test::scaled(60); ++i) {
      const Vec3 at = 9 * random.in_cube();
      const QueryBox box{.half_size = {random.scaled(0.1, 2), random.scaled(0.1, 2), random.scaled(0.1, 2)},
                         .orientation = any_turn(random)};
      queries.overlap_box(at, box, found);
      for (const Thing& thing : things) {
        const bool is_found = std::binary_search(found.begin(), found.end(), thing.target);
        // Down the slope of the distance from the middle, within the box, to its least there.
        Vec3 share{};
        double least = thing.distance(at), step = 1;
        for (int tries = 0; tries < 2000 && step > 1e-5; ++tries) {
          Vec3 next = share + step * random.in_cube();
          next = {std::clamp(next.x, -1.0, 1.0), std::clamp(next.y, -1.0, 1.0),
                  std::clamp(next.z, -1.0, 1.0)};
          const double there = thing.distance(place_in(at, box, next));
          if (there < least) {
            least = there;
            share = next;
          } else {
            step *= 0.97;
          }
          if (least < 0) break;
        }
        // A search that finds none inside may have missed a corner of something by some centimetres.
        const bool is_sure = least < 0 || least > 0.2;
        ASSERT_TRUE(!is_sure || is_found == (least < 0))
            << seed << ' ' << i << ' ' << to_string(thing.target.list);
      }
    }
  }
}

// A box that has gone as far as it can, to 1e-8 of the sizes, has nothing in it unless it is larger.
TEST(Queries, BoxesGoAsFarAsTheyCan) {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const Scene scene = make_scene(seed);
    const Queries queries(scene, {.rod_radius = thick});
    Random random(400 + seed);
    std::vector<QueryTarget> found;
    constexpr double exact = 1e-6;  // m, sizes are up to 60 m, with room
    for (int i = 0; i < test::scaled(100); ++i) {
      const Ray ray = any_ray(random);
      const QueryBox box{.half_size = {random.scaled(0.1, 1), random.scaled(0.1, 1), random.scaled(0.1, 1)},
                         .orientation = any_turn(random)};
      const Vec3 along = (1 / norm(ray.direction)) * ray.direction;
      const Hit hit = queries.cast_box(ray, box);
      const double end = hit ? hit.distance : ray.length;
      if (hit) {
        queries.overlap_box(ray.origin + end * along, grown(box, exact), found);
        ASSERT_TRUE(std::binary_search(found.begin(), found.end(), hit.target)) << seed << ' ' << i;
      }
      for (int k = 0; k < 50 && end > 0; ++k) {
        const double t = k == 0 ? end : random.between(0, end);
        queries.overlap_box(ray.origin + t * along, grown(box, -exact), found);
        ASSERT_TRUE(found.empty()) << seed << ' ' << i << ' ' << t << " of " << end << ' '
                                   << to_string(found[0].list);
      }
    }
  }
}

/// Keeps one thing of a list and empties all others. Bodies stay, because hulls need them.
template <class List>
void keep_one(Scene& scene, List Scene::*list, std::size_t i) {
  const auto one = (scene.*list)[i];
  scene.capsules.clear();
  scene.hulls.clear();
  scene.planes.clear();
  scene.boxes.clear();
  scene.ground_capsules.clear();
  scene.ground_hulls.clear();
  scene.meshes.clear();
  scene.height_fields.clear();
  (scene.*list) = {one};
}

struct Alone {
  QueryTarget target;
  Queries queries;
};

template <class List>
void add_alone(const Scene& scene, ShapeKind kind, List Scene::*list, std::vector<Alone>& out) {
  for (std::size_t i = 0; i < (scene.*list).size(); ++i) {
    Scene one = scene;
    keep_one(one, list, i);
    out.push_back({{Kind::shape, kind, static_cast<std::uint32_t>(i)}, Queries(one)});
  }
}

void expect_same(const Hit& hit, const Hit& wanted, const std::string& what) {
  ASSERT_EQ(hit.target, wanted.target) << what;
  ASSERT_EQ(hit.distance, wanted.distance) << what;
  ASSERT_EQ(hit.point, wanted.point) << what;
  ASSERT_EQ(hit.normal, wanted.normal) << what;
}

TEST(Queries, GiveTheBitsOfEachThingAlone) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const Scene scene = make_scene(seed);
    const Queries queries(scene);
    std::vector<Alone> alone;
    add_alone(scene, ShapeKind::capsule, &Scene::capsules, alone);
    add_alone(scene, ShapeKind::hull, &Scene::hulls, alone);
    add_alone(scene, ShapeKind::plane, &Scene::planes, alone);
    add_alone(scene, ShapeKind::box, &Scene::boxes, alone);
    add_alone(scene, ShapeKind::ground_capsule, &Scene::ground_capsules, alone);
    add_alone(scene, ShapeKind::ground_hull, &Scene::ground_hulls, alone);
    add_alone(scene, ShapeKind::mesh, &Scene::meshes, alone);
    add_alone(scene, ShapeKind::height_field, &Scene::height_fields, alone);
    const auto first = [&](auto&& ask) {
      Hit best;
      for (const Alone& each : alone)
        if (Hit hit = ask(each.queries); hit.distance < best.distance) {
          best = hit;
          best.target = each.target;
        }
      return best;
    };
    Random random(500 + seed);
    for (int i = 0; i < test::scaled(150); ++i) {
      Ray ray = any_ray(random);
      if (i % 3 == 0) ray.length = random.chance(0.5) ? INFINITY : 3;
      const double radius = random.scaled(0.01, 1);
      const QueryBox box{.half_size = {radius, 0.3, 0.1}, .orientation = any_turn(random)};
      const auto compare = [&](const char* what, auto&& ask) {
        expect_same(ask(queries), first(ask), what + (" of seed " + std::to_string(seed)));
      };
      compare("ray", [&](const Queries& of) { return of.cast_ray(ray); });
      compare("ball", [&](const Queries& of) { return of.cast_sphere(ray, radius); });
      compare("box", [&](const Queries& of) { return of.cast_box(ray, box); });
      compare("place", [&](const Queries& of) { return of.closest_point(ray.origin, ray.length); });
      if (HasFatalFailure()) return;
    }
  }
}

// The hierarchy follows what moves, wherever that goes, and finds what a new one finds.
TEST(Queries, FollowAWorldThatFalls) {
  const Scene scene = make_scene(7);
  World world(scene, {.substeps = 4, .threads = 1});
  Queries queries(scene, {.rod_radius = thick});
  Random random(600);
  for (int step = 0; step < 90; ++step) {
    world.step(1.0 / 60);
    queries.update(world);
    if (step % 30 != 29) continue;
    std::vector<Vec3> x(world.particle_count());
    world.copy_positions(x);
    const std::vector<Thing> things = things_of(scene, x);
    for (int i = 0; i < test::scaled(100); ++i) {
      const Ray ray = any_ray(random);
      expect_first(things, {ray, 0, queries.cast_ray(ray)});
      if (HasFatalFailure()) FAIL() << "step " << step << ", ray " << i;
    }
  }
}

TEST(Queries, AnswerTwoThreadsWhileTheWorldSteps) {
  const Scene scene = make_scene(8);
  World world(scene, {.threads = 1});
  Queries queries(scene, {.rod_radius = thick});
  world.step(1.0 / 60);
  queries.update(world);
  Random random(700);
  std::vector<Ray> rays;
  for (int i = 0; i < test::scaled(2000); ++i) rays.push_back(any_ray(random));
  std::vector<Hit> alone(rays.size());
  queries.cast_rays(rays, alone);
  std::array<std::vector<Hit>, 2> hits;
  std::array<std::thread, 2> threads;
  for (std::size_t k = 0; k < 2; ++k)
    threads[k] = std::thread([&, k] {
      hits[k].resize(rays.size());
      queries.cast_rays(rays, hits[k]);
    });
  for (int i = 0; i < 5; ++i) world.step(1.0 / 60);
  for (std::thread& thread : threads) thread.join();
  for (const std::vector<Hit>& found : hits)
    for (std::size_t i = 0; i < rays.size(); ++i) expect_same(found[i], alone[i], "a thread");
}

/// Boxes that move about, some of which are nowhere.
TEST(QueryTree, SeesAllThatABoxMayReach) {
  Random random(800);
  std::vector<detail::Bounds> boxes(300);
  const auto strew = [&](double far) {
    for (detail::Bounds& box : boxes) {
      box = detail::nowhere;
      if (random.chance(0.9)) detail::include(box, far * random.in_cube(), random.scaled(0.01, 0.5));
    }
  };
  strew(5);
  detail::QueryTree tree;
  tree.build(boxes);
  for (detail::Bounds& box : boxes) box = {box.low + Vec3{0, 3, 0}, box.high + Vec3{0.1, 3, 0}};
  tree.fit(boxes);
  EXPECT_FALSE(tree.is_worn());
  for (const double far : {5.0, 20.0, 1e7}) {
    strew(far);
    tree.fit(boxes);
    EXPECT_TRUE(tree.is_worn()) << far;
    for (int i = 0; i < 100; ++i) {
      detail::Way way{far * random.in_cube(), unit_vector(random), 0.1 * random.in_cube()};
      way.half = {std::abs(way.half.x), std::abs(way.half.y), std::abs(way.half.z)};
      if (i % 4 == 0) way.direction = {0, 0, i % 8 == 0 ? 1.0 : -1.0};
      const detail::Bounds start{way.origin - way.half, way.origin + way.half};
      double best = random.scaled(0.1 * far, 3 * far), near = best, none = INFINITY;
      std::vector<std::uint8_t> along(boxes.size()), within(boxes.size()), close(boxes.size());
      tree.along(way, best, [&](std::uint32_t k) { along[tree.order()[k]] = 1; });
      tree.within(start, [&](std::uint32_t k) { within[tree.order()[k]] = 1; });
      tree.near(way.origin, near, [&](std::uint32_t k) { close[tree.order()[k]] = 1; });
      std::size_t seen = 0;
      for (std::size_t n = 0; n < boxes.size(); ++n) {
        if (boxes[n].is_empty()) continue;
        EXPECT_TRUE(along[n] || detail::way_to(boxes[n], start, way.direction) > best) << far << ' ' << i;
        EXPECT_TRUE(within[n] || !boxes[n].overlaps(start)) << far << ' ' << i;
        EXPECT_TRUE(close[n] || distance2(boxes[n], way.origin) > near * near) << far << ' ' << i;
        ++seen;
      }
      std::size_t all = 0;
      tree.near(way.origin, none, [&](std::uint32_t) { ++all; });
      EXPECT_GE(all, seen);
    }
  }
}

}  // namespace
}  // namespace plumb::PLUMB_TEST_FILE
