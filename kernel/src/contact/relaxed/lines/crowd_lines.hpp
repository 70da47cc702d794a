#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "contact/relaxed/crowd.hpp"
#include "contact/relaxed/kept_table.hpp"
#include "contact/relaxed/pairs/crowd_pairs.hpp"
#include "plumb/layouts/aligned_buffer.hpp"
#include "plumb/layouts/memory.hpp"
#include "plumb/settings.hpp"
#include "simd/relax/relax_kernels.hpp"
#include "threads/team.hpp"

namespace plumb::detail {

/// Keeps the lines of a crowd apart, in vectors of contacts.
///
/// A line is the middle of a capsule between two particles that move and turn no body. A pair of such lines
/// is plain; all others are left to CrowdContacts, whose visits do the same. So are pairs that may pass each
/// other in a substep.
///
/// Each pair has a slot for every place at which it may touch. What holds a slot is kept here from substep to
/// substep, and by islands between steps. A pair that touches gets a colour for the rest of the step.
/// Contacts of one colour and of one place of their pairs move different particles, and make a range of
/// vectors.
template <class T>
class CrowdLines {
 public:
  using Pair = typename CrowdPairs<T>::Pair;

  CrowdLines(const ContactSettings& settings, const simd::Kernels<T>& kernels)
      : settings_(settings), kernels_(&kernels) {}

  /// Lines as a substep begins, and what is to be known of it.
  struct Placed {
    const double* lines;  ///< see simd::line_fields
    double h;             ///< s
    double share;         ///< of an overlap, which is taken back
  };

  /// Begins a step: forgets all pairs, and takes in which bodies are lines.
  void begin_step(std::span<LinkageState* const> cluster, const Crowd<T>& crowd, const CrowdPairs<T>& near);
  /// Finds where lines touch in a substep. They start from their last pushes, which do not move them yet.
  void find(std::span<LinkageState* const> cluster, const Crowd<T>& crowd, const CrowdPairs<T>& near,
            const Placed& placed, Team* team);
  /// Returns the pairs that are left to others in this substep.
  std::span<const Pair> left() const { return left_; }

  /// Moves those that touch as their pushes do.
  void start(Crowd<T>& crowd);
  /// Visits all contacts once. A team shares what is large.
  void sweep(Crowd<T>& crowd, Team* team);
  /// Does so, and returns the largest change of a place, m.
  double measured_sweep(Crowd<T>& crowd, Team* team);
  /// Returns how deep (m) some line goes into another one, at most.
  double depth(const Crowd<T>& crowd) const;
  bool any_bounces() const;
  /// Kicks velocities once, as bounces ask for.
  void bounce(Crowd<T>& crowd);
  /// Ends a substep: keeps pushes for the next one, and adds up their impulses where pulls count.
  void end(std::span<LinkageState* const> cluster, const Crowd<T>& crowd, const CrowdPairs<T>& near,
           double h);
  /// Writes last pushes to what islands keep, for the next step.
  void keep(std::span<LinkageState* const> cluster, const CrowdPairs<T>& near) const;

  /// Names the pushes of all contacts.
  SweptNumbers<T> swept() {
    if (slots_.empty()) return {};
    T* const first = &fields_[simd::line_contact_fields::push * lanes];
    return {first, 3 * lanes, fields_each() * lanes, slots_.size() / lanes};
  }

  bool any_touch() const { return !ranges_.empty(); }
  bool any_push() const;
  std::size_t count_pushes() const;

 private:
  static constexpr std::uint32_t none = 0xffffffff, lanes = simd::logical_width<T>,
                                 ends = simd::line_contact_fields::ends, places = simd::most_line_touches,
                                 colors = 64;
  static constexpr std::uint8_t no_color = 0xff;
  /// This is what contacts need of a body.
  struct Line {
    std::array<std::uint32_t, 2> at;  ///< places of its ends
    std::array<T, 2> over_mass;       ///< 1/kg, of its ends
    double friction;
    bool is_plain;
  };
  /// How a contact hits and bounces.
  struct Blow {
    double approach = 0;  ///< m/s, how fast it is about to hit
    double bounce = 0;    ///< m/s, what it leaves with
    double kick = 0;      ///< kg m/s, of a bounce
  };

