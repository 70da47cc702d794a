#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "contact/relaxed/crowd.hpp"
#include "contact/spatial_hash.hpp"
#include "contact/surroundings.hpp"
#include "contact/touch.hpp"
#include "plumb/settings.hpp"

namespace plumb::detail {

/// Keeps the islands of a crowd apart, and out of the ground.
///
/// Pairs that may touch within a step are found once, by boxes around what shapes pass through. In every
/// substep those that are near become contacts: a contact keeps the gap between two places open along one
/// normal, and holds them against sliding within Coulomb's cone. A visit sets its push to what its two places
/// alone ask for. All masses are points, so that a push moves a place alike in all directions, and the three
/// parts of a push need no matrix.
template <class T>
class CrowdContacts {
 public:
  explicit CrowdContacts(const ContactSettings& settings) : settings_(settings) {}

  /// Finds which shapes may touch within dt (s). `recovery_rate` (1/s) is the share of an overlap that is
  /// taken back.
  void find(std::span<LinkageState* const> cluster, const Crowd<T>& crowd, const Surroundings& surroundings,
            double dt, double recovery_rate);
  /// Returns whether any may touch at all.
  bool any_near() const { return !pairs_.empty() || !on_planes_.empty() || !on_boxes_.empty(); }

  /// Makes contacts of those that may touch within a substep of h (s), once displacements are predicted, and
  /// starts from their last pushes. Returns false if an island woke because something is about to push it.
  bool begin(std::span<LinkageState* const> cluster, Crowd<T>& crowd, const Surroundings& surroundings,
             double h);
  /// Visits all contacts once. Returns the largest change of a place, m.
  double sweep(Crowd<T>& crowd);
  /// Lets velocities bounce, once they are known.
  void bounce(Crowd<T>& crowd);
  /// Ends a substep: keeps pushes for the next one, and adds up their impulses where pulls count.
  void end(std::span<LinkageState* const> cluster, const Crowd<T>& crowd, double h);

  bool is_empty() const { return contacts_.empty(); }
  std::size_t count_pushes() const;

 private:
  using Term = typename Crowd<T>::Term;
  static constexpr std::uint32_t none = 0xffffffff;

  struct TermRange {
    std::uint32_t first = 0, end = 0;
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
  /// These do not change while contacts of a substep of h (s) are found.
  struct Substep {
    std::span<LinkageState* const> cluster;
    Crowd<T>& crowd;
    double h;
  };
  struct Side {
    std::uint32_t island = none, shape = 0;
    const Combination* at = nullptr;
    const Surface* surface = nullptr;
  };
  struct Contact {
    TermRange terms;
    std::uint32_t island[2], shape[2];
    std::uint64_t key = 0;
    Vec3 normal{};
    double gap = 0;       ///< m, what may be lost
    double friction = 0;  ///< Coulomb's coefficient
    double bounce = 0;    ///< m/s, what it leaves with
    double over = 0;      ///< kg, what changes its places by a metre
    double push = 0;      ///< kg m
    Vec3 across{};        ///< kg m, against sliding
    double kick = 0;      ///< kg m/s, of a bounce
  };

  TermRange add_terms(std::span<LinkageState* const> cluster, const Crowd<T>& crowd, std::uint32_t island,
                      const Combination& sum, std::vector<Term>& to) const;
  std::span<const Term> terms_of(TermRange range) const {
    return std::span(terms_).subspan(range.first, range.end - range.first);
  }
  std::span<const Term> ends_of(TermRange range) const {
    return std::span(ends_).subspan(range.first, range.end - range.first);
  }
  void find_pairs();
  void find_on_ground(const Crowd<T>& crowd, const Surroundings& surroundings);
  void add(const Substep& in, const Side& one, const Side& other, const Touch& touch, std::uint64_t key);
  void touch_planes(const Substep& in, std::span<const Plane> planes);
  void touch_boxes(const Substep& in, std::span<const Surroundings::Solid> boxes);
  void touch_pairs(const Substep& in);
  void wake(LinkageState& state);

  ContactSettings settings_;  ///< multiplied by their length scale
  double recovery_rate_ = 0;
  std::vector<Term> ends_, terms_;  ///< of shapes, and of contacts
  std::vector<Body> bodies_;
  std::vector<Ball> balls_;
  std::vector<Bounds> bounds_;  ///< of bodies within the step, from the crowd's origin
  std::vector<Bounds> ball_bounds_;
  std::vector<Pair> pairs_, on_planes_, on_boxes_;
  SpatialHash hash_;
  std::vector<Contact> contacts_;
  bool has_woken_ = false;
  std::vector<std::size_t> next_kept_;  ///< by island: where the next contact is likely to be found again
};

extern template class CrowdContacts<float>;
extern template class CrowdContacts<double>;

}  // namespace plumb::detail
