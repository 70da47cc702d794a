#include <algorithm>
#include <cmath>

#include "plumb/embedding/memory.hpp"
#include "plumb/scene.hpp"
#include "plumb/settings.hpp"

namespace plumb {
namespace {

// Bytes as measured with scenes of the generators, and the next round number above.

constexpr double of_world = 40'000;
constexpr double of_relaxed = 280, of_solved = 600;  ///< a particle or rod of what nothing can touch
constexpr double of_truss = 1'700;                   ///< that where rods are many more than particles
constexpr double of_bend = 700;                      ///< of a bend, or a particle of a twist
/// A particle or rod of islands with shapes, joints, springs or bodies. Nets are factorised whole there,
/// which takes this times the fourth root of their particles.
constexpr double of_relaxed_part = 1'050, of_solved_part = 1'550, of_net_part = 600;
constexpr double of_shape = 50, of_ground = 400;  ///< a piece of ground: a triangle of a mesh, and so on

bool has_parts(const Scene& scene) {
  return !scene.capsules.empty() || !scene.hulls.empty() || !scene.bodies.empty() || !scene.pins.empty() ||
         !scene.alignments.empty() || !scene.angles.empty() || !scene.springs.empty() ||
         !scene.torsions.empty();
}

double bytes_an_item(const Scene& scene, const Settings& settings) {
  const bool is_relaxed = settings.method == Method::relax;
  const bool is_truss = scene.rods.size() > 5 * scene.particles.size() / 2;
  if (!has_parts(scene)) return is_relaxed ? of_relaxed : is_truss ? of_truss : of_solved;
  if (is_relaxed) return of_relaxed_part;
  const double particles = static_cast<double>(scene.particles.size());
  const bool may_have_nets = scene.rods.size() > scene.particles.size() + 6 * scene.bodies.size();
  return std::max(of_solved_part, may_have_nets ? of_net_part * std::sqrt(std::sqrt(particles)) : 0.0);
}

double pieces_of_ground(const Scene& scene) {
  std::size_t sum = scene.planes.size() + scene.boxes.size() + scene.ground_capsules.size();
  for (const GroundHull& each : scene.ground_hulls) sum += each.points.size();
  for (const GroundMesh& each : scene.meshes) sum += each.vertices.size() + each.triangles.size();
  for (const HeightField& each : scene.height_fields) sum += each.heights.size();
  return static_cast<double>(sum);
}

}  // namespace

std::size_t estimate_memory(const Scene& scene, const Settings& settings) {
  const auto items = static_cast<double>(scene.particles.size() + scene.rods.size());
  const auto shapes = static_cast<double>(scene.capsules.size() + scene.hulls.size());
  auto bends = static_cast<double>(scene.bends.size());
  for (const Twist& each : scene.twists) bends += static_cast<double>(each.particles.size());
  return static_cast<std::size_t>(of_world + items * bytes_an_item(scene, settings) + of_bend * bends +
                                  of_shape * shapes + of_ground * pieces_of_ground(scene));
}

}  // namespace plumb
