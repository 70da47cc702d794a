#include "fuzz/random_world.hpp"

#include <fuzzer/FuzzedDataProvider.h>

#include <limits>

#include "plumb/error.hpp"
#include "plumb/joints.hpp"

namespace plumb::fuzz {
namespace {

struct Bytes : FuzzedDataProvider {
  using FuzzedDataProvider::FuzzedDataProvider;
  bool gives_odd_numbers = false;
};

/// One in `n`.
bool rarely(Bytes& bytes, int n) {
  return bytes.ConsumeIntegralInRange(1, n) == n;
}

/// Numbers that have broken programs, of which some are no input at all.
double odd_number(Bytes& bytes) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  static const double numbers[] = {0.0,  -0.0, 1e-320, 1e-300, 1e-30, 1e-12, 1e-6, 1e6,
                                   1e12, 1e30, 1e300,  -1.0,   -1e30, inf,   -inf, nan};
  return bytes.PickValueInArray(numbers);
}

double number(Bytes& bytes, double low, double high) {
  if (bytes.gives_odd_numbers && rarely(bytes, 20)) return odd_number(bytes);
  return low + (high - low) * bytes.ConsumeIntegral<std::uint16_t>() / 65535;
}

/// On a grid: coincident, collinear and coplanar places are common.
double coordinate(Bytes& bytes) {
  if (rarely(bytes, 20)) return number(bytes, -2, 2);
  return 0.25 * bytes.ConsumeIntegralInRange(-4, 4);
}
Vec3 place(Bytes& bytes) {
  const double x = coordinate(bytes), y = coordinate(bytes), z = coordinate(bytes);
  return {x, y, z};
}

std::uint32_t index(Bytes& bytes, std::size_t count) {
  if (rarely(bytes, 100)) return bytes.ConsumeIntegral<std::uint32_t>();
  return bytes.ConsumeIntegralInRange<std::uint32_t>(0,
                                                     count == 0 ? 0 : static_cast<std::uint32_t>(count - 1));
}

Point point(Bytes& bytes, const Scene& scene) {
  if (!scene.rods.empty() && bytes.ConsumeBool())
    return point_on_rod(scene, index(bytes, scene.rods.size()), number(bytes, -0.5, 1.5));
  return point_at(index(bytes, scene.particles.size()));
}

Surface surface(Bytes& bytes) {
  return {.friction = number(bytes, 0, 1.5), .restitution = number(bytes, 0, 1)};
}

void add_particles_and_rods(Bytes& bytes, Scene& scene) {
  const int particles = bytes.ConsumeIntegralInRange(1, 14);
  for (int i = 0; i < particles; ++i) {
    Particle& particle = scene.particles.emplace_back();
    particle.position = place(bytes);
    particle.fixed = rarely(bytes, 4);
    particle.mass = rarely(bytes, 5) ? 0 : number(bytes, 0.01, 10);
    if (rarely(bytes, 3)) particle.velocity = place(bytes);
    particle.asleep = rarely(bytes, 10);
  }
  const int rods = bytes.ConsumeIntegralInRange(0, 2 * particles);
  for (int i = 0; i < rods; ++i) {
    Rod& rod = scene.rods.emplace_back();
    // Chains are common.
    rod.a =
        rarely(bytes, 3) ? index(bytes, scene.particles.size()) : static_cast<std::uint32_t>(i % particles);
    rod.b = rarely(bytes, 3) ? index(bytes, scene.particles.size()) : (rod.a + 1) % particles;
    if (rarely(bytes, 5)) rod.length = number(bytes, 0.1, 1);
    if (rarely(bytes, 2)) rod.mass = number(bytes, 0, 2);
    if (rarely(bytes, 10)) rod.center = number(bytes, 0, 1);
    if (rarely(bytes, 10)) rod.inertia = number(bytes, 0, 1);
    if (rod.mass > 0 && rarely(bytes, 20)) rod.linear_drag = number(bytes, 0, 2);
    if (rod.mass > 0 && rarely(bytes, 20)) rod.orthogonal_drag = number(bytes, 0, 2);
  }
}

RodLaw law(Bytes& bytes) {
  RodLaw out;
  if (bytes.ConsumeBool()) out.stiffness = rarely(bytes, 3) ? number(bytes, 0, 1e9) : number(bytes, 1, 1e4);
  if (rarely(bytes, 3)) out.damping = number(bytes, 0, 100);
  out.one_sided = bytes.ConsumeBool();
  return out;
}

void add_laws(Bytes& bytes, Scene& scene) {
  for (Rod& rod : scene.rods) {
    if (rarely(bytes, 3)) continue;
    rod.law = law(bytes);
    if (rarely(bytes, 3)) rod.law.strength = number(bytes, 0.1, 200);
  }
}

void add_tackle(Bytes& bytes, Scene& scene) {
  Tackle& tackle = scene.tackles.emplace_back();
  for (int i = bytes.ConsumeIntegralInRange(2, 5); i > 0; --i)
    tackle.particles.push_back(index(bytes, scene.particles.size()));
  if (rarely(bytes, 3)) tackle.length = number(bytes, 0.1, 3);
  tackle.law = law(bytes);
  if (rarely(bytes, 3)) tackle.friction = number(bytes, 0, 0.5);
}

/// Bends most rods against the next one, where they share a particle.
void add_bends(Bytes& bytes, Scene& scene) {
  for (std::size_t i = 1; i < scene.rods.size(); ++i) {
    const Rod &first = scene.rods[i - 1], &second = scene.rods[i];
    if (first.b != second.a || rarely(bytes, 3)) continue;
    Bend& bend = scene.bends.emplace_back();
    bend.a = first.a;
    bend.b = rarely(bytes, 50) ? index(bytes, scene.particles.size()) : first.b;
    bend.c = second.b;
    bend.stiffness = rarely(bytes, 3) ? number(bytes, 0, 1e5) : number(bytes, 0, 1);
    if (rarely(bytes, 3)) bend.angle = number(bytes, 0, 2.89);
    if (rarely(bytes, 3)) bend.damping = number(bytes, 0, 1);
  }
}

/// Twists the chain that the first rods make, as far as they follow each other.
void add_twist(Bytes& bytes, Scene& scene) {
  if (scene.rods.empty()) return;
  Twist& twist = scene.twists.emplace_back();
  twist.particles = {scene.rods.front().a};
  for (const Rod& rod : scene.rods)
    if (rod.a == twist.particles.back()) twist.particles.push_back(rod.b);
  twist.stiffness = rarely(bytes, 3) ? number(bytes, 0, 1e5) : number(bytes, 0.01, 1);
  twist.angle = number(bytes, -10, 10);
}

void add_limbs(Bytes& bytes, Scene& scene) {
  if (rarely(bytes, 3)) {
    MassProperties block = solid_box(number(bytes, 0.1, 10), {0.3, 0.2, 0.1});
    block.center = place(bytes);
    const std::uint32_t body = add_body(scene, block);
    if (rarely(bytes, 2)) add_spherical(scene, point_on_body(scene, body, place(bytes)), point(bytes, scene));
  }
  for (int i = bytes.ConsumeIntegralInRange(0, 3); i > 0; --i)
    scene.capsules.push_back({.a = point(bytes, scene),
                              .b = point(bytes, scene),
                              .radius = number(bytes, 0, 0.2),
                              .surface = surface(bytes),
                              .filter = {.own_island = bytes.ConsumeBool()}});
  if (bytes.ConsumeBool())
    scene.planes.push_back({.offset = number(bytes, -2, 0), .surface = surface(bytes)});
  if (rarely(bytes, 4))
    scene.boxes.push_back(
        {.center = place(bytes) + Vec3{0, -2.5, 0}, .half_size = {0.5, 0.2, 0.3}, .surface = surface(bytes)});
  if (rarely(bytes, 4))
    scene.ground_hulls.push_back({.points = {place(bytes), place(bytes), place(bytes), place(bytes)},
                                  .radius = number(bytes, 0, 0.1),
                                  .surface = surface(bytes)});
  if (rarely(bytes, 4))
    scene.meshes.push_back({.vertices = {place(bytes), place(bytes), place(bytes), place(bytes)},
                            .triangles = {{0, 1, 2}, {0, 2, 3}},
                            .surface = surface(bytes)});
  if (rarely(bytes, 4)) add_spherical(scene, point(bytes, scene), point(bytes, scene));
  if (rarely(bytes, 4))
    scene.alignments.push_back(
        {.u = {point(bytes, scene), point(bytes, scene)}, .v = {point(bytes, scene), point(bytes, scene)}});
  if (rarely(bytes, 4))
    scene.angles.push_back({.u = {point(bytes, scene), point(bytes, scene)},
                            .v = {point(bytes, scene), point(bytes, scene)},
                            .lower = number(bytes, 0, 1.5),
                            .upper = number(bytes, 1.5, 3.1),
                            .friction = number(bytes, 0, 1),
                            .stiffness = number(bytes, 0, 100),
                            .damping = number(bytes, 0, 10)});
  if (rarely(bytes, 4))
    scene.springs.push_back({.a = point(bytes, scene),
                             .b = point(bytes, scene),
                             .length = rarely(bytes, 3) ? 0 : number(bytes, 0, 2),
                             .stiffness = rarely(bytes, 3) ? 1e6 : number(bytes, 0, 100),
                             .damping = number(bytes, 0, 10),
                             .force = number(bytes, -5, 5),
                             .one_sided = bytes.ConsumeBool()});
  if (rarely(bytes, 6))
    scene.torsions.push_back({.axis = {point(bytes, scene), point(bytes, scene)},
                              .u = {point(bytes, scene), point(bytes, scene)},
                              .v = {point(bytes, scene), point(bytes, scene)},
                              .angle = number(bytes, -20, 20),
                              .stiffness = number(bytes, 0, 100),
                              .damping = number(bytes, 0, 10),
                              .torque = number(bytes, -5, 5)});
}

/// Solids of hulls, some of them flat, and ground of other kinds. They come last, so that what earlier bytes
/// say stays as it was.
void add_solids(Bytes& bytes, Scene& scene) {
  for (int i = bytes.ConsumeIntegralInRange(1, 3); i > 0; --i) {
    const bool is_flat = rarely(bytes, 3);
    MassProperties solid = is_flat
                               ? MassProperties{.mass = 1, .inertia = {.xx = 0.02, .yy = 0.01, .zz = 0.01}}
                               : solid_box(number(bytes, 0.1, 10), {0.3, 0.2, 0.1});
    solid.center = place(bytes);
    const Box box{.center = solid.center,
                  .half_size = {is_flat ? number(bytes, 1e-4, 0.05) : 0.15, 0.1, 0.05},
                  .surface = surface(bytes)};
    scene.hulls.push_back(box_on_body(add_body(scene, solid), box));
    scene.hulls.back().radius = rarely(bytes, 3) ? number(bytes, 0, 0.05) : 0;
  }
  if (bytes.ConsumeBool())
    scene.ground_capsules.push_back(
        {.a = place(bytes), .b = place(bytes), .radius = number(bytes, 0, 0.3), .surface = surface(bytes)});
  if (bytes.ConsumeBool()) {
    HeightField field{.corner = {-1, -2, -1}, .columns = 3, .surface = surface(bytes)};
    for (int i = 0; i < 9; ++i) field.heights.push_back(number(bytes, -0.5, 0.5));
    scene.height_fields.push_back(field);
  }
}

Settings settings(Bytes& bytes) {
  Settings out;
  out.method = bytes.PickValueInArray({Method::automatic, Method::relax, Method::direct, Method::automatic,
                                       Method::relax, Method::direct, Method::springs, Method::multipliers,
                                       Method::featherstone});
  out.precision = rarely(bytes, 3) ? Precision::single : Precision::double_;
  if (bytes.ConsumeBool())
    out.gradient = bytes.PickValueInArray({Gradient::new_, Gradient::old, Gradient::mid});
  if (rarely(bytes, 4)) out.mass = bytes.PickValueInArray({MassModel::lumped, MassModel::consistent});
  if (rarely(bytes, 4)) out.weights = Weights::equal;
  if (rarely(bytes, 4)) out.order = SweepOrder::jacobi;
  if (rarely(bytes, 4)) out.omega = number(bytes, 0.1, 1.99);
  out.substeps = bytes.ConsumeIntegralInRange(1u, 4u);
  if (rarely(bytes, 6)) out.time_order = bytes.PickValueInArray({2u, 4u, 6u});
  if (rarely(bytes, 6)) out.accuracy = bytes.PickValueInArray({1e-1, 1e-2, 1e-3});
  out.stop.sweeps = bytes.ConsumeIntegralInRange(1u, 20u);
  if (rarely(bytes, 4)) out.stop.tolerance = number(bytes, 1e-8, 1e-2);
  if (rarely(bytes, 4)) out.springs.model = SpringModel::particles;
  if (rarely(bytes, 4))
    out.integrator = bytes.PickValueInArray({Integrator::explicit_euler, Integrator::semi_implicit_euler,
                                             Integrator::rk2, Integrator::rk4, Integrator::implicit_euler,
                                             Integrator::adaptive_implicit_euler});
  out.layout = bytes.PickValueInArray(
      {LayoutChoice::automatic, LayoutChoice::aos, LayoutChoice::soa, LayoutChoice::aosoa});
  out.sleep = bytes.ConsumeBool();
  out.threads = 1;
  return out;
}

}  // namespace