  void list_lines(const CrowdPairs<T>& near);
  void add_pairs(const CrowdPairs<T>& near);
  void find_touches(const double* lines, Team* team);
  bool has_color(const CrowdPlaces& of, std::uint32_t pair);
  void classify(const CrowdPlaces& of);
  void load_kept(std::span<LinkageState* const> cluster, const CrowdPairs<T>& near);
  void reserve(const CrowdPlaces& of);
  void put(const simd::LineTouch& touch, std::size_t lane, const Placed& placed);
  void see_blows(const Crowd<T>& crowd, const CrowdPairs<T>& near, double h);
  void count_push(std::span<LinkageState* const> cluster, const Crowd<T>& crowd, const CrowdPairs<T>& near,
                  std::size_t lane, double h) const;
  std::uint64_t key_of(std::span<LinkageState* const> cluster, const CrowdPairs<T>& near,
                       std::size_t slot) const;
  std::array<double, ends> weights(std::size_t lane) const;
  /// Returns the difference between both places of of(place) of particles.
  template <class Of>
  Vec3 between(std::size_t lane, Of&& of) const;

  std::size_t fields_each() const {
    using namespace simd::line_contact_fields;
    return over_mass_ > 0 ? count_if_alike : count;
  }
  std::size_t place_of(std::size_t lane, std::size_t field) const {
    return (lane / lanes * fields_each() + field) * lanes + lane % lanes;
  }
  T& field(std::size_t lane, std::size_t field) { return fields_[place_of(lane, field)]; }
  T field(std::size_t lane, std::size_t field) const { return fields_[place_of(lane, field)]; }
  Vec3 vector(std::size_t lane, std::size_t first) const {
    return {field(lane, first), field(lane, first + 1), field(lane, first + 2)};
  }
  std::uint32_t at(std::size_t lane, std::uint32_t end) const {
    return at_[(lane / lanes * ends + end) * lanes + lane % lanes];
  }
  bool is_pushed(std::size_t lane) const { return vector(lane, simd::line_contact_fields::push) != Vec3{}; }
  /// Calls f(lane) for all contacts, in their order.
  template <class F>
  void for_contacts(F&& f) const {
    for (std::size_t lane = 0; lane < slots_.size(); ++lane)
      if (slots_[lane] != none) f(lane);
  }
  const simd::LineContactKernels<T>& kernels(const Crowd<T>& crowd) const {
    const bool in_rows = crowd.places().access() == layouts::Access::rows;
    return in_rows ? kernels_->row_line_contacts : kernels_->line_contacts;
  }
  simd::LineContactView<T> view(Crowd<T>& crowd) {
    return {crowd.displacements(), fields_.data(), at_.data(), crowd.places().component_stride(), over_mass_};
  }

  ContactSettings settings_;  ///< multiplied by their length scale
  const simd::Kernels<T>* kernels_;
  Array<Line> lines_;        ///< by body
  T over_mass_ = 0;          ///< 1/kg, of all ends; 0 if they differ
  bool is_first_ = true;     ///< no substep has ended, and islands have what held pairs
  bool sees_blows_ = false;  ///< some may bounce, or how fast they approach counts
  Array<Pair> known_;        ///< all pairs that were taken in, ascending
  Array<Pair> others_;       ///< those that are not plain
  Array<Pair> left_;
  Array<simd::LinePair> pairs_;
  Array<std::uint8_t> color_;                          ///< of pairs, once they touched in the step
  Array<Vec3> forces_;                                 ///< N, by slot: what held it in the last substep
  Array<std::uint32_t> held_;                          ///< slots that something held
  Array<std::uint64_t> taken_;                         ///< by particle, a bit for each colour
  Array<Array<simd::LineTouch>> touches_;              ///< by thread, of pairs in their order
  std::array<std::uint32_t, colors * places> next_{};  ///< counts, then the next lane of each class
  layouts::AlignedBuffer<T> fields_;
  Array<std::uint32_t> at_;
  Array<std::uint32_t> slots_;  ///< by lane, or none
  Array<Blow> blows_;           ///< by lane
  Array<simd::ContactRange> ranges_;
  KeptTable kept_;
};

extern template class CrowdLines<float>;
extern template class CrowdLines<double>;

}  // namespace plumb::detail
