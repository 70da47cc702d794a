// The figure on particles that limbs share: a hinge is two particles on its axis, which both limbs have.
#include <algorithm>
#include <array>
#include <cmath>

#include "figure.hpp"
#include "plumb/joints.hpp"

namespace plumb::bench {
namespace {

/// m, between the two particles of a hinge, and how far a limb's further ones are from it.
constexpr double reach = 0.12;
/// Of six times the volume of a limb's four particles, over the longest edge cubed.
constexpr double least_volume = 0.03;

struct Hinge {
  std::uint32_t place, tip;
};

class SharedFigure {
 public:
  explicit SharedFigure(const std::vector<Limb>& limbs)
      : limbs_(limbs), motions_(motions_of(limbs)), own_(limbs.size()), hinges_(limbs.size()) {
    scene_.gravity = {};
    for (std::size_t i = 1; i < limbs.size(); ++i) add_hinge(i);
    for (std::size_t i = 0; i < limbs.size(); ++i) add_limb(i);
  }

  Scene scene() && { return std::move(scene_); }

 private:
  Vec3 at(std::uint32_t particle) const { return scene_.particles[particle].position; }

  std::uint32_t add_particle(std::size_t limb, Vec3 position) {
    const auto& [velocity, spin] = motions_[limb];
    scene_.particles.push_back(
        {.position = position, .velocity = velocity + cross(spin, position - limbs_[limb].body.center)});
    return static_cast<std::uint32_t>(scene_.particles.size() - 1);
  }

  /// Hinges at one place share its particle.
  void add_hinge(std::size_t i) {
    const auto parent = static_cast<std::size_t>(limbs_[i].parent);
    std::vector<std::uint32_t>& of_parent = own_[parent];
    const auto found = std::find_if(of_parent.begin(), of_parent.end(),
                                    [&](std::uint32_t k) { return norm(at(k) - limbs_[i].joint) < 1e-12; });
    const bool is_new = found == of_parent.end();
    const std::uint32_t place = is_new ? add_particle(parent, limbs_[i].joint) : *found;
    const std::uint32_t tip = add_particle(parent, limbs_[i].joint + reach * limbs_[i].axis);
    if (is_new) of_parent.push_back(place);
    of_parent.push_back(tip);
    own_[i] = {place, tip};
    hinges_[i] = {place, tip};
  }

  double volume(const std::array<std::uint32_t, 4>& p) const {
    double longest = 0;
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < i; ++j) longest = std::max(longest, norm(at(p[i]) - at(p[j])));
    return std::abs(turn(p)) / (longest * longest * longest);
  }
  double turn(const std::array<std::uint32_t, 4>& p) const {
    return dot(at(p[1]) - at(p[0]), cross(at(p[2]) - at(p[0]), at(p[3]) - at(p[0])));
  }

  /// Those four of a limb's particles that lie least in a plane; all limbs but the first keep their own
  /// hinge.
  std::array<std::uint32_t, 4> choose(std::size_t i) const {
    const std::vector<std::uint32_t>& own = own_[i];
    std::array<std::uint32_t, 4> best{};
    double most = -1;
    const std::size_t n = own.size();
    for (std::size_t a = 0; a < (i == 0 ? n : 1); ++a)
      for (std::size_t b = a + 1; b < (i == 0 ? n : 2); ++b)
        for (std::size_t c = b + 1; c < n; ++c)
          for (std::size_t d = c + 1; d < n; ++d) {
            const std::array<std::uint32_t, 4> four{own[a], own[b], own[c], own[d]};
            if (volume(four) <= most) continue;
            most = volume(four);
            best = four;
          }
    return best;
  }

  /// Of six particles around the limb's centre the one that lies least in line or in a plane with the others.
  std::uint32_t add_farther(std::size_t i) {
    std::vector<std::uint32_t>& own = own_[i];
    Vec3 best{};
    double most = -1;
    for (const Vec3 along : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}})
      for (const double by : {reach, -reach}) {
        const Vec3 position = limbs_[i].body.center + by * along;
        own.push_back(add_particle(i, position));
        const double width =
            own.size() < 4 ? norm(cross(limbs_[i].axis, position - at(own[0]))) : volume(choose(i));
        own.pop_back();
        scene_.particles.pop_back();
        if (width <= most) continue;
        most = width;
        best = position;
      }
    return add_particle(i, best);
  }

  void add_limb(std::size_t i) {
    std::vector<std::uint32_t>& own = own_[i];
    while (own.size() < 4 || volume(choose(i)) < least_volume) own.push_back(add_farther(i));
    const std::array<std::uint32_t, 4> four = choose(i);
    add_body(scene_, four, limbs_[i].body);
    std::vector<std::uint32_t> held(four.begin(), four.end());
    for (std::size_t child = i + 1; child < limbs_.size(); ++child)
      if (limbs_[child].parent == static_cast<std::int32_t>(i)) hold(held, hinges_[child]);
  }

  /// The particles of a child's hinge that the limb does not have hang on three rods each, one of which is
  /// the child's, between both.
  void hold(std::vector<std::uint32_t>& held, const Hinge& hinge) {
    const auto is_held = [&](std::uint32_t k) {
      return std::find(held.begin(), held.end(), k) != held.end();
    };
    for (const auto& [particle, partner] : {std::pair{hinge.place, hinge.tip}, {hinge.tip, hinge.place}}) {
      if (is_held(particle)) continue;
      std::array<std::uint32_t, 4> best{};
      double most = -1;
      for (std::size_t a = 0; a < held.size(); ++a)
        for (std::size_t b = a + 1; b < held.size(); ++b)
          for (std::size_t c = b + 1; c < held.size(); ++c) {
            const std::array<std::uint32_t, 4> four{particle, held[a], held[b], held[c]};
            const bool has_partner = std::find(four.begin(), four.end(), partner) != four.end();
            if ((is_held(partner) && !has_partner) || volume(four) <= most) continue;
            most = volume(four);
            best = four;
          }
      for (std::size_t k = 1; k < 4; ++k)
        if (best[k] != partner) scene_.rods.push_back({.a = best[k], .b = particle});
      held.push_back(particle);
    }
  }

  const std::vector<Limb>& limbs_;
  std::vector<Motion> motions_;
  Scene scene_;
  std::vector<std::vector<std::uint32_t>> own_;  ///< particles on a limb, its own hinge's first
  std::vector<Hinge> hinges_;
};

}  // namespace

Scene shared_scene_of(const std::vector<Limb>& limbs) {
  return SharedFigure(limbs).scene();
}

}  // namespace plumb::bench
