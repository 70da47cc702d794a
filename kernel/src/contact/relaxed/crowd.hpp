#pragma once

#include <cstdint>
#include <span>

#include "contact/linkage/linkage_state.hpp"
#include "contact/relaxed/places/crowd_places.hpp"
#include "contact/relaxed/visits/sweep_momentum.hpp"
#include "contact/shapes/bounds.hpp"
#include "plumb/layouts/aligned_buffer.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/settings.hpp"
#include "simd/relax/relax_kernels.hpp"

namespace plumb::detail {

/// Says how a crowd is relaxed.
struct CrowdRules {
  Gradient gradient = Gradient::new_;  ///< where nothing may touch; elsewhere it is new
  Weights weights = Weights::mass;     ///< by which rods share a correction
  double omega = 1;
  StopRule stop;
  /// So many sweeps of a step are shared by its substeps, which have momentum. If it is 0, each has those of
  /// `stop`, without.
  std::uint32_t step_sweeps = 0;
};

/// Holds the particles and rods of all islands of a cluster for vectors of rods.
///
/// CrowdPlaces says where they lie. A place is named by the number that is its x. Positions are counted from
/// the crowd's first particle, so that a float is exact far away from the origin, too.
template <class T>
class Crowd {
 public:
  /// A place is a weighted sum of particles, with what a push of one moves each by.
  struct Term {
    std::uint32_t at;     ///< the particle's place
    double weight, move;  ///< without dimension; 1/kg
  };

  explicit Crowd(const simd::Kernels<T>& kernels = simd::kernels<T>(Isa::scalar))
      : all_kernels_(&kernels), kernels_(&kernels.crowds) {}

  /// Takes in where the islands of a cluster are and how they move.
  void gather(std::span<LinkageState* const> cluster, const CrowdRules& rules);
  /// Returns whether some rod has changed its length.
  bool has_changed_lengths() const { return changes_lengths_; }
  /// Makes rods that have changed their length as long as RodLengths say now.
  void follow_lengths();
  /// Lays out everything anew when it gathers next.
  void forget() { is_stale_ = true; }
  /// Writes back where an island is and how it moves.
  void scatter(LinkageState& state, std::uint32_t island) const;

  /// Takes in how an island moves.
  void gather_velocities(const LinkageState& state, std::uint32_t island);

  /// Begins a substep of h (s): moves every particle as if nothing held it, with the gradient's kick.
  void predict(double h, Gradient gradient);
  /// Finds directions and violations of all rods where they are. Forgets what sweeps did if that `counts`.
  void prepare(const simd::AccessKernels<T>& kernels, bool counts);
  /// Lets rods keep some of what they are found off their lengths in a substep of h (s), see Leftovers. A
  /// crowd that is prepared again keeps nothing.
  void keep_violations(double h);
  /// Returns the largest |C|/L² that is kept.
  double most_kept() const { return most_kept_; }
  /// Notes what is kept, as the substep ends.
  void end_keeping(std::span<LinkageState* const> cluster, double h) const;
  /// Sweeps once over all rods. Adds up what it does if `counts`.
  void sweep(const simd::AccessKernels<T>& kernels, Gradient gradient, bool counts);
  /// Returns the largest violation of a rod, |C|/L².
  T violation(const simd::AccessKernels<T>& kernels);
  /// Returns the largest violation of a rod where particles are, before what moves them in a substep, |C|/L².
  double violation_of_positions() const;
  /// Ends a substep: moves particles and finds their velocities.
  void advance(double h, Gradient gradient);
  /// Returns the kinetic energy (J) of velocities, or of displacements in h (s).
  double kinetic() const { return kinetic(v_.data()); }
  double kinetic_of_moves(double h) const { return kinetic(p_.data()) / (h * h); }
  /// Multiplies what velocities differ from one (m/s) by a share.
  void slow(double share, Vec3 about);
  /// The velocity (m/s) that all would have together, and its energy, J. It is zero if something is fixed.
  struct CommonMotion {
    Vec3 velocity{};
    double energy = 0;
  };
  CommonMotion common_motion() const;
  /// Returns whether all sums of a number of places and that of velocities are finite.
  bool is_finite() const;
  /// Puts an island back to where the substep began, at rest. Returns whether it was not finite.
  bool stop_if_broken(LinkageState& state, std::uint32_t island);
  /// Adds the impulses with which rods pulled in a substep of h (s).
  void count_pulls(double h, Gradient gradient, std::span<LinkageState* const> cluster) const;

