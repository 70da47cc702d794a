#include "step/snapshot/fingerprint.hpp"

#include <algorithm>
#include <cstring>
#include <optional>
#include <vector>

#include "interface/archive.hpp"
#include "math/byte_sum.hpp"
#include "scene/lists/scene_members.hpp"

namespace plumb::detail {
namespace {

/// Every digest begins with a number without a pattern, as xxHash has it.
constexpr std::uint64_t begin_of_digests = 0xc2b2ae3d27d4eb4f;

std::uint64_t word_at(const std::byte* from, std::size_t count = 8) {
  std::uint64_t word = 0;
  std::memcpy(&word, from, count);
  return word;
}

/// Takes in all members of what describes scenes and settings. Structs are listed by all their members, below
/// or where archives find them, so that a new member does not compile before it is listed.
class Digest {
 public:
  std::uint64_t value() const { return sum_; }

  template <class... T>
  void operator()(const T&... values) {
    (one(values), ...);
  }

 private:
  template <class T>
  void one(const T& value) {
    if constexpr (is_dense<T>)
      take({reinterpret_cast<const std::byte*>(&value), sizeof value});
    else
      visit_members(*this, const_cast<T&>(value));  // which is read alone
  }
  void one(const bool& value) { sum_ = mixed(sum_, value ? 1 : 0); }
  template <class T>
  void one(const std::vector<T>& values) {
    sum_ = mixed(sum_, values.size());
    for (const T& each : values) one(each);
  }
  template <class T>
  void one(const std::optional<T>& value) {
    one(value.has_value());
    if (value) one(*value);
  }
  void take(std::span<const std::byte> bytes) {
    for (std::size_t i = 0; i < bytes.size(); i += 8)
      sum_ = mixed(sum_, word_at(&bytes[i], std::min<std::size_t>(8, bytes.size() - i)));
  }

  std::uint64_t sum_ = begin_of_digests;
};

// clang-format off
void visit_members(Digest& to, const GroundMotion& of) { auto& [a, b] = of; to(a, b); }
void visit_members(Digest& to, const Plane& of) { auto& [a, b, c, d, e] = of; to(a, b, c, d, e); }
void visit_members(Digest& to, const Box& of) { auto& [a, b, c, d, e, f] = of; to(a, b, c, d, e, f); }
void visit_members(Digest& to, const Pose& of) { auto& [a, b] = of; to(a, b); }
void visit_members(Digest& to, const GroundCapsule& of) { auto& [a, b, c, d, e] = of; to(a, b, c, d, e); }
void visit_members(Digest& to, const GroundHull& of) { auto& [a, b, c, d] = of; to(a, b, c, d); }
void visit_members(Digest& to, const GroundMesh& of) { auto& [a, b, c, d, e] = of; to(a, b, c, d, e); }
void visit_members(Digest& to, const HeightField& of) {
  auto& [a, b, c, d, e, f, g] = of;
  to(a, b, c, d, e, f, g);
}
void visit_members(Digest& to, const SpringSettings& of) { auto& [a, b, c] = of; to(a, b, c); }
void visit_members(Digest& to, const MultiplierSettings& of) { auto& [a, b] = of; to(a, b); }
void visit_members(Digest& to, const ContactSettings& of) {
  auto& [a, b, c, d, e, f, g, h] = of;
  to(a, b, c, d, e, f, g, h);
}
// clang-format on

void visit_members(Digest& to, const Scene& of) {
  auto& [particles, rods, gravity, drag, joint_drag, bends, twists, tackles, reels, bodies, pins, alignments,
         angles, springs, torsions, capsules, hulls, planes, boxes, platforms, ground_capsules, ground_hulls,
         meshes, height_fields] = of;
  to(particles, rods, gravity, drag, joint_drag, bends, twists, tackles, reels, bodies, pins, alignments,
     angles, springs, torsions, capsules, hulls, planes, boxes, platforms, ground_capsules, ground_hulls,
     meshes, height_fields);
}

void visit_members(Digest& to, const Settings& of) {
  auto& [method, precision, gradient, mass, weights, order, omega, substeps, time_order, accuracy, most_work,
         stop, integrator, springs, multipliers, sleep, tensions, contacts, events, sleep_time, contact,
         layout, isa, threads, executor] = of;
  to(method, precision, gradient, mass, order, omega, substeps, time_order, accuracy, most_work, integrator,
     springs, multipliers, sleep, tensions, contacts, events, sleep_time, contact, layout);
}

}  // namespace

Fingerprint fingerprint_of(const Scene& scene, const Settings& settings) {
  Digest of_scene, of_settings;
  of_scene(scene);
  of_settings(settings);
  return {of_scene.value(), of_settings.value()};
}

}  // namespace plumb::detail
