#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "contact/ground/ground_search.hpp"
#include "contact/relaxed/bodies/rigid_contacts.hpp"
#include "contact/relaxed/crowd_ends.hpp"
#include "contact/relaxed/kept_table.hpp"
#include "contact/relaxed/lines/crowd_lines.hpp"
#include "contact/relaxed/pairs/crowd_pairs.hpp"
#include "contact/relaxed/places/middle.hpp"
#include "contact/relaxed/places/placed_line.hpp"
#include "contact/relaxed/visits/contact_vectors.hpp"
#include "contact/shapes/passing.hpp"
#include "contact/shapes/touch.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/settings.hpp"
#include "scene/barycentric.hpp"
#include "threads/team.hpp"

namespace plumb::detail {

/// Keeps the islands of a crowd apart, and out of the ground.
///
/// Pairs that may touch within a step are found once. In every substep those that are near become contacts: a
/// contact keeps the gap between two places open along one normal, and holds surfaces against sliding within
/// Coulomb's cone. A visit sets its push to what its places alone ask for. All masses are points, so that a
/// push moves a place alike in all directions, and the three parts of a push need no matrix.
///
/// Most contacts are those of ends with plain ground and of plain lines with each other, which CrowdEnds and
/// CrowdLines keep. All others stand here.
///
/// A team may share the work. What it finds comes in batches, which follow each other as one list would, so
/// that the bits are the same however many there are.
///
/// Friction acts on places of bodies where they are touched, which turns them, and else on the middles of
/// shapes. What resists rolling and spinning turns bodies against what they touch.
template <class T>
class CrowdContacts {
 public:
  CrowdContacts(const ContactSettings& settings, const simd::Kernels<T>& kernels)
      : settings_(settings),
        near_(settings),
        ends_(settings, kernels),
        lines_(settings, kernels),
        vectors_(kernels) {}

  /// Finds which shapes may touch within dt (s), with ground where it is as that time begins. `recovery_rate`
  /// (1/s) is the share of an overlap that is taken back.
  void find(std::span<LinkageState* const> cluster, const Crowd<T>& crowd, const Surroundings& surroundings,
            const GroundNow& ground, double dt, double recovery_rate);
  /// Lets bodies that are touched begin a substep as rigid bodies.
  void begin_rigidly(Crowd<T>& crowd) const { rigid_.begin_rigidly(crowd); }
  /// Finds for the time `left` (s) of the step what those may touch that go where they were not looked for,
  /// once displacements are predicted.
  void follow(std::span<LinkageState* const> cluster, const Crowd<T>& crowd, const Surroundings& surroundings,
              const GroundNow& ground, double left, Team* team) {
    moved_ = crowd.most_moved();
    if (near_.holds_within(way_ + moved_)) return;
    near_.follow(cluster, crowd, surroundings, ground, left, team);
    ends_.add(cluster, crowd, near_, surroundings, ground, near_.more_plain_ends());
  }

  /// Returns into how many parts a substep of h (s) is to be cut so that no hull that may touch moves far in
  /// one. A blow would crush its rods flat, and they might come back the other way round.
  std::uint32_t cuts(const Crowd<T>& crowd, double h) const;

