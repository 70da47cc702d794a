#pragma once

#include <cstdint>

#include "plumb/layouts/memory.hpp"
#include "plumb/scene.hpp"

namespace plumb::detail {

/// Says how the bodies of an island hang together: every body once, those that carry others first.
struct BodyTree {
  static constexpr std::uint32_t none = 0xffffffff;

  struct Hung {
    std::uint32_t body;
    std::uint32_t parent;  ///< its place in `hung`, or none for the ground and for bodies that float
    bool floats;           ///< it hangs from nothing
    bool is_hinge;         ///< else its joint is a ball joint
    Vec3 joint;            ///< place of the joint, or of the centre of a body that floats, in m
    Vec3 axis;             ///< unit axis of a hinge
  };
  Array<Hung> hung;
  Array<std::uint32_t> owner;  ///< by particle: the first body that has it, or none if it is fixed
  bool hangs = false;          ///< whether the first body hangs from `ground`
  Point ground{};              ///< a place of fixed particles
};

/// Finds it. Throws InputError, which names `particle`, if something else holds the island together.
BodyTree find_body_tree(const Scene& island, std::uint32_t particle);

}  // namespace plumb::detail
