#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "contact/platforms/ground_now.hpp"
#include "contact/relaxed/crowd.hpp"
#include "contact/spatial_hash.hpp"

namespace plumb::detail {

/// Finds which shapes of a crowd may touch each other or the ground within a step, by boxes around what they
/// pass through.
template <class T>
class CrowdPairs {
 public:
  using Term = typename Crowd<T>::Term;
  struct TermRange {
    std::uint32_t first = 0, end = 0;
    friend bool operator==(const TermRange&, const TermRange&) = default;
  };
  /// This is a shape of an island. Its ends are sums of particles.
  struct Body {
    std::uint32_t island, number;
    const Linkage::Shape* shape;
    TermRange a, b;
  };
  struct Ball {
    std::uint32_t island, number;
    const Linkage::Ball* ball;
    TermRange center;
  };
  struct Pair {
    std::uint32_t one, other;
  };

  /// Finds what may touch within dt (s), with ground where it is as that time begins. What is nearer than
  /// `margin` (m) may touch.
  void find(std::span<LinkageState* const> cluster, const Crowd<T>& crowd, const Surroundings& surroundings,
            const GroundNow& ground, double dt, double margin);
  bool are_empty() const {
    return pairs_.empty() && on_planes_.empty() && on_boxes_.empty() && on_segments_.empty();
  }

  std::span<const Body> bodies() const { return bodies_; }
  std::span<const Ball> balls() const { return balls_; }
  /// Names two bodies.
  std::span<const Pair> pairs() const { return pairs_; }
  /// These name a ball and a plane, or a body and a box or a shape on anchors.
  std::span<const Pair> on_planes() const { return on_planes_; }
  std::span<const Pair> on_boxes() const { return on_boxes_; }
  std::span<const Pair> on_segments() const { return on_segments_; }
  std::span<const Term> terms_of(TermRange range) const {
    return std::span(ends_).subspan(range.first, range.end - range.first);
  }

 private:
  void find_shapes(std::span<LinkageState* const> cluster, const Crowd<T>& crowd,
                   const Surroundings& surroundings, double dt, double margin);
  void find_pairs();
  void find_on_ground(const Crowd<T>& crowd, const GroundNow& ground, double dt);

  std::vector<Term> ends_;
  std::vector<Body> bodies_;
  std::vector<Ball> balls_;
  std::vector<Bounds> bounds_, ball_bounds_;  ///< within the step, from the crowd's origin
  std::vector<Pair> pairs_, on_planes_, on_boxes_, on_segments_;
  SpatialHash hash_;
};

extern template class CrowdPairs<float>;
extern template class CrowdPairs<double>;

}  // namespace plumb::detail
