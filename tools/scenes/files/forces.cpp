#include "scenes/files/forces.hpp"

#include <cmath>
#include <cstdint>
#include <span>

#include "scenes/basics/numbers.hpp"

namespace plumb::scenes {
namespace {

void append_row(std::string& csv, double t, const char* kind, std::size_t number,
                std::span<const double> values) {
  append_exact(csv, t);
  csv += ',';
  csv += kind;
  csv += ',' + std::to_string(number);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    csv += ',';
    if (axis < values.size() && std::isfinite(values[axis])) append_exact(csv, values[axis]);
  }
  csv += '\n';
}

void append_row(std::string& csv, double t, const char* kind, std::size_t number, const Vec3& force) {
  const double values[] = {force.x, force.y, force.z};
  append_row(csv, t, kind, number, values);
}

}  // namespace

Forces make_forces(const Scene& scene) {
  return {.reactions = std::vector<Vec3>(scene.particles.size()),
          .pins = std::vector<Vec3>(scene.pins.size()),
          .springs = std::vector<Vec3>(scene.springs.size()),
          .contacts = std::vector<Vec3>(scene.capsules.size() + scene.hulls.size()),
          .angles = std::vector<double>(scene.angles.size()),
          .torsions = std::vector<double>(scene.torsions.size())};
}

void copy_forces(const World& world, Forces& forces) {
  world.copy_reactions(forces.reactions);
  // Ends of rods that broke may have shapes that the scene does not have.
  for (std::uint32_t i = 0; i < forces.contacts.size(); ++i) forces.contacts[i] = world.contact_force(i);
  for (std::uint32_t i = 0; i < forces.pins.size(); ++i) forces.pins[i] = world.pin_force(i);
  for (std::uint32_t i = 0; i < forces.springs.size(); ++i) forces.springs[i] = world.spring_force(i);
  for (std::uint32_t i = 0; i < forces.angles.size(); ++i) forces.angles[i] = world.angle_torque(i);
  for (std::uint32_t i = 0; i < forces.torsions.size(); ++i) forces.torsions[i] = world.torsion_torque(i);
}

void append_forces(std::string& csv, double t, const Scene& scene, const Forces& forces) {
  for (std::size_t i = 0; i < forces.reactions.size(); ++i)
    if (scene.particles[i].fixed) append_row(csv, t, "anchor", i, forces.reactions[i]);
  const auto append_all = [&](const char* kind, std::span<const Vec3> of) {
    for (std::size_t i = 0; i < of.size(); ++i) append_row(csv, t, kind, i, of[i]);
  };
  append_all("pin", forces.pins);
  append_all("spring", forces.springs);
  append_all("capsule", forces.contacts);
  const auto append_torques = [&](const char* kind, std::span<const double> of) {
    for (std::size_t i = 0; i < of.size(); ++i) append_row(csv, t, kind, i, of.subspan(i, 1));
  };
  append_torques("angle", forces.angles);
  append_torques("torsion", forces.torsions);
}

}  // namespace plumb::scenes
