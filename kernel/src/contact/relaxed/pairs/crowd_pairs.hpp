#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>

#include "contact/pair_order.hpp"
#include "contact/platforms/ground_now.hpp"
#include "contact/relaxed/crowd.hpp"
#include "contact/spatial_hash.hpp"
#include "plumb/layouts/memory.hpp"
#include "threads/team.hpp"

namespace plumb::detail {

/// Finds which shapes of a crowd may touch each other or the ground within a step, by boxes around what they
/// pass through.
template <class T>
class CrowdPairs {
 public:
  static constexpr std::uint32_t none = 0xffffffff;
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
    std::array<std::uint32_t, 2> at;  ///< places of its ends, if each is a particle; else none
    double radius;                    ///< m
    bool turns;                       ///< a solid with what touches it
    bool is_plain() const { return at[0] != none && at[1] != none; }
    /// Returns whether it is a line between two particles that turns with nothing.
    bool is_line() const { return is_plain() && at[0] != at[1] && !turns; }
  };
  struct Ball {
    std::uint32_t island, number;
    const Linkage::Ball* ball;
    TermRange center;
    std::uint32_t body;  ///< whose end it is; none of hulls
    bool is_plain;       ///< see CrowdEnds
  };
  /// This is a hull of an island, with the places of its particles.
  struct Hull {
    std::uint32_t island;
    const Linkage::HullShape* shape;
    std::array<std::uint32_t, 4> at;
  };
  struct Pair {
    std::uint32_t one, other;
    friend bool operator==(const Pair&, const Pair&) = default;
  };

  /// What is nearer than the margin may touch, and lines may lie deeper than their ends by the slop.
  explicit CrowdPairs(const ContactSettings& settings) : margin_(settings.margin), slop_(settings.slop) {}

  /// Finds what may touch within dt (s), with ground where it is as that time begins.
  void find(std::span<LinkageState* const> cluster, const Crowd<T>& crowd, const Surroundings& surroundings,
            const GroundNow& ground, double dt);
  /// Finds, for the time `left` (s) of the step, what lines may touch that go with their displacement of a
  /// substep where they were not looked for. Blows within the step have thrown them there.
  void follow(std::span<LinkageState* const> cluster, const Crowd<T>& crowd, const Surroundings& surroundings,
              const GroundNow& ground, double left, Team* team);
  /// Does so once a substep is solved, where others have pushed them. `ways` are boxes around what bodies,
  /// then hulls pass through in it, from the crowd's origin. Empty ones do not count.
  void follow(std::span<LinkageState* const> cluster, const Crowd<T>& crowd, const Surroundings& surroundings,
              const GroundNow& ground, std::span<const Bounds> ways);
  /// Returns whether nothing may touch but plain ends.
  bool are_all_plain() const {
    return pairs_.empty() && hull_pairs_.empty() && on_planes_.empty() && on_boxes_.empty() &&
           on_segments_.empty() && on_ground_.empty() && ends_on_ground_.empty() && hulls_on_ground_.empty();
  }