  /// Wakes the heaps of sleepers that are pushed, or about to be. Returns whether there are any.
  bool wake(std::span<LinkageState* const> cluster);
  /// Makes contacts of those that may touch within a substep of h (s), once displacements are predicted, and
  /// starts from their last pushes. Returns false if an island woke because something is about to push it.
  /// A team helps, if there is one.
  bool begin(std::span<LinkageState* const> cluster, Crowd<T>& crowd, const Surroundings& surroundings,
             const GroundNow& ground, double h, Team* team);
  /// Makes contacts of what goes into ground, or through others, where it was not expected, because others
  /// push it. Returns whether there are any.
  bool find_missed(std::span<LinkageState* const> cluster, Crowd<T>& crowd, const Surroundings& surroundings,
                   const GroundNow& ground, double h, Team* team);
  /// Visits all contacts once, after begin() or find_missed().
  void sweep(Crowd<T>& crowd, Team* team);
  /// Does so, and returns the largest change of a place, m.
  double measured_sweep(Crowd<T>& crowd, Team* team);
  /// Names all pushes that sweeps change. Returns false if some are visited alone, which are not among them.
  bool list_swept(Array<SweptNumbers<T>>& to);
  /// Ends sweeps, after which pushes are known.
  void end_sweeps() { vectors_.write_back(); }
  /// Pushes what sweeps have left deep in ground out of it, whatever else gives way, after end_sweeps().
  /// Returns whether the middle of something stays in there.
  bool leave_ground(Crowd<T>& crowd);
  /// Returns how deep (m) some contact goes into what it should stay out of, at most.
  double depth(const Crowd<T>& crowd) const;
  /// Lets velocities bounce, once they are known. Returns whether anything does.
  bool bounce(Crowd<T>& crowd);
  /// Ends a substep: keeps pushes for the next one, and adds up their impulses where pulls count.
  void end(std::span<LinkageState* const> cluster, const Crowd<T>& crowd, double h);
  /// Ends a step, before another find(): keeps those pushes that end() has left here.
  void keep(std::span<LinkageState* const> cluster, const Crowd<T>& crowd) const {
    ends_.keep(cluster, crowd);
    lines_.keep(cluster, near_);
  }

  /// Returns whether a capsule meets another one in the substep that it would pass.
  bool are_struck() const {
    return std::any_of(batches_.begin(), batches_.end(), [](const Batch& batch) { return batch.is_struck; });
  }
  /// Returns whether capsules move far in the substep for how thick they are.
  bool are_fast() const { return is_fast_; }
  /// Returns whether some islands push each other.
  bool hold_islands() const {
    return lines_.any_push() ||
           any_of([](const Contact& each) { return each.push > 0 && each.island[1] != none; });
  }
  /// Returns whether ground pushes something.
  bool push_ground() const {
    return ends_.any_push() ||
           any_of([](const Contact& each) { return each.push > 0 && each.island[1] == none; });
  }
  /// Returns whether a shape moves so far past a hull that it might be pushed out on the wrong side, after
  /// find_missed().
  bool outrun_hulls(const Crowd<T>& crowd);

  bool has_hulls() const { return !near_.hulls().empty(); }
  bool is_empty() const {
    return !ends_.any_touch() && !lines_.any_touch() && !any_of([](const Contact&) { return true; });
  }
  std::size_t count_pushes() const;

 private:
  using Term = typename Crowd<T>::Term;
  using TermRange = typename CrowdPairs<T>::TermRange;
  using Body = typename CrowdPairs<T>::Body;
  using Ball = typename CrowdPairs<T>::Ball;
  using Pair = typename CrowdPairs<T>::Pair;
  static constexpr std::uint32_t none = 0xffffffff;
  /// So many shapes of ground are looked at one by one.
  static constexpr std::size_t few_shapes = 4;

  using Hull = typename CrowdPairs<T>::Hull;
  using Vectors = Linkage::HullShape::Vectors;

  /// One side of a contact is on a shape's middle or, without an island, on the ground, whose number stands
  /// in `shape`.
  struct Side {
    std::uint32_t island = none, shape = 0;
    std::span<const Term> at{};
    const Surface* surface = nullptr;
    const GroundRate* rate = nullptr;  ///< of ground that moves
  };
  struct Contact {
    /// Sets what follows, and no zeros before that, as it would else be done for every contact.
    Contact() {}  // NOLINT(modernize-use-equals-default)

