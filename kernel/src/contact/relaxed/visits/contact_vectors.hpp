#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "contact/relaxed/crowd.hpp"
#include "plumb/layouts/aligned_buffer.hpp"
#include "plumb/layouts/memory.hpp"
#include "simd/relax/relax_kernels.hpp"
#include "threads/team.hpp"

namespace plumb::detail {

/// Holds contacts of a crowd in vectors, colour after colour, so that as many are visited at once as there
/// are lanes. Contacts of one colour move different particles.
template <class T>
class ContactVectors {
 public:
  using Term = typename Crowd<T>::Term;
  /// Names the pushes that a visit changes.
  struct Pushes {
    double* push = nullptr;  ///< kg m, along the normal
    Vec3* across = nullptr;  ///< kg m, against sliding
  };
  /// What a visit reads of a contact.
  struct Visited {
    std::span<const Term> terms;  ///< of its places
    Vec3 normal{}, carried{};     ///< carried: m, how far moving ground goes
    double gap = 0;               ///< m, what may be lost along the normal
    double over = 0;              ///< kg, what moves its places by a metre
    double friction = 0;          ///< Coulomb's coefficient
  };

  explicit ContactVectors(const simd::Kernels<T>& kernels) : all_kernels_(&kernels) {}

  /// @{
  /// Lays out contacts: begin(), color() for each, reserve(), then put() for each that has a colour, in the
  /// same order. A contact has none if it moves too many particles, or one of them twice, or one that too
  /// many contacts move.
  void begin(const Crowd<T>& crowd);
  bool color(const Crowd<T>& crowd, std::span<const Term> terms);
  void reserve(const Crowd<T>& crowd);
  void put(const Crowd<T>& crowd, const Visited& contact, Pushes pushes);
  /// @}
  /// Names the pushes of all contacts.
  SweptNumbers<T> swept() {
    if (pushes_.empty()) return {};
    T* const first = &fields_[simd::contact_fields::push * lanes];
    return {first, 3 * lanes, simd::contact_fields::count * lanes, pushes_.size() / lanes};
  }
  /// Writes pushes to where contacts keep them. Their places must not have changed since put().
  void write_back();

  /// Visits all contacts once. A team shares what is large.
  void sweep(Crowd<T>& crowd, Team* team);
  /// Does so, and returns the largest change of a place, m.
  double measured_sweep(Crowd<T>& crowd, Team* team);

 private:
  static constexpr std::uint32_t lanes = simd::logical_width<T>,
                                 most_terms = simd::contact_fields::most_terms;
  static constexpr std::uint32_t colors = 64, classes = 2;  // by terms: at most two, or four

  const simd::ContactKernels<T>& kernels(const Crowd<T>& crowd) const {
    const bool in_rows = crowd.places().access() == layouts::Access::rows;
    return in_rows ? all_kernels_->row_contacts : all_kernels_->contacts;
  }
  simd::ContactView<T> view(Crowd<T>& crowd) {
    return {crowd.displacements(), fields_.data(), at_.data(), crowd.places().component_stride()};
  }
  void clear(const Crowd<T>& crowd, std::size_t vector);
  T& field(std::size_t lane, std::size_t field) {
    return fields_[(lane / lanes * simd::contact_fields::count + field) * lanes + lane % lanes];
  }
  Vec3 vector(std::size_t lane, std::size_t first) {
    return {field(lane, first), field(lane, first + 1), field(lane, first + 2)};
  }

  const simd::Kernels<T>* all_kernels_;
  Array<std::uint64_t> taken_;                          ///< by particle, a bit for each colour
  Array<std::uint8_t> color_;                           ///< of contacts, in their order
  std::array<std::uint32_t, colors * classes> next_{};  ///< counts, then the next lane of each
  std::size_t put_ = 0;                                 ///< contacts that have been put
  layouts::AlignedBuffer<T> fields_;
  Array<std::uint32_t> at_;
  Array<Pushes> pushes_;  ///< by lane
  Array<simd::ContactRange> ranges_;
};

extern template class ContactVectors<float>;
extern template class ContactVectors<double>;

}  // namespace plumb::detail
