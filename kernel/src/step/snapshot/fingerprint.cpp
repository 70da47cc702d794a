#include "step/snapshot/fingerprint.hpp"

#include "scene/lists/digest.hpp"

namespace plumb::detail {

// Digests find these, which an unnamed namespace would hide from them.

// clang-format off
static void visit_members(Digest& to, GroundMotion& of) { auto& [a, b] = of; to(a, b); }
static void visit_members(Digest& to, Plane& of) { auto& [a, b, c, d, e] = of; to(a, b, c, d, e); }
static void visit_members(Digest& to, Box& of) { auto& [a, b, c, d, e, f] = of; to(a, b, c, d, e, f); }
static void visit_members(Digest& to, Pose& of) { auto& [a, b] = of; to(a, b); }
static void visit_members(Digest& to, GroundCapsule& of) { auto& [a, b, c, d, e] = of; to(a, b, c, d, e); }
static void visit_members(Digest& to, GroundHull& of) { auto& [a, b, c, d] = of; to(a, b, c, d); }
static void visit_members(Digest& to, GroundMesh& of) { auto& [a, b, c, d, e] = of; to(a, b, c, d, e); }
static void visit_members(Digest& to, HeightField& of) {
  auto& [a, b, c, d, e, f, g] = of;
  to(a, b, c, d, e, f, g);
}
static void visit_members(Digest& to, SpringSettings& of) { auto& [a, b, c] = of; to(a, b, c); }
static void visit_members(Digest& to, MultiplierSettings& of) { auto& [a, b] = of; to(a, b); }
static void visit_members(Digest& to, ContactSettings& of) {
  auto& [a, b, c, d, e, f, g, h] = of;
  to(a, b, c, d, e, f, g, h);
}
// clang-format on

static void visit_members(Digest& to, Scene& of) {
  auto& [particles, rods, gravity, drag, joint_drag, bends, twists, tackles, reels, bodies, pins, alignments,
         angles, springs, torsions, capsules, hulls, planes, boxes, platforms, ground_capsules, ground_hulls,
         meshes, height_fields] = of;
  to(particles, rods, gravity, drag, joint_drag, bends, twists, tackles, reels, bodies, pins, alignments,
     angles, springs, torsions, capsules, hulls, planes, boxes, platforms, ground_capsules, ground_hulls,
     meshes, height_fields);
}

static void visit_members(Digest& to, Settings& of) {
  auto& [method, precision, gradient, mass, weights, order, omega, substeps, time_order, accuracy, most_work,
         stop, integrator, springs, multipliers, sleep, tensions, contacts, events, sleep_time, contact,
         layout, isa, threads, executor, memory, most_memory] = of;
  to(method, precision, gradient, mass, order, omega, substeps, time_order, accuracy, most_work, integrator,
     springs, multipliers, sleep, tensions, contacts, events, sleep_time, contact, layout);
}

Fingerprint fingerprint_of(const Scene& scene, const Settings& settings) {
  Digest of_scene, of_settings;
  of_scene(scene);
  of_settings(settings);
  return {of_scene.value(), of_settings.value()};
}

}  // namespace plumb::detail