    TermRange terms{};  ///< of the middles of shapes
    Vec3 normal{};
    double gap = 0;       ///< m, what may be lost
    double width = 0;     ///< m, half of the first shape's
    double friction = 0;  ///< Coulomb's coefficient
    double over = 0;      ///< kg, what changes its places by a metre
    double push = 0;      ///< kg m
    Vec3 across{};        ///< kg m, against sliding
    std::uint64_t key = 0;
    std::uint32_t island[2] = {none, none}, shape[2] = {0, 0};
    std::uint32_t other_terms = 0;  ///< where those of the second shape begin
    std::uint32_t rare = none;      ///< what few contacts have
    std::uint32_t rigid = none;     ///< its number among those of rigid bodies
    bool in_vectors = false;
  };
  /// Few contacts have this: those that turn bodies, that are carried by ground or bounce, or are counted.
  struct Rare {
    bool slides_apart = false;  ///< friction holds other places
    TermRange sliding{};        ///< these, if so
    double over_sliding = 0;    ///< kg, what changes them by a metre
    std::uint32_t turning = none;
    Vec3 carried{};             ///< m, how far the ground goes
    double carried_at_end = 0;  ///< m/s, how fast it moves along the normal
    double approach = 0;        ///< m/s, how fast it is about to be hit
    double bounce = 0;          ///< m/s, what it leaves the surface with
    double kick = 0;            ///< kg m/s, of a bounce
  };
  /// This is a particle of a body that turns at half the sum of all gradient x motion.
  struct TurnTerm {
    std::uint32_t island, at;
    Vec3 gradient;  ///< 1/m
    double inverse_mass;
  };
  /// Resists that what touches turns against each other.
  struct Turning {
    std::uint32_t first, end;  ///< of its terms
    std::uint64_t key;
    double rolling, spinning;  ///< m, see Surface
    double over;               ///< kg m², what turns it by at least what is asked for
    Vec3 carried{};            ///< rad, by how much the ground turns
    Vec3 push{};               ///< kg m²
  };