  std::span<const Body> bodies() const { return bodies_; }
  std::span<const Ball> balls() const { return balls_; }
  std::span<const Hull> hulls() const { return hulls_; }
  /// Returns the hull of an island with this number among its shapes, or nothing. Hulls are ordered by both.
  const Hull* hull_of(std::uint32_t island, std::uint32_t shape) const {
    const std::pair name{island, shape};
    const auto name_of = [](const Hull& hull) { return std::pair{hull.island, hull.shape->number}; };
    const auto at =
        std::lower_bound(hulls_.begin(), hulls_.end(), name,
                         [&](const Hull& hull, const auto& than) { return name_of(hull) < than; });
    return at != hulls_.end() && name_of(*at) == name ? &*at : nullptr;
  }
  /// Names two bodies.
  std::span<const Pair> pairs() const { return pairs_; }
  /// Names a hull and a body or another hull. Numbers of hulls follow those of bodies.
  std::span<const Pair> hull_pairs() const { return hull_pairs_; }
  /// Returns which hull has such a number, or nothing.
  std::optional<std::uint32_t> hull(std::uint32_t number) const {
    const auto lines = static_cast<std::uint32_t>(bodies_.size());
    return number < lines ? std::nullopt : std::optional(number - lines);
  }
  std::uint32_t island_of(std::uint32_t number) const {
    return number < bodies_.size() ? bodies_[number].island : hulls_[number - bodies_.size()].island;
  }
  /// These name a ball and a plane, or a body or a hull and a box on a platform or a shape on anchors.
  std::span<const Pair> on_planes() const { return on_planes_; }
  std::span<const Pair> on_boxes() const { return on_boxes_; }
  std::span<const Pair> on_segments() const { return on_segments_; }
  /// These name a body, a ball or a hull, and one of the shapes that ground has.
  std::span<const Pair> on_ground() const { return on_ground_; }
  std::span<const Pair> ends_on_ground() const { return ends_on_ground_; }
  std::span<const Pair> hulls_on_ground() const { return hulls_on_ground_; }
  /// Returns whether a body's ends alone keep it out of ground, unless it is fast. Such a pair is not listed.
  bool is_kept_out_by_ends(const Crowd<T>& crowd, const Body& body, const GroundShape& ground) const {
    const auto round = ground.capsule();
    return round && is_kept_out_by_ends(crowd, body, round->radius);
  }
  /// These name plain balls and plain ground: a plane by its number, others by theirs after all planes. They
  /// are sorted by ground. Those that the last follow() has added are listed on their own, too.
  std::span<const Pair> plain_ends() const { return plain_ends_; }
  std::span<const Pair> more_plain_ends() const { return more_plain_ends_; }
  /// Returns whether some shapes may touch each other.
  bool may_meet() const { return has_pairs_; }
  /// Returns a displacement (m) of particles up to which no line moves more than its radius times `share` and
  /// `margin` (m).
  double least_fast(double margin, double share) const {
    return (margin + share * least_radius_) / most_weight_;
  }
  /// Returns whether nothing leaves where it was looked for by find() as long as particles go no farther (m).
  bool holds_within(double way) const { return !follows_lines_ && way <= slack_; }
  /// Returns whether all bodies are lines of one radius between particles, and all particles their ends. If
  /// some particle is fast, so is a line.
  bool are_alike() const { return are_alike_; }
  /// Returns the lines between particles that end at one, ascending, and all other bodies.
  std::span<const std::uint32_t> lines_at(std::uint32_t particle) const {
    return std::span(lines_at_).subspan(first_line_[particle],
                                        first_line_[particle + 1] - first_line_[particle]);
  }
  std::span<const std::uint32_t> other_lines() const { return other_lines_; }
  /// Returns how long (m) the longest line between particles is.
  double longest_line(const Crowd<T>& crowd) const;
  /// Returns the largest radius (m) of a body.
  double largest_radius() const { return largest_radius_; }
  std::span<const Term> terms_of(TermRange range) const {
    return std::span(ends_).subspan(range.first, range.end - range.first);
  }

