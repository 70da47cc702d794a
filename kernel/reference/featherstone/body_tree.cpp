#include "reference/featherstone/body_tree.hpp"

#include <algorithm>
#include <cmath>

#include "plumb/joints.hpp"
#include "scene/refuse.hpp"
#include "scene/validate_bodies.hpp"

namespace plumb::detail {
namespace {

/// Places and directions agree if they do so to this share.
constexpr double rounding = 1e-9;

class Finder {
 public:
  Finder(const Scene& island, std::uint32_t particle)
      : island_(island), particle_(particle), ground_(static_cast<std::uint32_t>(island.bodies.size())) {
    find_owners();
    for (const Pin& pin : island.pins)
      if (!are_one_place(pin.a, pin.b)) add_joint(side_of(pin.a), side_of(pin.b), pin.a, pin.b);
    for (const Alignment& alignment : island.alignments) add_to_hinge(alignment);
    require_massless_rods();
  }

  BodyTree find() {
    Array<bool> known(island_.bodies.size());
    std::size_t used = 0;
    const auto hang = [&](BodyTree::Hung root) {
      known[root.body] = true;
      out_.hung.push_back(root);
      for (auto at = out_.hung.size() - 1; at < out_.hung.size(); ++at)
        for (const Joint& joint : joints_) {
          const std::uint32_t body = out_.hung[at].body;
          if (joint.a != body && joint.b != body) continue;
          const std::uint32_t other = joint.a == body ? joint.b : joint.a;
          if (other == ground_ || known[other]) continue;
          known[other] = true;
          ++used;
          out_.hung.push_back(
              {other, static_cast<std::uint32_t>(at), false, joint.is_hinge(), joint.place, joint.axis});
        }
    };
    for (const Joint& joint : joints_) {
      if (joint.a != ground_ && joint.b != ground_) continue;
      if (out_.hangs) refuse_island("hangs from the ground in more than one place");
      out_.hangs = true;
      out_.ground = joint.a == ground_ ? joint.at_a : joint.at_b;
      ++used;
      hang({joint.a == ground_ ? joint.b : joint.a, BodyTree::none, false, joint.is_hinge(), joint.place,
            joint.axis});
    }
    for (std::uint32_t i = 0; i < known.size(); ++i)
      if (!known[i]) hang({i, BodyTree::none, true, false, island_.bodies[i].center, {}});
    if (used != joints_.size()) refuse_island("has joints that close loops");
    for (const Joint& joint : joints_)
      if (joint.alignments != 0 && joint.alignments != 2)
        refuse_island("has joints that are neither ball joints nor hinges");
    return std::move(out_);
  }

 private:
  struct Joint {
    std::uint32_t a, b;
    Point at_a, at_b;
    Vec3 place, axis{};
    int alignments = 0;
    std::uint32_t turns = 0;  ///< the body across whose directions the axis stays
    Vec3 across{};            ///< the first of these

    bool is_hinge() const { return alignments == 2; }
  };

  [[noreturn]] void refuse_island(const char* what) const {
    refuse(
        "particle ", particle_, ": its island ", what,
        ", which method featherstone cannot move; direct, multipliers and auto can, and relax where masses "
        "lie in particles");
  }

  void find_owners() {
    out_.owner.assign(island_.particles.size(), BodyTree::none);
    for (std::uint32_t i = 0; i < island_.bodies.size(); ++i)
      for (const std::uint32_t at : island_.bodies[i].particles) {
        const Point here = point_at(at);
        if (island_.particles[at].fixed)
          add_joint(ground_, i, here, here);
        else if (out_.owner[at] != BodyTree::none)
          add_joint(out_.owner[at], i, here, here);
        else
          out_.owner[at] = i;
      }
    for (std::size_t i = 0; i < out_.owner.size(); ++i)
      if (out_.owner[i] == BodyTree::none && !island_.particles[i].fixed)
        refuse_island("has bodies and joints, and particles or rods besides");
  }

  bool has(std::uint32_t body, std::uint32_t particle) const {
    const auto& of = island_.bodies[body].particles;
    return std::find(of.begin(), of.end(), particle) != of.end();
  }
  /// Returns the body that all particles of some places belong to, or the ground.
  template <class... Points>
  std::uint32_t side_of(const Points&... points) const {
    const auto all = [&](auto&& is_good) {
      const auto of_point = [&](const Point& point) {
        for (std::size_t i = 0; i < 4; ++i)
          if (point.weights[i] != 0 && !is_good(point.particles[i])) return false;
        return true;
      };
      return (of_point(points) && ...);
    };
    if (all([&](std::uint32_t i) { return island_.particles[i].fixed; })) return ground_;
    for (std::uint32_t body = 0; body < island_.bodies.size(); ++body)
      if (all([&](std::uint32_t i) { return has(body, i); })) return body;
    refuse_island("has joints at places that belong to no single body");
  }

  void add_joint(std::uint32_t a, std::uint32_t b, const Point& at_a, const Point& at_b) {
    const Vec3 place = position_of(island_, at_a), apart = position_of(island_, at_b) - place;
    if (norm(apart) > rounding * bounding_diagonal(island_)) refuse_island("has joints that start apart");
    joints_.push_back({.a = a, .b = b, .at_a = at_a, .at_b = at_b, .place = place});
  }

  Vec3 along(const Direction& direction) const {
    const Vec3 way = position_of(island_, direction.to) - position_of(island_, direction.from);
    return norm(way) > 0 ? (1 / norm(way)) * way : way;
  }

  /// Two alignments that keep an axis of one body at right angles to two directions of the other make a hinge
  /// of their ball joint.
  void add_to_hinge(const Alignment& alignment) {
    const std::uint32_t a = side_of(alignment.u.from, alignment.u.to),
                        b = side_of(alignment.v.from, alignment.v.to);
    const Vec3 axis = along(alignment.u), across = along(alignment.v);
    for (Joint& joint : joints_) {
      if (!((joint.a == a && joint.b == b) || (joint.a == b && joint.b == a))) continue;
      const bool is_first = joint.alignments++ == 0;
      const bool agrees = is_first || (joint.turns == b && norm(cross(joint.axis, axis)) <= rounding &&
                                       norm(cross(joint.across, across)) > 1e-3);
      if (!agrees || !(std::abs(dot(axis, across)) <= rounding)) break;
      joint.axis = axis;
      joint.across = across;
      joint.turns = b;
      return;
    }
    refuse_island("has alignments that make no hinge");
  }

  void require_massless_rods() const {
    for (const Rod& rod : island_.rods) {
      bool is_within = false;
      for (std::uint32_t i = 0; i < island_.bodies.size(); ++i)
        is_within = is_within || (has(i, rod.a) && has(i, rod.b));
      if (!is_within || rod.mass != 0) refuse_island("has rods with mass or between bodies");
    }
  }

  const Scene& island_;
  std::uint32_t particle_, ground_;
  Array<Joint> joints_;
  BodyTree out_;
};

}  // namespace

BodyTree find_body_tree(const Scene& island, std::uint32_t particle) {
  return Finder(island, particle).find();
}

}  // namespace plumb::detail
