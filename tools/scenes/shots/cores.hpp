#pragma once

#include <array>
#include <span>
#include <vector>

#include "plumb/scene.hpp"

/// These functions say how far apart the things of a shot are.
namespace plumb::scenes {

/// A core stands for a shape: all that is within a radius of the line between two places. What is not round
/// has the thickest one that it contains, and the thinnest one that contains it.
struct Core {
  Point a{}, b{};
  double inner = 0, outer = 0;  ///< Radii, in m.
};

/// Returns half the sides of a box that box_on_body() made a hull of, from the last to the first of its axes,
/// in m.
std::array<double, 3> half_sides(const Hull& box);

/// Appends the cores of a scene's capsules and hulls from the given ones on. Throws what point_on_body()
/// throws.
void append_cores(const Scene& scene, std::size_t first_capsule, std::size_t first_hull,
                  std::vector<Core>& cores);

/// Returns the distance of the lines from a0 to a1 and from b0 to b1, in m.
double distance_of_lines(Vec3 a0, Vec3 a1, Vec3 b0, Vec3 b1);

/// Returns the least distance in m between the surfaces around two sets of cores, the second one moved by
/// `way`. It is negative where they overlap.
double clearance(std::span<const Core> targets, std::span<const Core> missiles,
                 std::span<const Vec3> positions, Vec3 way);

/// Returns how deep two sets of cores are in each other at most, as a share of the thinner one's radius: 1
/// where a line of a thin one is on the surface of a thick one. It counts what they contain. Negative means
/// apart.
double share_inside(std::span<const Core> targets, std::span<const Core> missiles,
                    std::span<const Vec3> positions);

/// Returns whether a missile that flies on undisturbed, by `way` relative to the target, is anywhere more
/// than half of the thinner one's radius inside of it.
bool flies_into(std::span<const Core> targets, std::span<const Core> missiles,
                std::span<const Vec3> positions, Vec3 way);

}  // namespace plumb::scenes
