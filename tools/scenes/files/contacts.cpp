#include "scenes/files/contacts.hpp"

#include "scenes/basics/numbers.hpp"

namespace plumb::scenes {
namespace {

void append_name(std::string& csv, ShapeId shape) {
  csv += ',';
  csv += to_string(shape.kind);
  csv += ' ' + std::to_string(shape.number);
}

void append_vector(std::string& csv, Vec3 v) {
  for (const double each : {v.x, v.y, v.z}) {
    csv += ',';
    append_exact(csv, each);
  }
}

}  // namespace

void append_contacts(std::string& csv, double t, std::span<const Contact> contacts) {
  for (const Contact& each : contacts) {
    append_exact(csv, t);
    append_name(csv, each.a);
    append_name(csv, each.b);
    csv += ',';
    csv += to_string(each.phase);
    append_vector(csv, each.point);
    append_vector(csv, each.normal);
    append_vector(csv, each.impulse);
    csv += ',';
    append_exact(csv, each.approach_speed);
    csv += '\n';
  }
}

}  // namespace plumb::scenes