  /// Contacts that one thread has found, with all that their numbers refer to.
  struct Batch {
    Array<Term> terms{};
    Array<Contact> contacts{};
    Array<Contact> left_out{};  ///< those that did not seem to come about
    Array<Rare> rares{};
    Array<TurnTerm> turn_terms{};
    Array<Turning> turnings{};
    Array<std::uint32_t> woken{};  ///< islands
    std::size_t next_kept = 0;     ///< where the next contact is likely to be kept
    bool is_struck = false;        ///< a capsule meets another one that it would pass
    void clear() {
      terms.clear();
      contacts.clear();
      left_out.clear();
      rares.clear();
      turn_terms.clear();
      turnings.clear();
      woken.clear();
      next_kept = 0;
      is_struck = false;
    }
    std::span<const Term> terms_of(TermRange range) const {
      return std::span(terms).subspan(range.first, range.end - range.first);
    }
    const Rare& rare_of(const Contact& contact) const {
      static constexpr Rare nothing{};
      return contact.rare == none ? nothing : rares[contact.rare];
    }
    /// Returns the places that friction holds.
    std::span<const Term> sliding_of(const Contact& contact) const {
      const Rare& rare = rare_of(contact);
      return terms_of(rare.slides_apart ? rare.sliding : contact.terms);
    }
  };
  /// These do not change while contacts of a substep of h (s) are found. What is found goes to a batch.
  struct Substep {
    std::span<LinkageState* const> cluster;
    Crowd<T>& crowd;
    const Surroundings& surroundings;
    const GroundNow& ground;
    double h;
    Batch& to;
    bool counts;  ///< somebody asks what touches
  };
  /// Says what of a list one of several threads works through.
  struct Share {
    std::uint32_t number = 0, count = 1;
    std::span<const Pair> of(std::span<const Pair> pairs) const {
      const auto size = static_cast<std::uint32_t>(pairs.size());
      const std::uint32_t first = Team::begin_of(size, number, count);
      return pairs.subspan(first, Team::begin_of(size, number + 1, count) - first);
    }
  };
  /// Names a contact by its batch and its number there.
  struct Place {
    std::uint32_t batch, number;
  };
  static const Linkage::Shape& shape_of(const Substep& in, const Side& side) {
    return in.cluster[side.island]->linkage->shape_of(side.shape);
  }
  static bool turns(const Substep& in, const Side& side) {
    return side.island != none && shape_of(in, side).turning == Linkage::Shape::Turning::body;
  }
  /// Returns the place on a body's middle at `t` from one end, 0, to the other, 1.
  Middle<T> middle_of(const Substep& in, const Body& body, double t) const;
  static Side side_of(const Body& body, const Middle<T>& at) {
    return {body.island, body.number, at.terms(), &body.shape->surface};
  }
  Side side_of(const Ball& ball) const {
    return {ball.island, ball.ball->shape, near_.terms_of(ball.center), &ball.ball->surface};
  }
  static Barycentric body_of(const Substep& in, const Side& side);
  /// Returns the side of a contact on one of the shapes that ground has.
  static Side ground_side(const Substep& in, std::uint32_t ground);
  void add(const Substep& in, const Side& one, const Side& other, const Touch& touch, std::uint64_t key);
  std::uint64_t key_of(const Substep& in, const Pair& pair, std::uint32_t which) const;
  void touch_shapes(const Substep& in, const Pair& pair);
  static bool is_counted(std::span<LinkageState* const> cluster);
  void add_ends(const Substep& in, const std::array<Side, 2>& sides, Contact& contact);
  void add_sliding(const Substep& in, const std::array<Side, 2>& sides, const Touch& touch, Rare& rare);
  void add_turning(const Substep& in, const std::array<Side, 2>& sides, const Contact& contact, Rare& rare);
  void start_from_kept(const Substep& in, Contact& contact);
  void touch_planes(const Substep& in, std::span<const Pair> pairs);
  void touch_moving(const Substep& in, std::uint32_t hull, const Convex& solid, const Side& other,
                    KeyKind kind, std::uint32_t ground);
  void touch_boxes(const Substep& in, std::span<const Pair> pairs);
  void touch_segments(const Substep& in, std::span<const Pair> pairs);
  void touch_lines_and_ground(const Substep& in, std::span<const Pair> pairs);
  void touch_ends_and_ground(const Substep& in, std::span<const Pair> pairs);
  void touch_hulls_and_ground(const Substep& in);
  void touch_hull_pairs(const Substep& in);
  template <class F>
  void for_ground_near(const Substep& in, const MovingSegment& moving, F&& f);
  void find_missed_bodies(const Substep& in);
  void find_missed_hulls(const Substep& in);
  void miss(const Substep& in, const Side& side, std::uint32_t ground, double width, const Touch& plane,
            double time);
  void place_hulls(const Crowd<T>& crowd);
  MovingSegment motion_of(const Crowd<T>& crowd, const Body& body) const;
  MovingHullShape hull_motion(const Crowd<T>& crowd, std::uint32_t hull);
  /// Returns a body, or after all bodies a hull.
  PlacedShape placed(const Crowd<T>& crowd, std::uint32_t number);
  void place_lines(const Crowd<T>& crowd, Team* team);
  void see_fast(const Crowd<T>& crowd, const Surroundings& surroundings, Team* team);
  bool is_fast(const Crowd<T>& crowd, const Body& body) const;
  void list_fast(const Crowd<T>& crowd, const Surroundings& surroundings);
  void touch_in_passing(const Substep& in);
  void place_ways(const Crowd<T>& crowd);
  PairSearch pair_search() const { return {settings_.margin, settings_.tolerance}; }
  bool is_fast(const Pair& pair) const;
  void touch_pair(const Substep& in, const Pair& pair, const Touch& touch, std::uint64_t key);
  void touch_pairs(const Substep& in, std::span<const Pair> pairs);
  void find_missed_pairs(const Substep& in, Team* team);
  void find_missed_on_planes(const Substep& in);
  /// Calls f(batch, contact) for all contacts, in their order.
  template <class F>
  void for_contacts(F&& f) {
    for (Batch& batch : batches_)
      for (Contact& contact : batch.contacts) f(batch, contact);
  }
  template <class F>
  void for_contacts(F&& f) const {
    for (const Batch& batch : batches_)
      for (const Contact& contact : batch.contacts) f(batch, contact);
  }
  /// Returns whether is(contact) is true of some contact.
  template <class Is>
  bool any_of(Is&& is) const {
    return std::any_of(batches_.begin(), batches_.end(), [&](const Batch& batch) {
      return std::any_of(batch.contacts.begin(), batch.contacts.end(), is);
    });
  }
  std::size_t count_contacts() const;
  void find_in_batches(std::span<LinkageState* const> cluster, Crowd<T>& crowd,
                       const Surroundings& surroundings, const GroundNow& ground, double h, Team* team);
  static Contact copied(const Batch& from, const Contact& contact, Batch& to);
  void lay_out(const Crowd<T>& crowd);
  std::uint32_t add_rigid(const Crowd<T>& crowd, const Batch& batch, const Contact& contact);
  void find_heaps(std::size_t islands);
  std::uint32_t heap_of(std::uint32_t island);
  template <class Visit>
  void for_heaps(Crowd<T>& crowd, Team* team, Visit&& visit);
  /// This is what a visit changes: pushes, kg m.
  struct Change {
    Vec3 along{}, across{};
    bool is_none() const { return along + across == Vec3{}; }
  };
  Change visit(Crowd<T>& crowd, Batch& batch, Contact& contact);
  static double size_of(const Change& change, const Batch& batch, const Contact& contact);
  void turn(Crowd<T>& crowd, const Batch& batch, const Turning& turning, Vec3 by) const;
  void resist(Crowd<T>& crowd, Batch& batch, const Contact& contact);
  double depth(const Crowd<T>& crowd, const Batch& batch, const Contact& contact) const;
  void count_impulses(std::span<LinkageState* const> cluster, const Crowd<T>& crowd, const Batch& batch,
                      const Contact& contact, double h) const;
  void count_touch(std::span<LinkageState* const> cluster, const Crowd<T>& crowd, const Batch& batch,
                   const Contact& contact, double h) const;

