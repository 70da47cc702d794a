#include "view/exhibit/exhibit.hpp"

#include <cmath>
#include <optional>
#include <utility>

#include "plumb/error.hpp"
#include "plumb/measures.hpp"
#include "scenes/basics/lists.hpp"
#include "scenes/basics/numbers.hpp"

namespace plumb::view {
namespace {

bool is_of_scene(const std::string& setting) {
  return setting == "gravity" || setting == "drag" || setting == "end_mass";
}

double number_of(const Request& request) {
  const auto value = scenes::parse_number<double>(request.value);
  if (!value) throw InputError(request.name + " must be a number, not '" + request.value + "'");
  return *value;
}

void set(Side& side, const Request& request) {
  if (!is_of_scene(request.name)) {
    side.set(request.name, request.value);
    return;
  }
  const double value = number_of(request);
  if (request.name == "gravity") {
    side.set_gravity({0, -value, 0});
  } else if (request.name == "drag") {
    if (value < 0) throw InputError("drag must be at least 0");
    side.set_drag(value);
  } else {
    if (!(value > 0)) throw InputError("the end mass must be positive");
    side.set_end_mass(value);
  }
}

}  // namespace

Exhibit::Exhibit(Start start) : start_(std::move(start)), diagonal_(bounding_diagonal(start_.scene)) {
  if (start_.sides.empty() || start_.sides.size() > most_sides)
    throw InputError("there are " + std::to_string(start_.sides.size()) +
                     " worlds to compare; it takes 1 to " + std::to_string(most_sides));
  for (const SideStart& side : start_.sides) sides_.emplace_back(side, start_.scene);
}

void Exhibit::give(Side& side, const Request& request) const {
  switch (request.verb) {
    case Verb::set:
      return set(side, request);
    case Verb::pull:
      return side.pull({.particle = request.number, .target = request.at});
    case Verb::release:
      return side.let_go();
    case Verb::cut:
      return side.cut(request.number);
    case Verb::fix:
      return side.fix(request.number);
    case Verb::free:
      return side.free(request.number);
    case Verb::reel:
      return side.reel(request.name, request.number, number_of({.name = "the rate", .value = request.value}));
    case Verb::throw_ball:
      return side.throw_ball(request.at, request.velocity,
                             number_of({.name = "the radius", .value = request.value}));
    default:
      throw InputError("'" + std::string(to_string(request.verb)) + "' does not change how worlds move");
  }
}

std::string Exhibit::take(const Request& request) {
  if (request.side && *request.side >= sides_.size())
    throw InputError("no world " + std::to_string(*request.side) + "; there are " +
                     std::to_string(sides_.size()));
  if (request.side && request.verb == Verb::set && is_of_scene(request.name))
    throw InputError(request.name + " is the same in all worlds");
  std::string refused;
  std::size_t taken_by = 0;
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    if (request.side && *request.side != i) continue;
    try {
      give(sides_[i], request);
      ++taken_by;
    } catch (const InputError& error) {
      scenes::append_item(refused, sides_[i].name() + ": " + error.what(), "; ");
    }
  }
  if (taken_by == 0) throw InputError(refused);
  taken_.push_back({frame_, request});
  return refused;
}

void Exhibit::step() {
  for (Side& side : sides_) side.step(frame_length);
  ++frame_;
}

Start Exhibit::next_start() const {
  Start out = start_;
  const Scene& now = sides_.front().scene();
  out.scene.gravity = now.gravity;
  out.scene.drag = now.drag;
  const std::uint32_t end = end_particle(out.scene);
  if (end != no_island) out.scene.particles[end].mass = now.particles[end].mass;
  for (std::size_t i = 0; i < sides_.size(); ++i) out.sides[i].settings = sides_[i].settings();
  return out;
}

void Exhibit::reset() {
  *this = Exhibit(next_start());
}

double Exhibit::distance(std::size_t side) const {
  const std::vector<Vec3> reference = sides_.front().positions(), own = sides_[side].positions();
  if (reference.size() != own.size() || !(diagonal_ > 0)) return 0;
  return rms_distance(own, reference) / diagonal_;
}

}  // namespace plumb::view
