#include "fall/view.hpp"

#include "scenes/runs/depth.hpp"
#include "scenes/shots/cores.hpp"

namespace plumb::tools {
namespace {

const double side_sin = 0.5, side_cos = std::sqrt(0.75);
constexpr double down_sin = 0.4226182617, down_cos = 0.9063077870;

Vec3 to_the_eye() {
  return {down_cos * side_sin, down_sin, down_cos * side_cos};
}

/// Follows a line from a place outside and says whether it enters the box.
bool meets(const Box& box, Vec3 from, Vec3 way) {
  const Vec3 start = scenes::to_axes(box, from - box.center), along = scenes::to_axes(box, way);
  double enter = 0, leave = INFINITY;
  const auto cut = [&](double at, double speed, double half) {
    if (speed == 0) {
      if (std::abs(at) > half) leave = -INFINITY;
      return;
    }
    const double one = (-half - at) / speed, other = (half - at) / speed;
    enter = std::max(enter, std::min(one, other));
    leave = std::min(leave, std::max(one, other));
  };
  cut(start.x, along.x, box.half_size.x);
  cut(start.y, along.y, box.half_size.y);
  cut(start.z, along.z, box.half_size.z);
  return enter < leave;
}

}  // namespace

Seen seen(Vec3 at) {
  const double right = side_cos * at.x - side_sin * at.z, away = side_sin * at.x + side_cos * at.z;
  return {right, down_cos * at.y - down_sin * away, down_sin * at.y + down_cos * away};
}

double flatness_of_level() {
  return down_sin;
}

bool is_hidden(const Scene& scene, Vec3 at) {
  const Vec3 way = to_the_eye();
  const auto hides = [&](const GroundCapsule& each) {
    // Beyond this way nothing of the capsule is left.
    const double far = norm(each.a - at) + norm(each.b - at) + each.radius;
    return scenes::distance_of_lines(at, at + far * way, each.a, each.b) < each.radius;
  };
  return std::any_of(scene.boxes.begin(), scene.boxes.end(),
                     [&](const Box& box) { return meets(box, at, way); }) ||
         std::any_of(scene.ground_capsules.begin(), scene.ground_capsules.end(), hides);
}

}  // namespace plumb::tools