RandomWorld make_random_world(const std::uint8_t* data, std::size_t size) {
  Bytes bytes(data, size);
  bytes.gives_odd_numbers = rarely(bytes, 4);
  RandomWorld out;
  out.settings = settings(bytes);
  out.dt = rarely(bytes, 10) ? number(bytes, 1e-4, 0.2) : 1.0 / 60;
  out.steps = bytes.ConsumeIntegralInRange(1, 6);
  if (rarely(bytes, 10)) out.scene.gravity = {number(bytes, -10, 10), number(bytes, -10, 10), 0};
  if (rarely(bytes, 10)) out.scene.drag = number(bytes, 0, 5);
  add_particles_and_rods(bytes, out.scene);
  if (rarely(bytes, 3)) add_limbs(bytes, out.scene);
  out.pushed = index(bytes, out.scene.particles.size());
  out.push = place(bytes);
  if (rarely(bytes, 4)) add_bends(bytes, out.scene);
  if (rarely(bytes, 6)) add_twist(bytes, out.scene);
  if (rarely(bytes, 3)) add_laws(bytes, out.scene);
  if (rarely(bytes, 6)) add_tackle(bytes, out.scene);
  if (rarely(bytes, 4)) add_solids(bytes, out.scene);
  return out;
}

}  // namespace plumb::fuzz