  /// Returns how far (m) the particle is displaced that is displaced most.
  double most_moved() const;
  /// Lists places of particles, ascending, that are displaced by more than `least` (m) and start in a box
  /// from the crowd's origin. The list lies in `room`.
  std::span<const std::uint32_t> list_fast(const Bounds& box, double least, Array<std::uint32_t>& room) const;
  /// Counts how often particles were laid out. What refers to places is good as long as it is the same.
  std::uint32_t layout() const { return layout_; }
  /// @{
  /// Numbers of all particles (m), and where they lie. What is no place of a particle is 0.
  const T* positions() const { return x_.data(); }
  T* displacements() { return p_.data(); }
  const T* displacements() const { return p_.data(); }
  const CrowdPlaces& places() const { return places_; }
  SweptNumbers<T> swept() { return {p_.data(), places_.numbers(), 0, 1}; }
  /// Names what sweeps that count add up.
  SweptNumbers<T> counted() { return {moved_.data(), places_.rods().size() * simd::moved_fields, 0, 1}; }
  /// @}

  std::uint32_t rods() const { return places_.count_rods(); }
  std::size_t islands() const { return laid_out_.size(); }
  /// Returns whether the rods of some island that moves go round in loops.
  bool has_loops() const { return has_loops_; }
  /// Appends the terms of a sum of an island's particles. Returns what a push of one on it moves it by, 1/kg.
  double add_terms(const Linkage& linkage, std::uint32_t island, Terms sum, double sign,
                   Array<Term>& to) const;
  /// Returns a term of such a sum.
  Term term(const Linkage& linkage, std::uint32_t island, const Combination::Term& of) const {
    const double inverse = of.particle < linkage.movable() ? inverse_mass(island, of.particle) : 0;
    return {number_of(island, of.particle), of.weight, of.weight * inverse};
  }
  double inverse_mass(std::uint32_t island, std::uint32_t particle) const {
    return inverse_mass_[places_.first(island) + particle];
  }

  /// Returns a particle's place, and where the particle is, from the crowd's origin.
  std::uint32_t number_of(std::uint32_t island, std::uint32_t particle) const {
    return places_.at(places_.first(island) + particle);
  }
  Vec3 position_of(std::uint32_t island, std::uint32_t particle) const {
    return position(number_of(island, particle));
  }
  /// Adds an impulse's shares of an island's fixed particles.
  void push_fixed(std::span<const Term> terms, std::uint32_t island, Vec3 impulse, LinkagePulls& pulls) const;

  /// Returns a sum over positions (m), from the crowd's origin if the weights add up to 1.
  Vec3 position(std::span<const Term> terms) const { return sum(terms, x_.data()); }
  Vec3 origin() const { return origin_; }
  bool is_moving(std::uint32_t island) const { return moves_[island] != 0; }
  /// Returns a sum over displacements (m) or velocities (m/s).
  Vec3 moved(std::span<const Term> terms) const { return sum(terms, p_.data()); }
  /// Returns where the particle at a place is, from the crowd's origin, and its displacement (m).
  Vec3 position(std::uint32_t number) const { return at(x_.data(), number); }
  Vec3 moved(std::uint32_t number) const { return at(p_.data(), number); }
  Vec3 velocity(std::span<const Term> terms) const { return sum(terms, v_.data()); }
  Vec3 velocity(std::uint32_t number) const { return at(v_.data(), number); }
  /// Pushes displacements by `push` (kg m), or velocities by that in kg m/s.
  void push(std::span<const Term> terms, Vec3 by) { push(terms, by, p_.data()); }
  void push(std::uint32_t number, Vec3 by) { put(p_.data(), number, at(p_.data(), number) + by); }
  void push_velocity(std::span<const Term> terms, Vec3 by) { push(terms, by, v_.data()); }
  void push_velocity(std::uint32_t number, Vec3 by) { put(v_.data(), number, at(v_.data(), number) + by); }

