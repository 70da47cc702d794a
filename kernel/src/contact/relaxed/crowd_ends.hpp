#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "contact/ground/ground_search.hpp"
#include "contact/platforms/ground_now.hpp"
#include "contact/relaxed/crowd.hpp"
#include "contact/relaxed/kept_table.hpp"
#include "contact/relaxed/pairs/crowd_pairs.hpp"
#include "plumb/layouts/aligned_buffer.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/settings.hpp"
#include "simd/relax/relax_kernels.hpp"

namespace plumb::detail {

/// Keeps plain ends of a crowd's shapes out of plain ground, in vectors of ends.
///
/// An end is plain if it is a particle that turns no body. Ground is plain if it is a plane, a sphere or a
/// capsule and stands still, its surface too. All else is left to CrowdContacts, whose visits do the same.
/// Ends of one ground follow each other, and no two of them are the same particle. Where particles lie in
/// rows, a vector of ends is such a row, with nothing in the lanes of what is far away.
template <class T>
class CrowdEnds {
 public:
  using Pair = typename CrowdPairs<T>::Pair;

  CrowdEnds(const ContactSettings& settings, const simd::Kernels<T>& kernels)
      : settings_(settings), all_kernels_(&kernels), kernels_(&kernels.ends) {}

  /// Forgets all ends.
  void clear();
  /// Takes in ends that may touch ground within the step: pairs that are sorted by ground. Last pushes are
  /// those that islands keep.
  void add(std::span<LinkageState* const> cluster, const Crowd<T>& crowd, const CrowdPairs<T>& near,
           const Surroundings& surroundings, const GroundNow& ground, std::span<const Pair> pairs);

  /// Takes in ends that sweeps have thrown to where they may touch ground. Only find_missed() lets them.
  void add_thrown(std::span<LinkageState* const> cluster, Crowd<T>& crowd, const CrowdPairs<T>& near,
                  const Surroundings& surroundings, const GroundNow& ground, double share);

  /// Finds which ends touch within a substep of h (s), of which `share` of an overlap is taken back. They
  /// start from their last pushes, which do not move them yet.
  void find(Crowd<T>& crowd, const Surroundings& surroundings, double h, double share);
  /// Moves those that touch as their pushes do.
  void start(Crowd<T>& crowd);
  /// Lets those touch, too, that go in where that was not expected. Returns whether there are any.
  bool find_missed(Crowd<T>& crowd, double h);
  void sweep(Crowd<T>& crowd);
  /// Does so. Returns the largest change of a place, m.
  double measured_sweep(Crowd<T>& crowd);
  /// Sweeps once over vectors with an end deeper than a share of its radius, and than `least` (m). Returns
  /// whether there are any.
  bool sweep_deep(Crowd<T>& crowd, double share, double least);
  /// Returns whether an end is deeper than a share of its radius, and than `least` (m).
  bool any_deep(const Crowd<T>& crowd, double share, double least) const;
  /// Returns how deep (m) some end goes into what it should stay out of, at most.
  double depth(const Crowd<T>& crowd) const;
  bool any_bounces() const;
  /// Kicks velocities once, as bounces ask for.
  void bounce(Crowd<T>& crowd);
  /// Ends a substep: keeps pushes for the next one, and adds up their impulses where pulls count.
  void end(std::span<LinkageState* const> cluster, const Crowd<T>& crowd, double h);
  /// Writes last pushes to what islands keep that move, for the next step.
  void keep(std::span<LinkageState* const> cluster, const Crowd<T>& crowd) const;

  /// Names the pushes of all ends.
  SweptNumbers<T> swept() {
    if (touched_.empty()) return {};
    T* const first = &fields_[simd::end_fields::push * lanes];
    return {first, 3 * lanes, simd::end_fields::count * lanes, touched_.size()};
  }

  bool any_touch() const { return !touching_.empty(); }
  bool any_push() const;
  std::size_t count_pushes() const;

 private:
  static constexpr std::uint32_t none = 0xffffffff, lanes = simd::logical_width<T>;
  struct Group {
    simd::Range range;
    simd::EndGround<T> ground;
    std::uint32_t shape;   ///< of those that ground has; none for planes
    std::uint32_t number;  ///< among all ground
  };
  /// This is what visits do not need of an end.
  struct End {
    std::uint32_t island = none, shape = 0;
    std::uint64_t key = 0;
    double approach = 0;  ///< m/s, how fast it is about to hit
    double bounce = 0;    ///< m/s, what it leaves with
    double kick = 0;      ///< kg m/s, of a bounce
  };

