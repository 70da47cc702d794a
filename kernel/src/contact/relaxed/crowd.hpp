#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "contact/linkage/linkage_state.hpp"
#include "plumb/layouts/aligned_buffer.hpp"
#include "plumb/settings.hpp"
#include "simd/relax/relax_kernels.hpp"

namespace plumb::detail {

/// Says how a crowd is relaxed.
struct CrowdRules {
  Gradient gradient = Gradient::new_;  ///< where nothing may touch; elsewhere it is new
  Weights weights = Weights::mass;     ///< by which rods share a correction
  double omega = 1;
  StopRule stop;
};

/// Holds the particles and rods of all islands of a cluster for vectors of rods.
///
/// A particle is a record of four numbers, the last of which is unused. Rods lie by colours, and those of one
/// colour share no movable particle. Positions are counted from the crowd's first particle, so that a float
/// is exact far away from the origin, too.
template <class T>
class Crowd {
 public:
  /// A place is a weighted sum of particles, with what a push of one moves each by.
  struct Term {
    std::uint32_t at;     ///< the particle's record, in numbers
    double weight, move;  ///< without dimension; 1/kg
  };

  /// Takes in where the islands of a cluster are and how they move.
  void gather(std::span<LinkageState* const> cluster, const CrowdRules& rules);
  /// Lays out everything anew when it gathers next.
  void forget() { is_stale_ = true; }
  /// Writes back where an island is and how it moves.
  void scatter(LinkageState& state, std::uint32_t island) const;

  /// Takes in how an island moves.
  void gather_velocities(const LinkageState& state, std::uint32_t island);

  /// Begins a substep of h (s): moves every particle as if nothing held it, with the gradient's kick.
  void predict(double h, Gradient gradient);
  /// Finds directions and violations of all rods where they are.
  void prepare(const simd::AccessKernels<T>& kernels);
  /// Sweeps once over all rods. Adds up what it does if `counts`.
  void sweep(const simd::AccessKernels<T>& kernels, Gradient gradient, bool counts);
  /// Returns the largest violation of a rod, |C|/L².
  T violation(const simd::AccessKernels<T>& kernels);
  /// Returns the largest violation of a rod where the substep begins, |C|/L².
  double violation_before() const;
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
  /// Puts an island back to where the substep began, at rest. Returns whether it was not finite.
  bool stop_if_broken(LinkageState& state, std::uint32_t island);
  /// Adds the impulses with which rods pulled in a substep of h (s).
  void count_pulls(double h, Gradient gradient, std::span<LinkageState* const> cluster) const;

  /// Returns how far (m) the particle is displaced that is displaced most.
  double most_moved() const;
  /// Counts how often particles were laid out. What refers to records is good as long as it is the same.
  std::uint32_t layout() const { return layout_; }
  /// @{
  /// Records of all particles (m), and the one of padding.
  const T* positions() const { return x_.data(); }
  T* displacements() { return p_.data(); }
  const T* displacements() const { return p_.data(); }
  std::uint32_t padding() const { return record * particles_; }
  /// @}

  std::uint32_t rods() const { return rods_; }
  std::size_t islands() const { return laid_out_.size(); }
  /// Returns whether the rods of some island that moves go round in loops.
  bool has_loops() const { return has_loops_; }
  /// Appends the terms of a sum of an island's particles. Returns what a push of one on it moves it by, 1/kg.
  double add_terms(const Linkage& linkage, std::uint32_t island, const Combination& sum, double sign,
                   std::vector<Term>& to) const;
  double inverse_mass(std::uint32_t island, std::uint32_t particle) const {
    return inverse_mass_[first_[island] + particle];
  }

  /// Returns the number at which a particle's record starts, and where the particle is, from the crowd's
  /// origin.
  std::uint32_t number_of(std::uint32_t island, std::uint32_t particle) const {
    return record * (first_[island] + particle);
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
  /// Returns where the record that starts at a number is, from the crowd's origin, and its displacement (m).
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
  static constexpr std::uint32_t record = 4;
  static constexpr std::uint32_t none = 0xffffffff;

  static Vec3 at(const T* data, std::uint32_t i) { return {data[i], data[i + 1], data[i + 2]}; }
  static void put(T* data, std::uint32_t i, Vec3 v) {
    data[i] = static_cast<T>(v.x);
    data[i + 1] = static_cast<T>(v.y);
    data[i + 2] = static_cast<T>(v.z);
  }
  static Vec3 sum(std::span<const Term> terms, const T* data) {
    Vec3 out;
    for (const Term& term : terms) out += term.weight * at(data, term.at);
    return out;
  }
  static void push(std::span<const Term> terms, Vec3 by, T* data) {
    for (const Term& term : terms) put(data, term.at, at(data, term.at) + term.move * by);
  }
  double kinetic(const T* data) const;
  void lay_out(std::span<LinkageState* const> cluster, const CrowdRules& rules);
  void lay_out_rods(std::span<LinkageState* const> cluster, const CrowdRules& rules);
  simd::BlockView<T> view();

  std::vector<const LinkageState*> laid_out_;  ///< the islands that rods were laid out for
  bool is_stale_ = false;                      ///< an island was stopped since
  std::vector<std::uint8_t> moves_;            ///< by island: it is awake and not frozen
  std::vector<std::uint32_t> first_;           ///< by island: its first particle
  std::vector<double> inverse_mass_;           ///< 1/kg, by particle; 0 for what does not move
  std::vector<double> mass_;                   ///< kg, by number of records; 0 for what does not move
  std::uint32_t layout_ = 0;
  Vec3 origin_;
  std::uint32_t particles_ = 0, rods_ = 0;
  bool has_loops_ = false;
  layouts::AlignedBuffer<T> x_, p_, v_, a_;  ///< records, in m, m, m/s and m/s²
  layouts::AlignedBuffer<T> rod_, weight_, moved_;
  std::vector<std::uint32_t> address_a_, address_b_;
  std::vector<simd::Range> colors_;
  struct RodOf {
    std::uint32_t island = none, number = 0;
    double length2 = 0;  ///< m²
    double mass = 0;     ///< kg, which makes impulses of moves
  };
  std::vector<RodOf> rod_of_;  ///< by lane
};

extern template class Crowd<float>;
extern template class Crowd<double>;

}  // namespace plumb::detail