  ContactSettings settings_;  ///< multiplied by their length scale
  double recovery_rate_ = 0;
  CrowdPairs<T> near_;
  CrowdEnds<T> ends_;
  CrowdLines<T> lines_;
  ContactVectors<T> vectors_;
  RigidContacts<T> rigid_;
  Array<Place> alone_;  ///< what is not in vectors: in the order of contacts, but rigid bodies backwards
  Array<Place> rigid_places_;  ///< of those of rigid bodies, in order
  bool is_revisited_ = false;  ///< some push is not what vectors have
  PlacedHulls placed_hulls_;
  Array<PlacedLine> placed_lines_;    ///< by body
  Array<std::uint8_t> part_is_fast_;  ///< by thread: some line that it has placed is
  bool is_fast_ = false;              ///< some line is, or was in this substep
  bool may_be_fast_ = false;          ///< some may be where particles are now
  double moved_ = -1;                 ///< m, how far particles then go at most, if that is known
  double way_ = 0;                    ///< m, how far they went since find()
  double longest_ = -1;               ///< m, of lines when it was measured in the step, if it was
  bool meets_ = false;                ///< some may meet, and lines_ knows them
  Array<std::uint32_t> fast_places_;  ///< room for those of particles near ground
  Array<std::uint64_t> marks_;        ///< a bit for each line
  Array<std::uint32_t> fast_lines_;   ///< those that are, then, and may come to ground
  Array<Bounds> ways_;                ///< around what bodies, then hulls pass through, from there
  Array<std::uint32_t> near_ground_;
  KeptTable kept_;
  Array<Batch> batches_;
  // Heaps are islands that contacts outside of vectors join. They share nothing, so that each may have a
  // thread of its own.
  Array<std::uint32_t> heap_of_;      ///< by island: one of its heap, or itself
  Array<std::uint32_t> heap_ends_;    ///< where each heap ends in in_heaps_
  Array<std::uint32_t> heap_number_;  ///< by island that stands for a heap
  Array<Place> in_heaps_;             ///< heap by heap, in the order of contacts
  Array<double> changes_;             ///< m, by heap: the largest of a sweep
};

}  // namespace plumb::detail