 private:
  static constexpr std::uint32_t none = CrowdPlaces::none, lanes = simd::logical_width<T>;

  Vec3 at(const T* data, std::uint32_t i) const {
    return {data[i], data[i + stride_], data[i + 2 * std::size_t{stride_}]};
  }
  void put(T* data, std::uint32_t i, Vec3 v) const {
    data[i] = static_cast<T>(v.x);
    data[i + stride_] = static_cast<T>(v.y);
    data[i + 2 * std::size_t{stride_}] = static_cast<T>(v.z);
  }
  Vec3 sum(std::span<const Term> terms, const T* data) const {
    Vec3 out;
    for (const Term& term : terms) out += term.weight * at(data, term.at);
    return out;
  }
  void push(std::span<const Term> terms, Vec3 by, T* data) const {
    for (const Term& term : terms) put(data, term.at, at(data, term.at) + term.move * by);
  }
  double kinetic(const T* data) const {
    return 0.5 * kernels_->weigh_squares(mass_.data(), data, places_.numbers());
  }
  void lay_out(std::span<LinkageState* const> cluster, const CrowdRules& rules);
  double length2(const CrowdPlaces::Rod& rod) const;  ///< m²
  /// Shares corrections between the ends of rods, which are as long as RodLengths say now.
  void weigh_rods(const CrowdRules& rules);
  void note_changed();
  bool have_others_changed() const;
  void find_uniform();
  void restore_lengths();
  /// Returns a field of a rod's weights.
  T& weight(std::size_t lane, std::size_t field) {
    return weight_[(lane / lanes * simd::weight_fields + field) * lanes + lane % lanes];
  }
  simd::BlockView<T> view();
  std::span<const simd::Range> ranges() const { return kept_.empty() ? ranges_ : uneven_; }

  const simd::Kernels<T>* all_kernels_;
  const simd::CrowdKernels<T>* kernels_;  ///< as particles are laid out
  Array<const LinkageState*> laid_out_;   ///< the islands that rods were laid out for
  bool is_stale_ = false;                 ///< an island was stopped since
  bool changes_lengths_ = false;
  /// An island's rod that has changed its length.
  struct ChangedRod {
    std::uint32_t island, number;
    friend bool operator==(const ChangedRod&, const ChangedRod&) = default;
  };
  Array<ChangedRod> changed_;           ///< when rods were weighed
  Array<std::uint32_t> changed_lanes_;  ///< theirs, in order
  Array<std::uint8_t> moves_;           ///< by island: it is awake and not frozen
  CrowdPlaces places_;
  std::uint32_t stride_ = 1;      ///< of components
  Array<double> inverse_mass_;    ///< 1/kg, by particle; 0 for what does not move
  Array<double> mass_;            ///< kg, by number; 0 for what does not move
  Array<std::uint32_t> anchors_;  ///< places of what is fixed
  Array<Vec3> carried_;           ///< m/s, how fast each of them is carried
  std::uint32_t layout_ = 0;
  Vec3 origin_;
  bool has_loops_ = false;
  layouts::AlignedBuffer<T> x_, p_, v_, a_;  ///< in m, m, m/s and m/s²
  layouts::AlignedBuffer<T> rod_, weight_, moved_;
  Array<double> mass_of_move_;  ///< kg, by lane: makes impulses of moves
  Array<simd::Range> ranges_;   ///< of rods, colour after colour
  Array<simd::Range> uneven_;   ///< likewise, where lengths are not restored
  Array<T> kept_;               ///< m², by lane, in this substep; none if nothing is kept
  double most_kept_ = 0;
  T uniform_length2_ = 1, uniform_share_ = 0, uniform_inverse_ = 1;
};

extern template class Crowd<float>;
extern template class Crowd<double>;

}  // namespace plumb::detail