 private:
  void find_shapes(std::span<LinkageState* const> cluster, const Crowd<T>& crowd,
                   const Surroundings& surroundings, double dt);
  void find_hulls(std::span<LinkageState* const> cluster, const Crowd<T>& crowd,
                  const Surroundings& surroundings, double dt);
  Bounds carried(const Crowd<T>& crowd, const Surroundings& surroundings, std::uint32_t island,
                 const Bounds& bounds, const Filter& filter) const;
  const Filter& filter_of(std::uint32_t number) const {
    return number < bodies_.size() ? bodies_[number].shape->filter
                                   : hulls_[number - bodies_.size()].shape->filter;
  }
  void list_shapes(std::span<LinkageState* const> cluster, const Crowd<T>& crowd);
  void compare_shapes(const Crowd<T>& crowd);
  void list_lines(const CrowdPlaces& places);
  void bound_particles(std::span<LinkageState* const> cluster, const Crowd<T>& crowd, double dt, double more);
  /// Returns the place of a ball that is plain.
  std::uint32_t place_of(const Ball& ball) const { return ends_[ball.center.first].at; }
  Bounds particle_bounds(std::uint32_t at) const;
  void include_particle(std::uint32_t at, const Bounds& bounds);
  bool are_in_bounds(const Crowd<T>& crowd) const;
  bool is_outrun(const Crowd<T>& crowd, std::uint32_t body) const;
  void find_outrun(const Crowd<T>& crowd, Team* team);
  Bounds reach_of(const Crowd<T>& crowd, TermRange place, double radius, double dt) const;
  Bounds reach_of(const Crowd<T>& crowd, const Surroundings& surroundings, const Body& body, double dt,
                  double more) const;
  void find_pairs(std::span<LinkageState* const> cluster);
  bool may_meet(std::span<LinkageState* const> cluster, std::uint32_t i, std::uint32_t j) const;
  void widen(std::uint32_t number, const Bounds& by);
  void find_more(std::span<LinkageState* const> cluster, const Crowd<T>& crowd,
                 const Surroundings& surroundings, const GroundNow& ground);
  void find_more_pairs(std::span<LinkageState* const> cluster);
  void find_on_moving(const Crowd<T>& crowd, const GroundNow& ground, double dt);
  bool is_kept_out_by_ends(const Crowd<T>& crowd, const Body& body, double radius) const;
  bool are_kept_out_by_ends(const Crowd<T>& crowd, const Surroundings& surroundings,
                            const GroundNow& ground) const;
  void find_more_plain_ends(const Crowd<T>& crowd, const Surroundings& surroundings, const GroundNow& ground);
  void follow_ends(std::span<LinkageState* const> cluster, const Crowd<T>& crowd,
                   const Surroundings& surroundings, const GroundNow& ground);
  void find_plain_ends(const Crowd<T>& crowd, const Surroundings& surroundings, const GroundNow& ground,
                       Array<Pair>& to) const;
  void find_on_ground(const Crowd<T>& crowd, const Surroundings& surroundings);
  void find_line_on_ground(const Crowd<T>& crowd, const Surroundings& surroundings, std::uint32_t body,
                           Array<Pair>& to);
  void find_end_on_ground(const Crowd<T>& crowd, const Surroundings& surroundings, std::uint32_t ball,
                          Array<Pair>& to);
  void find_hull_on_ground(const Crowd<T>& crowd, const Surroundings& surroundings, std::uint32_t number,
                           Array<Pair>& to);
  template <class Add>
  void find_on_ground(const Crowd<T>& crowd, const Surroundings& surroundings, const Bounds& around,
                      const Filter& filter, Add&& add);
  void merge(Array<Pair>& into, Array<Pair>& more);

  Array<Term> ends_;
  Array<Body> bodies_;
  Array<Ball> balls_;
  Array<Hull> hulls_;
  /// Of bodies, then hulls, and of balls, within the step and from the crowd's origin.
  Array<Bounds> bounds_, ball_bounds_;
  Array<Pair> pairs_, hull_pairs_, on_planes_, on_boxes_, on_segments_;
  Array<Pair> on_ground_, ends_on_ground_, hulls_on_ground_;
  Array<Pair> plain_ends_, more_plain_ends_;
  Array<std::uint32_t> first_line_, lines_at_, other_lines_;
  Array<const LinkageState*> listed_;  ///< the islands that shapes were listed for
  std::uint32_t layout_ = none;        ///< of the crowd, then
  bool are_lines_plain_ = false;       ///< all bodies are
  bool are_alike_ = false;
  double slack_ = -1;          ///< m, see holds_within()
  bool follows_lines_ = true;  ///< some may touch otherwise than by their ends
  Array<T> low_, high_;        ///< m, by numbers of the crowd: where particles may go
  std::uint32_t stride_ = 1;   ///< of their components
  double least_radius_ = 0, largest_radius_ = 0, most_weight_ = 1;
  Array<std::uint32_t> near_;
  SpatialHash hash_;               ///< of bounds_
  Array<std::uint32_t> seen_;      ///< by number in bounds_, for whom it was looked at last
  bool has_pairs_ = false;         ///< some shapes may touch each other, and hash_ has them
  double margin_;                  ///< m, nearer than which shapes may touch
  double slop_;                    ///< m
  double fastest_ = 0;             ///< m/s, of all that moves
  Array<double> thrown_;           ///< m, by island: how far elastics throw it within the step at most
  double left_ = 0;                ///< s, the time of the step that is looked ahead
  Array<std::uint32_t> outrun_;    ///< what has left its bounds, ascending
  Array<std::uint8_t> is_outrun_;  ///< by body
  Array<Pair> more_, more_of_hulls_, merged_;
  PairOrder<Pair> order_;
};

extern template class CrowdPairs<float>;
extern template class CrowdPairs<double>;

}  // namespace plumb::detail