  simd::EndView<T> view(Crowd<T>& crowd) {
    return {crowd.positions(), crowd.displacements(), fields_.data(), at_.data(),
            crowd.places().component_stride()};
  }
  T& field(std::size_t lane, std::uint32_t field) {
    return fields_[(lane / lanes * simd::end_fields::count + field) * lanes + lane % lanes];
  }
  T field(std::size_t lane, std::uint32_t field) const {
    return fields_[(lane / lanes * simd::end_fields::count + field) * lanes + lane % lanes];
  }
  Vec3 vector(std::size_t lane, std::uint32_t first) const {
    return {field(lane, first), field(lane, first + 1), field(lane, first + 2)};
  }
  /// Returns the place of an end's particle.
  std::uint32_t place(std::size_t lane) const {
    return in_rows_ ? at_[lane / lanes] + static_cast<std::uint32_t>(lane % lanes) : at_[lane];
  }
  /// Returns how deep (m) an end is in what it should stay out of.
  double depth(const Crowd<T>& crowd, std::size_t lane) const {
    return -field(lane, simd::end_fields::gap) -
           dot(vector(lane, simd::end_fields::normal), crowd.moved(place(lane)));
  }
  bool is_deep(const Crowd<T>& crowd, std::size_t lane, double share, double least) const {
    return depth(crowd, lane) > std::max<double>(least, share * field(lane, simd::end_fields::radius));
  }
  bool touches(std::size_t lane) const { return field(lane, simd::end_fields::over) != 0; }
  bool is_pushed(std::size_t lane) const { return vector(lane, simd::end_fields::push) != Vec3{}; }
  /// Calls f(lane) for all ends that touch, in their order.
  template <class F>
  void for_touching(F&& f) const {
    for (const std::uint32_t v : touching_)
      for (std::uint32_t lane = v * lanes; lane < (v + 1) * lanes; ++lane)
        if (touches(lane)) f(lane);
  }
  Group group_of(const Crowd<T>& crowd, const Surroundings& surroundings, const GroundNow& ground,
                 std::uint32_t number) const;
  void start_group(const CrowdPlaces& places);
  void add_vector(const CrowdPlaces& places, std::uint32_t place);
  std::size_t lane_for(const CrowdPlaces& places, std::uint32_t place);
  void add_lane(const Crowd<T>& crowd, const CrowdPairs<T>& near, const Pair& pair, std::uint64_t key,
                const Surface& surface);
  void load_forces(std::span<LinkageState* const> cluster, std::size_t first);
  simd::EndRules<T> rules_of(double margin, double share, double square) const {
    return {static_cast<T>(margin),
            T(0.25),
            static_cast<T>(GroundSearch::passes),
            static_cast<T>(settings_.slop),
            static_cast<T>(share),
            static_cast<T>(square)};
  }
  void uncover(const Crowd<T>& crowd, const Surroundings& surroundings);
  void list_touching();
  void see_bounces(const Crowd<T>& crowd, double h);

  ContactSettings settings_;  ///< multiplied by their length scale
  const simd::Kernels<T>* all_kernels_;
  const simd::EndKernels<T>* kernels_;
  bool in_rows_ = false;
  Array<Group> groups_;
  Array<End> ends_;                     ///< by lane
  Array<std::uint32_t> at_;             ///< see EndView
  Array<std::uint32_t> vector_of_row_;  ///< in the last group, or none
  std::size_t filled_ = 0;              ///< lanes of records that have an end or never will
  layouts::AlignedBuffer<T> fields_;
  Array<std::uint8_t> touched_;    ///< by vector
  Array<std::uint32_t> touching_;  ///< vectors with an end that touches, ascending
  Array<std::uint32_t> deep_;      ///< those of them with an end that is deep
  Array<double> restitution_;      ///< by lane
  bool sees_bounces_ = false;      ///< some may bounce, or how fast they approach counts
  KeptTable kept_;
};

extern template class CrowdEnds<float>;
extern template class CrowdEnds<double>;

}  // namespace plumb::detail
