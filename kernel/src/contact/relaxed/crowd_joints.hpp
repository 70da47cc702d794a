#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "contact/relaxed/crowd.hpp"
#include "plumb/layouts/memory.hpp"

namespace plumb::detail {

/// Holds the joints of a crowd: ball joints, alignments, limits and friction of angles, and elastics. A visit
/// puts each right by itself, by masses.
///
/// Elastics pull as they do at the end of the substep, whatever the number of visits. What pulls along a
/// distance keeps its push as a vector and replaces it, since its direction turns.
template <class T>
class CrowdJoints {
 public:
  /// Takes in the joints of the islands that move.
  void gather(std::span<LinkageState* const> cluster, const Crowd<T>& crowd);
  bool are_empty() const { return balls_.empty() && dots_.empty() && distances_.empty() && sources_.empty(); }
  bool has_elastics() const { return has_elastics_; }

  /// Begins a substep of h (s), with all islands where their states are. `recovery_rate` (1/s) is the share
  /// of an angle beyond its limit that is taken back.
  void begin(std::span<LinkageState* const> cluster, const Crowd<T>& crowd, double h, double recovery_rate);
  /// Visits elastics that pull bodies. Returns whether some are stiff, so that it matters how bodies give
  /// way.
  ///
  /// These pulls are known as a substep begins, but for what gives way in it. So they move bodies as rigid
  /// ones before sweeps do: from a corner rods carry a pull on too slowly.
  bool pull_bodies(Crowd<T>& crowd);
  void sweep(Crowd<T>& crowd);
  /// Takes from velocities once what ball joints and alignments of some islands forbid, and counts its
  /// impulses. Returns the largest change, m/s.
  double sweep_velocities(std::span<LinkageState* const> cluster, std::span<const std::uint8_t> of,
                          Crowd<T>& crowd) const;
  /// Ends a substep of h (s): adds up impulses where pulls count, and breaks rods that pulled too much.
  /// Returns how many.
  std::uint32_t end(std::span<LinkageState* const> cluster, const Crowd<T>& crowd, double h);

 private:
  using Term = typename Crowd<T>::Term;
  struct TermRange {
    std::uint32_t first = 0, end = 0;
  };
  static constexpr std::uint32_t none = 0xffffffff;

  /// This is a particle of several sums, with its weights in them.
  struct SumsTerm {
    std::uint32_t at;
    double weight[3];
    double inverse_mass;
  };
  struct BallJoint {
    TermRange terms;
    std::uint32_t island, number;
    double over = 0;
    Vec3 apart{};  ///< m, as the substep begins
    Vec3 push{};   ///< kg m
  };
  struct Dot {
    TermRange terms;
    std::uint32_t island;
    double value;   ///< m²
    Vec3 u{}, v{};  ///< m, as the substep begins
  };
  struct Distance {
    TermRange terms;
    std::uint32_t island, number;  ///< of the elastic
    bool pulls_body;
    double moves = 0;   ///< 1/kg
    Vec3 apart{};       ///< m, as the substep begins
    double length = 0;  ///< m, likewise
    Vec3 push{};        ///< kg m
    double pull = 0;    ///< kg m, its size
  };
  /// Names what rows are made of: an angle's control, or an elastic that is no distance.
  struct Source {
    TermRange terms;
    std::uint32_t island, control, elastic;
    bool pulls_body = false;
  };
  /// A row keeps off + its change at 0, or `rest` + `stiff` times that change balances its push.
  struct Row {
    TermRange terms;
    std::uint32_t island, control, elastic;
    bool pulls_body;
    std::array<Vec3, 3> along{};  ///< by sum
    double moves = 0;
    double off = 0, stiff = 1, give = 0;
    double least = 0, most = 0;  ///< bounds on the push
    double push = 0;
  };

  TermRange add_sums(std::uint32_t island, const Linkage& linkage, const Crowd<T>& crowd,
                     std::span<const Combination> sums);
  void add_rows(const Source& source, LinkageState& state, double h, double recovery_rate);
  void mark_bodies(const Linkage& linkage);
  bool pulls_body(const Elastic& elastic) const {
    return std::any_of(elastic.touched.begin(), elastic.touched.end(),
                       [this](std::uint32_t particle) { return in_body_[particle] != 0; });
  }
  /// Returns by how much (kg) a pull of this substep grows with its length.
  double stiffness_of(const ElasticLaw& law) const { return h_ * h_ * law.stiffness + h_ * law.damping; }
  void visit(Crowd<T>& crowd, Distance& distance, const ElasticLaw& law) const;
  void visit(Crowd<T>& crowd, Row& row) const;
  std::span<const Term> terms_of(TermRange range) const {
    return std::span(terms_).subspan(range.first, range.end - range.first);
  }
  double sweep_velocities(const Dot& of, Crowd<T>& crowd) const;
  std::span<const SumsTerm> sums_of(TermRange range) const {
    return std::span(sums_terms_).subspan(range.first, range.end - range.first);
  }

  Array<Term> terms_;
  Array<SumsTerm> sums_terms_;
  Array<BallJoint> balls_;
  Array<Dot> dots_;
  Array<Distance> distances_;
  Array<Source> sources_;
  Array<Row> rows_;                ///< of this substep
  Array<const ElasticLaw*> laws_;  ///< by distance, of this substep
  Array<std::uint8_t> in_body_;    ///< by particle of the island that is gathered
  bool has_elastics_ = false;
  double h_ = 0;
};

extern template class CrowdJoints<float>;
extern template class CrowdJoints<double>;

}  // namespace plumb::detail
